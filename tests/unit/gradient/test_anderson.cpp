#include <gtest/gtest.h>

#include "core/gradient/anderson.h"

using namespace frictioncg;

namespace {

/// g* and G(g) = g* + M (g - g*), M of the given rank, expanding.
struct LinearMap {
  Vector fixed;
  Eigen::MatrixXd M;
  LinearMap(Index size, Index rank) {
    std::srand(5);
    fixed = Vector::Random(size).cwiseAbs();
    M = Eigen::MatrixXd::Random(size, rank) * Eigen::MatrixXd::Random(rank, size);
  }
  Vector operator()(const Vector& g) const { return fixed + M * (g - fixed); }
};

}  // namespace

TEST(Anderson, IsExactOnALinearMapOnceItHasSeenItsRank) {
  for (Index rank = 1; rank < Anderson::depth; ++rank) {
    const LinearMap G(8, rank);
    Anderson anderson;
    Vector g = Vector::Zero(8);
    // the first image leaves g* + range(M), each further one adds a direction of it
    for (Index k = 0; k <= rank + 1; ++k) g = anderson.next(g, G(g));
    EXPECT_LT((g - G.fixed).norm(), 1e-9) << rank;
    EXPECT_GT(G.M.norm(), 1);  // plain iteration diverges
  }
}

TEST(Anderson, TakesTheFirstImageAsItIsAndForgetsWhenTold) {
  const LinearMap G(4, 2);
  Anderson anderson;
  const Vector g = Vector::Constant(4, 0.3);
  EXPECT_EQ(anderson.next(g, G(g)), G(g));
  EXPECT_NE(anderson.next(G(g), G(G(g))), G(G(g)));
  anderson.forget();
  EXPECT_EQ(anderson.next(g, G(g)), G(g));
}

TEST(Anderson, KeepsNoMoreThanItsDepth) {
  // depth + 1 pairs give depth differences: what came before them no longer counts
  Anderson old, fresh;
  std::srand(9);
  for (int k = 0; k < 7; ++k) old.next(Vector::Random(8), Vector::Random(8));
  Vector of_old, of_fresh;
  for (Index k = 0; k <= Anderson::depth; ++k) {
    const Vector g = Vector::Random(8), image = Vector::Random(8);
    of_old = old.next(g, image);
    of_fresh = fresh.next(g, image);
    if (k == 0) {
      EXPECT_GT((of_old - of_fresh).norm(), 0.1);
    }
  }
  EXPECT_LT((of_old - of_fresh).norm(), 1e-11);
}
