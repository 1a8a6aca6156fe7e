#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "scene_in_blocks.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// Conjugate gradient on the dofs that are not fixed, to a residual 1e-8: the mean reduction of
/// |r| in one iteration, 1 where it fails.
Real rate(SceneInBlocks& s, const std::vector<char>& fixed = {}) {
  const System& system = *s.system;
  Vector free = Vector::Ones(system.dofs());
  for (std::size_t c = 0; c < fixed.size(); ++c) free[system.interior() + Index(c)] = !fixed[c];
  Vector r = s.posed.problem().increment.F.cwiseProduct(free), z, v, Av;
  const Real first = norm_D(system, r);
  Real r_z = 0;
  int k = 0;
  for (; norm_D(system, r) > 1e-8 * first; ++k) {
    if (k == 100) return 1;
    s.hierarchy->apply(r, z);
    const Real before = r_z;
    r_z = r.dot(z);
    v = k == 0 ? z : Vector(z + (r_z / before) * v);
    Av = (system.entries() * v).cwiseProduct(free);
    r -= (r_z / v.dot(Av)) * Av;
  }
  return std::pow(norm_D(system, r) / first, 1.0 / k);
}

/// Every third contact dof fixed, and some tangents stiffened.
struct Faces {
  std::vector<char> fixed;
  std::vector<TangentialStiffness> W;
  explicit Faces(const System& s) : fixed(s.contact_dofs(), 0) {
    for (Index i = 0; i < s.nodes(); ++i) {
      const Index c = s.first[i] - s.interior();
      fixed[c] = i % 3 != 0;
      for (Index k = 1; k <= s.tangents(i); ++k) fixed[c + k] = i % 3 == 1;
      if (s.tangents(i) != 2 || i % 3 == 1) continue;
      TangentialStiffness w{s.first[i] + 1, Eigen::Matrix2d::Zero()};
      w.M << 30, 10, 10, 20;
      W.push_back(w);
    }
  }
};

}  // namespace

TEST(Hierarchy, ReproducesRigidMotionsExactly) {
  for (int d : {2, 3}) {
    SparseOptions o = cube_of(d == 3 ? 7 : 24, d);
    o.clamp_side = false;
    o.distortion = 0.2;
    o.tilt = 0.4;
    HierarchyOptions how;
    how.dense = 0;
    how.coarsest = 60;
    SceneInBlocks s(o, how);
    Eigen::MatrixXd B = Eigen::MatrixXd::Zero(s.blocks.slots(), s.modes.cols());
    for (Index p = 0; p < s.system->dofs(); ++p) B.row(s.blocks.slot[p]) = s.modes.row(p);
    ASSERT_GE(s.hierarchy->levels(), 2);
    // from level to level the modes are in the range of P, and A does no work on them
    for (Index level = 0; level + 1 < s.hierarchy->levels(); ++level) {
      const Eigen::MatrixXd P = s.hierarchy->prolongation(level);
      const Eigen::MatrixXd coarse = P.completeOrthogonalDecomposition().solve(B);
      EXPECT_LT((P * coarse - B).norm(), 2e-6 * B.norm()) << d << level;
      const Eigen::MatrixXd A = s.hierarchy->matrix(level);
      EXPECT_LT((A * B).norm(), 2e-6 * A.norm() * B.norm()) << d << level;
      B = coarse;
    }
  }
}

TEST(Hierarchy, ConvergesAtOneRateWhateverTheMeshSize) {
  for (int n : {8, 12, 16, 20}) {
    SceneInBlocks s(cube_of(n));
    EXPECT_LT(rate(s), 0.25) << n;
  }
  for (int n : {16, 32, 64}) {
    SceneInBlocks s(cube_of(n, 2));
    EXPECT_LT(rate(s), 0.25) << n;
  }
}

TEST(Hierarchy, KeepsItsRateOnGradedMeshesWithContrastAndNearIncompressible) {
  for (int n : {10, 16}) {
    SparseOptions graded = cube_of(n), contrast = cube_of(n), stiff = cube_of(n),
                  unstructured = cube_of(n);
    graded.aspect = 10;
    contrast.contrast = 1e4;
    stiff.nu = 0.45;
    unstructured.distortion = 0.25;
    unstructured.tilt = 0.3;
    for (const SparseOptions& o : {graded, contrast, stiff, unstructured}) {
      SceneInBlocks s(o);
      EXPECT_LT(rate(s), 0.35) << n << " " << o.aspect << " " << o.contrast << " " << o.nu;
    }
  }
  SparseOptions graded = cube_of(60, 2);
  graded.aspect = 10;
  SceneInBlocks s(graded);
  EXPECT_LT(rate(s), 0.35);
}

TEST(Hierarchy, KeepsItsRateWithContactDofsCutOut) {
  for (int n : {8, 16}) {
    SparseOptions o = cube_of(n);
    o.tilt = 0.2;
    SceneInBlocks s(o);
    const Faces faces(*s.system);
    s.hierarchy->truncate(faces.fixed, {});
    EXPECT_LT(rate(s, faces.fixed), 0.35);
    s.hierarchy->truncate(std::vector<char>(faces.fixed.size(), 0), {});
    EXPECT_LT(rate(s), 0.35);
    s.hierarchy->truncate(std::vector<char>(faces.fixed.size(), 1), {});
    EXPECT_LT(rate(s, std::vector<char>(faces.fixed.size(), 1)), 0.35);
  }
}

TEST(Hierarchy, HoldsABodyThatContactAloneHolds) {
  for (int n : {8, 12}) {
    SparseOptions o = cube_of(n);
    o.clamp_side = false;
    SceneInBlocks s(o);
    std::vector<char> stick(s.system->contact_dofs(), 1);
    s.hierarchy->truncate(stick, {});
    EXPECT_LT(rate(s, stick), 0.3);
  }
}

TEST(Hierarchy, TruncatedEqualsTheGalerkinProductsOfTheTruncatedMatrix) {
  for (int d : {2, 3}) {
    SparseOptions o = cube_of(d == 3 ? 8 : 24, d);
    HierarchyOptions how;
    how.dense = 0;
    how.coarsest = 40;
    SceneInBlocks s(o, how);
    const Index levels = s.hierarchy->levels();
    ASSERT_GE(levels, 3);
    std::vector<Eigen::MatrixXd> untruncated;
    for (Index l = 0; l < levels; ++l) untruncated.push_back(s.hierarchy->matrix(l));
    const Faces faces(*s.system);
    s.hierarchy->truncate(faces.fixed, faces.W);

    // M A M + W from the matrix itself, in the unit the hierarchy took
    Eigen::MatrixXd A = s.system->entries();
    for (const TangentialStiffness& w : faces.W) A.block<2, 2>(w.first, w.first) += w.M;
    const Index interior = s.system->interior();
    for (std::size_t c = 0; c < faces.fixed.size(); ++c)
      if (faces.fixed[c]) A.row(interior + c).setZero(), A.col(interior + c).setZero();
    A /= s.system->entries().diagonal().mean();
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(s.blocks.slots(), s.blocks.slots());
    for (Index p = 0; p < s.system->dofs(); ++p)
      for (Index q = 0; q < s.system->dofs(); ++q)
        expected(s.blocks.slot[p], s.blocks.slot[q]) = A(p, q);
    for (Index l = 0; l + 1 < levels; ++l) {
      const Eigen::MatrixXd P = s.hierarchy->prolongation(l);
      expected = (P.transpose() * expected * P).eval();
      EXPECT_LT((s.hierarchy->matrix(l + 1) - expected).norm(), 1e-5 * expected.norm()) << l;
    }
    // and back: nothing of the truncation stays
    s.hierarchy->truncate(std::vector<char>(faces.fixed.size(), 0), {});
    for (Index l = 0; l < levels; ++l)
      EXPECT_LT((s.hierarchy->matrix(l) - untruncated[l]).norm(), 1e-6 * untruncated[l].norm());
  }
}

TEST(Hierarchy, FixedRowsAreZeroOnEveryLevelAndInEveryCorrection) {
  SparseOptions o = cube_of(6);
  o.cells = {6, 6, 1};  // thin: some coarse functions live on the contact face alone
  o.push_top = true;
  HierarchyOptions how;
  how.dense = 0;
  how.coarsest = 40;
  SceneInBlocks s(o, how);
  const std::vector<char> all(s.system->contact_dofs(), 1);
  s.hierarchy->truncate(all, {});
  const Eigen::MatrixXd P = s.hierarchy->prolongation(0);
  for (Index p = s.system->interior(); p < s.system->dofs(); ++p)
    EXPECT_EQ(P.row(s.blocks.slot[p]).norm(), 0);
  // a coarse function that lives on fixed dofs alone leaves exact zeros behind
  Eigen::MatrixXd above = P;
  for (Index l = 1; l < s.hierarchy->levels(); ++l) {
    const Eigen::MatrixXd A = s.hierarchy->matrix(l);
    for (Eigen::Index k = 0; k < A.rows(); ++k)
      if (above.col(k).norm() == 0) {
        EXPECT_EQ(A.row(k).norm(), 0);
      }
    if (l + 1 < s.hierarchy->levels()) above = above * s.hierarchy->prolongation(l);
  }
  Vector z;
  s.hierarchy->apply(Vector::Random(s.system->dofs()), z);
  EXPECT_EQ(z.tail(s.system->contact_dofs()).norm(), 0);
  EXPECT_TRUE(z.allFinite());
}

TEST(Hierarchy, IsASymmetricPositiveDefinitePreconditioner) {
  for (int d : {2, 3}) {
    SparseOptions o = cube_of(d == 3 ? 5 : 12, d);
    HierarchyOptions how;
    how.dense = 0;
    how.coarsest = 40;
    SceneInBlocks s(o, how);
    const Faces faces(*s.system);
    s.hierarchy->truncate(faces.fixed, faces.W);
    const Index n = s.system->dofs();
    Eigen::MatrixXd M(n, n);
    Vector z;
    for (Index p = 0; p < n; ++p) {
      s.hierarchy->apply(Vector::Unit(n, p), z);
      M.col(p) = z;
    }
    EXPECT_LT((M - M.transpose()).norm(), 1e-5 * M.norm());
    const Vector eigenvalues =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>((M + M.transpose()) / 2).eigenvalues();
    Index fixed = 0;
    for (char f : faces.fixed) fixed += f;
    EXPECT_LT(eigenvalues.head(fixed).cwiseAbs().maxCoeff(), 1e-6 * eigenvalues[n - 1]);
    EXPECT_GT(eigenvalues[fixed], 1e-4 * eigenvalues[n - 1]);
  }
}

TEST(Hierarchy, DoesNotDependOnTheUnitOfForce) {
  SparseScene scene = sparse_block(cube_of(5));
  SceneInBlocks s(scene);
  Vector z, z_scaled;
  const Vector r = Vector::Random(s.system->dofs());
  s.hierarchy->apply(r, z);
  for (Real& a : scene.a)
    if (a < 1e29) a *= 1e-22;
  SceneInBlocks scaled(scene);
  scaled.hierarchy->apply(1e-30 * r, z_scaled);
  EXPECT_LT((z_scaled * 1e8 - z).norm(), 1e-5 * z.norm());
  scaled.hierarchy->apply(Vector::Zero(r.size()), z_scaled);
  EXPECT_EQ(z_scaled.norm(), 0);
}

TEST(Hierarchy, TakesLittleMemoryBesideTheMatrix) {
  SceneInBlocks s(cube_of(16));
  const double A = double(s.system->entries().nonZeros()) * (sizeof(Real) + sizeof(Index));
  EXPECT_LT(s.hierarchy->bytes(), 1.6 * A);  // a third of it A itself, of which one half is kept
  EXPECT_LT(s.hierarchy->operator_complexity(), 1.5);
}

TEST(Hierarchy, MultipliesByHalfOfASymmetricMatrix) {
  for (const int d : {2, 3}) {
    const SceneInBlocks s(cube_of(d == 2 ? 20 : 6, d));
    Matrix A = s.system->entries();
    const Vector x = Vector::Random(A.rows());
    Vector Ax;
    ASSERT_TRUE(s.hierarchy->multiply(x, Ax));
    EXPECT_LT((Ax - A * x).norm(), 1e-14 * Ax.norm());
    EXPECT_NE(A.innerIndexPtr()[A.outerIndexPtr()[100]], 100);
    HierarchyOptions without;
    without.multiplies = false;
    const auto smaller = make_hierarchy(A, s.blocks, s.modes, without);
    EXPECT_FALSE(smaller->multiply(x, Ax));
    EXPECT_LT(smaller->bytes(), s.hierarchy->bytes() - 4. * double(A.nonZeros()));
    A.valuePtr()[A.outerIndexPtr()[100]] *= 1 + 1e-9;  // a coupling, as far as A may be off
    EXPECT_FALSE(make_hierarchy(A, s.blocks, s.modes)->multiply(x, Ax));
  }
}

TEST(Hierarchy, OfASmallMatrixIsItsInverseOnWhatIsFree) {
  SparseOptions o = cube_of(3);
  o.nu = 0.4999;
  SceneInBlocks s(o);
  ASSERT_EQ(s.hierarchy->levels(), 1);
  EXPECT_GT(s.hierarchy->bytes(), 0);
  const Faces faces(*s.system);
  const Vector springs = Vector::Constant(s.system->contact_dofs(), 7.0);
  s.hierarchy->truncate(faces.fixed, faces.W, springs);
  const Vector r = Vector::Random(s.system->dofs());
  Vector z;
  s.hierarchy->apply(r, z);
  Vector left = r - s.system->entries() * z;
  left.tail(springs.size()) -= springs.cwiseProduct(z.tail(springs.size()));
  for (const TangentialStiffness& w : faces.W)
    left.segment<2>(w.first) -= w.M * z.segment<2>(w.first);
  for (std::size_t c = 0; c < faces.fixed.size(); ++c)
    if (faces.fixed[c]) {
      EXPECT_EQ(z[s.system->interior() + Index(c)], 0);
      left[s.system->interior() + Index(c)] = 0;
    }
  EXPECT_LT(left.norm(), 1e-5 * r.norm());
}
