#include <gtest/gtest.h>

#include "tied.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

constexpr Real patch = 1e-11;

bool lies_on(Real a, Real b) { return std::abs(a - b) < 1e-9; }

bool on_outside(int d, const Vec3& x) {
  for (int c = 0; c < d; ++c)
    if (lies_on(x[c], 0) || lies_on(x[c], c == d - 1 ? 2 : 1)) return true;
  return false;
}

Eigen::Matrix3d rotation(int d) {
  const Vec3 axis = d == 2 ? Vec3::UnitZ() : Vec3(1, 2, 3).normalized();
  return Eigen::AngleAxisd(0.7, axis).toRotationMatrix();
}

void swap_sides(Scene& s) { std::swap(s.pairs[0].slave, s.pairs[0].master); }

/// Forces of the contact on both bodies, and their moment about the origin, over their size.
std::pair<Real, Real> imbalance(const Scene& s, const Mortar& mortar) {
  const Index n = s.bodies.nodes();
  Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
  Real size = 0;
  std::srand(3);
  Eigen::MatrixXd f = Eigen::MatrixXd::Zero(n, 3);
  for (int c = 0; c < s.d(); ++c)
    f.col(c) = mortar.relative().transpose() * Vector::Random(mortar.relative().rows());
  for (Index i = 0; i < n; ++i) {
    sum += f.row(i).transpose();
    moment += s.bodies.X[i].cross(Vec3(f.row(i).transpose()));
    size += f.row(i).norm();
  }
  return {sum.norm() / size, moment.norm() / size};
}

}  // namespace

TEST(MortarPatch, ALinearFieldPassesThroughNonMatchingMeshesWithClampedEnds) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (int upper : {2, 3, 5})
        for (bool swapped : {false, true}) {
          if (d == 3 && upper == 5 && quadratic) continue;
          const Eigen::Matrix3d R = rotation(d);
          Scene s = stacked(d, quadratic, 3, upper, 0.3, d == 3 ? 0.35 : 0,
                            [&](const Vec3& x) { return Vec3(R * x); });
          if (swapped) swap_sides(s);
          hold_linear(s, some_gradient(d),
                      [&](const Vec3& x) { return on_outside(d, R.transpose() * x); });
          const Mortar mortar = s.mortar();
          EXPECT_GT(mortar.statistics().facing, 0);
          EXPECT_GT(mortar.statistics().removed, 0);
          EXPECT_LT(error_of(s, solve_tied(s, mortar).u, some_gradient(d)), patch)
              << d << "D P" << 1 + quadratic << " upper " << upper;
        }
}

TEST(MortarPatch, UniformStressInBodiesOfDifferentStiffnessBetweenRollers) {
  // u = (0, .., strain of each body) under a pressure 1, sides held in their normal only
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (bool normal_only : {false, true})
        for (bool swapped : {false, true}) {
          Scene s = stacked(
              d, quadratic, 3, 4, 0.3, d == 3 ? 0.35 : 0, [](const Vec3& x) { return x; }, 10);
          if (swapped) swap_sides(s);
          const int up = d - 1;
          for (Index i = 0; i < s.bodies.nodes(); ++i)
            for (int c = 0; c < d; ++c)
              if (lies_on(s.bodies.X[i][c], 0) || (c != up && lies_on(s.bodies.X[i][c], 1)))
                s.hold(i, c, 0);
          for (const Facet& f : s.bodies.boundary([&](const Vec3& x) { return lies_on(x[up], 2); }))
            s.bodies.add_traction(f, -Vec3::Unit(up), s.load);
          const Mortar mortar = s.mortar();
          EXPECT_EQ(mortar.statistics().removed, 0);
          const Vector u = solve_tied(s, mortar, normal_only).u;
          const Real nu = s.bodies.nu, k = (1 + nu) * (1 - 2 * nu) / (1 - nu);
          Real error = 0;
          for (Index i = 0; i < s.bodies.nodes(); ++i) {
            const Real z = s.bodies.X[i][up];
            Vector exact = Vector::Zero(d);
            exact[up] = z < 1 ? -k * z : -k - k / 10 * (z - 1);
            error = std::max(error, (u.segment(d * i, d) - exact).norm());
          }
          EXPECT_LT(error, patch) << d << "D P" << 1 + quadratic << normal_only << swapped;
        }
}

TEST(MortarPatch, ForcesBalanceAndSoDoTheirMomentsOnFlatInterfaces) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      Scene s = stacked(d, quadratic, 3, 4, 0.3, 0.35);
      const auto [force, moment] = imbalance(s, s.mortar());
      EXPECT_LT(force, 1e-15);
      EXPECT_LT(moment, 1e-15);
    }
}

TEST(MortarPatch, TheTipOfACrackIsNoContactNode) {
  // two boxes glued for x >= 1/2, a crack with faces that do not match for x < 1/2
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (bool swapped : {false, true}) {
        Scene s(d, quadratic);
        Index first = 0;
        for (int body : {0, 1}) {
          if (body == 1) first = static_cast<Index>(s.bodies.elements.size());
          const int left = body == 0 ? 2 : 3;
          s.bodies.add_box({left + 3, 3, 3}, [&](const Vec3& x) {
            Vec3 y = x;
            const Real cell = x[0] * (left + 3);
            y[0] = cell <= left ? cell / left / 2 : 0.5 + (cell - left) / 6;
            if (body == 1) y[d - 1] += 1;
            return y;
          });
        }
        s.bodies.merge([&](const Vec3& x) { return lies_on(x[d - 1], 1) && x[0] > 0.5 - 1e-9; });
        const auto face = [&](const Vec3& x) { return lies_on(x[d - 1], 1) && x[0] < 0.5; };
        Pair pair;
        pair.slave = {quadratic, {2}, s.bodies.boundary(face, 2, first)};
        pair.master = {quadratic, {1}, s.bodies.boundary(face, 1, 0, first)};
        s.pairs = {pair};
        if (swapped) swap_sides(s);
        s.start();
        hold_linear(s, some_gradient(d), [&](const Vec3& x) { return on_outside(d, x); });
        s.options.element_groups = [](Index) { return 1; };
        const Mortar mortar = s.mortar();
        EXPECT_LT(error_of(s, solve_tied(s, mortar).u, some_gradient(d)), patch)
            << d << "D P" << 1 + quadratic;
        EXPECT_LT(imbalance(s, mortar).first, 1e-15);
      }
}

TEST(MortarPatch, AtTheCornerOfTwoLabelsTheFirstOwnsTheNode) {
  // a box in the seat of a larger one: bottom and side touch, as two labels or as one
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (const std::vector<long>& labels :
           {std::vector<long>{2, 3}, std::vector<long>{3, 2}, std::vector<long>{2}}) {
        Scene s(d, quadratic);
        const auto in_plane = [d](Real x, Real y, const Vec3& o) {
          return d == 2 ? Vec3(x, y, 0) : Vec3(x, o[1], y);
        };
        const int up = d - 1;
        const auto move = [&](Real x, Real y, Real distortion = 0) {
          return [&, x, y, distortion](const Vec3& o) {
            const Vec3 p = distorted(d, o, distortion, 1);
            return in_plane(x + p[0], y + p[up], p);
          };
        };
        s.bodies.add_box({3, 3, 3}, move(0, 0));  // below
        s.bodies.add_box({3, 3, 3}, move(1, 0));  // below, to the right
        s.bodies.add_box({3, 3, 3}, move(1, 1));  // the right wall
        const Index first = static_cast<Index>(s.bodies.elements.size());
        s.bodies.merge([](const Vec3&) { return true; });
        s.bodies.add_box({4, 4, 4}, move(0, 1, 0.2));
        const auto bottom = [&](const Vec3& x) { return lies_on(x[up], 1) && x[0] < 1; };
        const auto side = [&](const Vec3& x) { return lies_on(x[0], 1) && x[up] > 1; };
        Pair pair;
        pair.slave.labels = labels;
        pair.slave.quadratic = pair.master.quadratic = quadratic;
        pair.master.labels = {1};
        pair.slave.facets = s.bodies.boundary(bottom, 2, first);
        for (const Facet& f : s.bodies.boundary(side, labels.size() > 1 ? 3 : 2, first))
          pair.slave.facets.push_back(f);
        pair.master.facets =
            s.bodies.boundary([&](const Vec3& x) { return bottom(x) || side(x); }, 1, 0, first);
        s.pairs = {pair};
        s.start();
        // the three glued boxes move as given; the fourth is held by contact and on its far sides
        hold_linear(s, some_gradient(d), [&](const Vec3& x) {
          return lies_on(x[0], 0) || lies_on(x[0], 2) || lies_on(x[up], 0) || lies_on(x[up], 2) ||
                 (d == 3 && (lies_on(x[1], 0) || lies_on(x[1], 1))) ||
                 (lies_on(x[0], 1) && x[up] < 1) || (lies_on(x[up], 1) && x[0] > 1 + 1e-9);
        });
        const Mortar mortar = s.mortar();
        for (const SlaveNode& node : mortar.nodes())
          EXPECT_NEAR(node.normal.cwiseAbs().maxCoeff(), 1, 1e-12);  // no averaged corner
        EXPECT_LT(error_of(s, solve_tied(s, mortar).u, some_gradient(d)), patch)
            << d << "D P" << 1 + quadratic << " labels " << labels.size();
      }
}
