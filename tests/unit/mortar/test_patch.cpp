#include <gtest/gtest.h>

#include "tied.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

constexpr Real patch = 1e-11;

const Eigen::Matrix3d turned =
    Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();

bool outer(int d, const Vec3& x) {
  for (int c = 0; c < d; ++c)
    if (std::abs(x[c]) < 1e-9 || std::abs(x[c] - (c == d - 1 ? 2 : 1)) < 1e-9) return true;
  return false;
}

}  // namespace

TEST(MortarPatch, ALinearFieldPassesThroughNonMatchingMeshesWithClampedEnds) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (int upper : {2, 3, 5}) {
        if (d == 3 && upper == 5 && quadratic) continue;
        Scene s = stacked(d, quadratic, 3, upper, 0.3, d == 3 ? 0.35 : 0);
        hold_linear(s, some_gradient(d), [&](const Vec3& x) { return outer(d, x); });
        const Mortar mortar = s.mortar();
        EXPECT_GT(mortar.statistics().facing, 0);
        EXPECT_GT(mortar.statistics().removed, 0);
        const Tied tied = solve_tied(s, mortar);
        EXPECT_LT(error_of(s, tied.u, some_gradient(d)), patch)
            << d << "D P" << 1 + quadratic << " upper " << upper;
      }
}
