#include <gtest/gtest.h>

#include "posed.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

constexpr Real coefficient = 0.3;

bool lies_at(Real a, Real b) { return std::abs(a - b) < 1e-9; }

/// Two boxes pressed on one another by a uniform stress with the shear `share` mu p in the
/// interface: held at the bottom and at the top, where the upper one is moved on by `slip`.
struct Sheared {
  Scene s;
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero(), sigma = Eigen::Matrix3d::Zero();
  Vec3 slip = Vec3::Zero();
  Index upper_nodes = 0;  ///< first node of the upper box

  Sheared(int d, bool quadratic, Real share, Real slips, bool swapped)
      : s(stacked(d, quadratic, 3, 4, 0.25, d == 3 ? 0.35 : 0)) {
    if (swapped) std::swap(s.pairs[0].slave, s.pairs[0].master);
    const int up = d - 1;
    const Vec3 direction = d == 2 ? Vec3(1, 0, 0) : Vec3(0.6, 0.8, 0);
    const Real E = s.bodies.E[0], nu = s.bodies.nu, p = 0.01;
    sigma(up, up) = -p;
    for (int c = 0; c < up; ++c)
      sigma(c, up) = sigma(up, c) = share * coefficient * p * direction[c];
    for (int c = 0; c < up; ++c) sigma(c, c) = 0.2 * p * (c + 1);
    if (d == 2) sigma(2, 2) = nu * (sigma(0, 0) + sigma(1, 1));
    H = (1 + nu) / E * sigma - nu / E * sigma.trace() * Eigen::Matrix3d::Identity();
    for (int c = 0; c < up; ++c) {  // the shear as a rotation of the sides only
      H(c, up) *= 2;
      H(up, c) = 0;
    }
    slip = slips * direction;
    upper_nodes = s.bodies.elements[s.bodies.elements.size() - 1][0];
    for (Index i = 0; i < s.bodies.nodes(); ++i) {
      const Vec3& x = s.bodies.X[i];
      if (!lies_at(x[up], 0) && !lies_at(x[up], 2)) continue;
      const Vec3 u = exact(i);
      for (int c = 0; c < d; ++c) s.hold(i, c, u[c]);
    }
    const auto side = [&](const Vec3& x) {
      return !lies_at(x[up], 0) && !lies_at(x[up], 1) && !lies_at(x[up], 2);
    };
    for (const Facet& f : s.bodies.boundary(side))
      s.bodies.add_traction(f, sigma * plane_of(d, f, s.bodies.X).normal, s.load);
  }
  bool is_upper(Index i) const {
    for (const Surface* side : {&s.pairs[0].slave, &s.pairs[0].master})
      for (const Facet& f : side->facets)
        for (Index node : f.node)
          if (node == i) return side->labels[0] == 2;
    return s.bodies.X[i][s.d() - 1] > 1;
  }
  Vec3 exact(Index i) const {
    Vec3 u = H * s.bodies.X[i];
    if (is_upper(i)) u += slip;
    return u;
  }
  Real error(const Vector& u) const {
    Real error = 0, size = 0;
    for (Index i = 0; i < s.bodies.nodes(); ++i) {
      const Vec3 e = exact(i);
      size = std::max(size, e.norm());
      error = std::max(error, (u.segment(s.d() * i, s.d()) - e.head(s.d())).norm());
    }
    return error / size;
  }
  /// Sum of the contact forces on both bodies, their moment, and what misses of the stress on the
  /// upper body, all over the force on it.
  std::array<Real, 3> force_errors(const Vector& force) const {
    Vec3 sum = Vec3::Zero(), moment = Vec3::Zero(), upper = Vec3::Zero();
    for (Index i = 0; i < s.bodies.nodes(); ++i) {
      Vec3 f = Vec3::Zero();
      f.head(s.d()) = force.segment(s.d() * i, s.d());
      sum += f;
      moment += s.bodies.X[i].cross(f);
      if (is_upper(i)) upper += f;
    }
    Vec3 expected = -sigma.col(s.d() - 1);
    if (s.d() == 2) expected[2] = 0;
    const Real size = expected.norm();
    return {sum.norm() / size, moment.norm() / size, (upper - expected).norm() / size};
  }
};

}  // namespace

TEST(MortarContact, CoulombFrictionThatSticksOrSlipsPassesThePatchTest) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (bool slips : {false, true})
        for (bool swapped : {false, true}) {
          const Sheared scene(d, quadratic, slips ? 1 : 0.6, slips ? 0.004 : 0, swapped);
          Settings settings;
          settings.tol = 1e-11;
          const Answer answer = solve_contact(scene.s, coefficient, settings, swapped);
          EXPECT_EQ(answer.solution.status, Status::converged);
          EXPECT_LT(answer.solution.certificate.residual, 1e-12);
          EXPECT_LT(scene.error(answer.u), 1e-11) << d << "D P" << 1 + quadratic << slips;
          const auto [sum, moment, traction] = scene.force_errors(answer.force);
          EXPECT_LT(sum, 1e-12);
          EXPECT_LT(moment, 1e-12);
          EXPECT_LT(traction, 1e-10);
        }
}

TEST(MortarContact, EveryMethodPassesThePatchTest) {
  for (int d : {2, 3})
    for (Method method :
         {Method::condensed, Method::gc1, Method::gc2, Method::gc3, Method::gcx, Method::sorp})
      for (bool slips : {false, true}) {
        const Sheared scene(d, d == 2, slips ? 1 : 0.6, slips ? 0.004 : 0, false);
        Settings settings;
        settings.method = method;
        settings.tol = 1e-9;
        settings.nbiter = 100000;
        const Answer answer = solve_contact(scene.s, coefficient, settings);
        const auto [sum, moment, traction] = scene.force_errors(answer.force);
        EXPECT_EQ(answer.solution.status, Status::converged) << d << int(method) << slips;
        EXPECT_TRUE(answer.rotated);
        EXPECT_LT(scene.error(answer.u), 1e-8) << d << int(method) << slips;
        EXPECT_LT(sum, 1e-14) << d << int(method) << slips;
        EXPECT_LT(moment, 1e-14) << d << int(method) << slips;
        EXPECT_LT(traction, 1e-8) << d << int(method) << slips;
      }
}

TEST(MortarContact, FrictionActsOnTheRelativeSlipOfAnIncrement) {
  for (int d : {2, 3}) {
    const Sheared moved(d, d == 2, 1, 0.004, false), back(d, d == 2, 0.6, 0.004, false);
    Settings settings;
    settings.tol = 1e-11;
    const Vector u = solve_contact(moved.s, coefficient, settings).u;
    // under less shear it sticks where it has come to; from scratch it would have gone there by
    // slipping, at the limit
    const Answer answer = solve_contact(back.s, coefficient, settings, false, u);
    EXPECT_LT(answer.solution.certificate.residual, settings.tol);
    EXPECT_LT(back.error(answer.u), 1e-11);
    EXPECT_LT(back.force_errors(answer.force)[2], 1e-10);
    for (NodeState state : answer.solution.state) EXPECT_EQ(state, NodeState::stick);
    EXPECT_GT(back.force_errors(solve_contact(back.s, coefficient, settings).force)[2], 0.01);
  }
}

TEST(MortarContact, TiedBodiesPull) {
  // bilateral contact, sticking: tension passes, too
  for (int d : {2, 3}) {
    Sheared pulled(d, true, 0.6, 0, false);
    pulled.s.load *= -1;
    pulled.s.data *= -1;
    Settings settings;
    settings.tol = 1e-11;
    const Answer answer = solve_contact(pulled.s, coefficient, settings, false, {}, true);
    EXPECT_LT(pulled.error(-answer.u), 1e-11);
    EXPECT_LT(pulled.force_errors(-answer.force)[2], 1e-10);
  }
}

TEST(MortarContact, AMeshedObstacleThatIsHeldActsLikeOneGivenByGapAndNormal) {
  for (int d : {2, 3}) {
    const int up = d - 1;
    Scene s = stacked(d, false, 3, 4, 0.25);
    std::vector<char> below(s.bodies.X.size(), 0);
    for (const Element& e : s.bodies.elements)
      if (s.bodies.centroid(e)[up] < 1)
        for (Index i : e) below[i] = 1;
    for (Index i = 0; i < s.bodies.nodes(); ++i) {
      if (below[i])
        for (int c = 0; c < d; ++c) s.hold(i, c, 0);
      else if (lies_at(s.bodies.X[i][up], 2))
        for (int c = 0; c < d; ++c) s.hold(i, c, c == up ? -0.01 - 0.05 * s.bodies.X[i][0] : 0.004);
    }
    Settings settings;
    settings.tol = 1e-11;
    const Answer meshed = solve_contact(s, coefficient, settings);

    const Assembled assembled(s, false);
    std::vector<ContactPoint> points;
    std::vector<char> seen(s.bodies.X.size(), 0);
    for (const Facet& f : s.pairs[0].slave.facets)
      for (int v = 0; v < d; ++v) {
        if (seen[f.node[v]]) continue;
        seen[f.node[v]] = 1;
        ContactPoint p;
        for (int c = 0; c < d; ++c) p.dof[c] = d * f.node[v] + c;
        p.normal[up] = -1;
        p.friction = true;
        points.push_back(p);
      }
    const LocalSystem local(assembled.triplets(), d, points);
    PointLaws laws{Law::coulomb, false, Vector::Zero(Index(points.size())),
                   Vector::Constant(Index(points.size()), coefficient)};
    const LocalIncrement now = local.increment(assembled.b, {}, laws);
    const Solution rigid = Solver(local.system()).solve(now.increment, settings);
    const Vector u = local.to_global(rigid.x, now.u0);
    EXPECT_LT((u - meshed.u).norm(), 1e-11 * u.norm());
    EXPECT_EQ(meshed.nodes, local.nodes());
  }
}

TEST(MortarCoupling, NodesThatAnObstacleTakesKeepTheirDisplacementAndCarryNoLaw) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      const Scene s = stacked(d, quadratic, 4, 3, 0.3, 0.35);
      std::vector<char> taken;
      NodeDofs dof(s.bodies.X.size());
      for (Index i = 0; i < s.bodies.nodes(); ++i) {
        taken.push_back(lies_at(s.bodies.X[i][0], 0));  // a wall on one side of both
        for (int c = 0; c < d; ++c) dof[i][c] = d * i + c;
      }
      const Assembled assembled(s, false);
      const Dirichlet none(assembled.triplets(), {});
      const Mortar mortar({d, s.bodies.X, {}, taken}, s.pairs, s.options);
      EXPECT_GT(mortar.statistics().removed, 0);
      EXPECT_EQ(mortar.statistics().held, 0);
      for (const mortar::SlaveNode& node : mortar.nodes()) EXPECT_FALSE(taken[node.node]);
      const Coupling both = couple(mortar, d, dof, none, d * s.bodies.nodes(), taken);
      const Vector w = Vector::Random(d * s.bodies.nodes()), u = both.T * w;
      EXPECT_LT((both.W * u - w).lpNorm<Eigen::Infinity>(), 1e-13);
      for (Index i = 0; i < s.bodies.nodes(); ++i)
        for (int c = 0; c < d && taken[i]; ++c) EXPECT_EQ(u[d * i + c], w[d * i + c]);
    }
}
