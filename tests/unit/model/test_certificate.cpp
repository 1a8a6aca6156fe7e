#include <gtest/gtest.h>

#include "../driven.h"
#include "../verifier.h"
#include "core/solver.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// A block pressed and sheared, at its solution.
struct Solved {
  Scene scene;
  Posed posed;
  Vector x;
  const ContactProblem& problem() const { return posed.problem(); }
};

Solved solved(const Scene& s) {
  Solved result{s, s.system(mesh_nodes(s)), {}};
  const Solution solution = solve(result.problem(), Settings());
  EXPECT_EQ(solution.status, Status::converged);
  result.x = solution.x;
  return result;
}

Scene sheared_block(int d = 2, Real angle = 0) {
  BlockOptions o;
  o.d = d;
  o.cells = d == 2 ? 6 : 3;
  o.shear = 2.5;
  o.angle = angle;
  if (d == 3) o.axis << 1, -2, 0.5;
  return block(o);
}

/// One contact node on springs: A = diag(k), dofs N, T(, T2).
ContactProblem one_node(const Vector& k, Law law, Real coefficient) {
  const auto s = std::make_shared<AssembledSystem>();
  s->dimension = static_cast<int>(k.size());
  s->A.resize(Index(k.size()), Index(k.size()));
  for (Index i = 0; i < k.size(); ++i) s->A.insert(i, i) = k[i];
  s->A.makeCompressed();
  s->D = k;
  s->first = {0, Index(k.size())};
  s->weight = node_weights(*s);
  ContactProblem p{s, {}};
  p.increment.F = Vector::Zero(k.size());
  p.increment.gap = Vector::Zero(1);
  p.increment.law = law;
  (law == Law::tresca ? p.increment.g : p.increment.mu) = Vector::Constant(1, coefficient);
  return p;
}

ContactProblem one_node(Law law, Real coefficient) {
  return one_node(Eigen::Vector2d(4, 9), law, coefficient);
}

}  // namespace

TEST(Certificate, IsTheScaledNormOfTheThreeLawsInDenseArithmetic) {
  const Solved at = solved(sheared_block());
  const ContactProblem& p = at.problem();
  const Vector x = at.x + 1e-4 * Vector::Random(at.x.size());
  const Eigen::MatrixXd A = p.system->entries();
  const Vector r = p.increment.F - A * x;
  Vector w(p.dofs());
  for (Index i = 0; i < p.dofs(); ++i) {
    Real sum = 0, count = 0;
    for (Index j = 0; j < p.system->first[0]; ++j)
      if (p.system->mesh_node[j] == p.system->mesh_node[i]) sum += A(j, j), ++count;
    w[i] = i < p.system->first[0] ? sum / count : A(i, i);
  }
  Real equilibrium = 0, normal = 0, friction = 0, contact = 0, load = 0;
  for (Index i = 0; i < p.dofs(); ++i) load += std::pow(p.increment.F[i], 2) / w[i];
  for (Index i = 0; i < p.system->first[0]; ++i) equilibrium += r[i] * r[i] / w[i];
  for (Index k = 0; k < p.nodes(); ++k) {
    const Index N = p.system->first[k], T = N + 1;
    const Real closing = w[N] * (p.increment.gap[k] - x[N]);
    normal += std::pow(std::min(closing, r[N]), 2) / w[N];
    if (closing < r[N]) contact += r[N] * r[N] / w[N] + r[T] * r[T] / w[T];
    const Real g = closing < r[N] ? p.increment.mu[k] * std::max(r[N], 0.0) : 0;
    const Real y = r[T] + w[T] * x[T];
    friction += std::pow(r[T] - std::max(-g, std::min(g, y)), 2) / w[T];
  }
  const Certificate c = certify(p, x);
  const Real scale = std::sqrt(contact + 1e-4 * load);
  EXPECT_NEAR(c.scale, scale, 1e-12 * scale);
  EXPECT_NEAR(c.equilibrium, std::sqrt(equilibrium) / scale, 1e-12 * c.residual);
  EXPECT_NEAR(c.normal, std::sqrt(normal) / scale, 1e-12 * c.residual);
  EXPECT_NEAR(c.friction, std::sqrt(friction) / scale, 1e-12 * c.residual);
  EXPECT_NEAR(c.residual, std::sqrt(equilibrium + normal + friction) / scale, 1e-12 * c.residual);
  EXPECT_EQ((c.r - r).cwiseAbs().maxCoeff() < 1e-12, true);
}

TEST(Certificate, IsInvariantUnderAChangeOfUnits) {
  Solved at = solved(sheared_block());
  const Vector x = at.x + 1e-4 * Vector::Random(at.x.size());
  const Real before = certify(at.problem(), x).residual;
  for (Real& a : at.scene.a) a *= 1e6 / 1e-3;  // forces by 1e6, lengths by 1e-3
  at.scene.b *= 1e6;
  at.scene.gap *= 1e-3;
  const Posed scaled = at.scene.system(mesh_nodes(at.scene));
  EXPECT_NEAR(certify(scaled.problem(), 1e-3 * x).residual, before, 1e-12 * before);
}

TEST(Certificate, IsInvariantUnderRotationOfTheMesh) {
  for (int d : {2, 3}) {
    const Solved flat = solved(sheared_block(d));
    const Vector u = flat.posed.to_global(flat.x) + 1e-4 * Vector::Random(flat.scene.n);
    const Certificate before = certify(flat.problem(), flat.posed.to_local(u));
    EXPECT_GT(before.residual, 1e-3);
    for (Real angle : {0.4, 0.785, 2.0}) {
      const Scene s = sheared_block(d, angle);
      const Posed turned = s.system(mesh_nodes(s));
      Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
      if (d == 3) axis << 1, -2, 0.5;
      const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
      Vector v(u.size());
      for (Index k = 0; k < u.size(); k += d)
        v.segment(k, d) = R.topLeftCorner(d, d) * u.segment(k, d);
      const Certificate after = certify(turned.problem(), turned.to_local(v));
      EXPECT_NEAR(after.residual, before.residual, 1e-9 * before.residual) << d << " " << angle;
      EXPECT_NEAR(after.scale, before.scale, 1e-9 * before.scale) << d << " " << angle;
    }
  }
}

TEST(Certificate, ItsScaleIsThatOfTheStateNotOfTheIncrementsThatLedThere) {
  const BlockOptions o;
  for (const Scene& whole : {sheared_block(), brought_from_far(o, 1)}) {
    const Solved at = solved(whole);
    const Vector u = at.posed.to_global(at.x);
    const Real scale = certify(at.problem(), at.x).scale;
    for (Real part : {0.3, 0.9, 1.0}) {
      Scene s = whole;
      s.u_old = part * u;
      const Posed rest = s.system(mesh_nodes(s));
      const Real after = certify(rest.problem(), rest.to_local(u - s.u_old)).scale;
      EXPECT_NEAR(after, scale, 1e-9 * scale) << part;
    }
  }
}

TEST(Certificate, ItsScaleDoesNotFollowDirichletDataThatOnlyMoveTheBody) {
  const BlockOptions o;
  const Solved near = solved(brought_from_far(o, 0));
  const Real scale = certify(near.problem(), near.x).scale;
  for (Real D : {10.0, 1000.0}) {
    const Scene s = brought_from_far(o, D);
    const Posed far = s.system(mesh_nodes(s));
    Vector u = near.posed.to_global(near.x);
    for (Index k = 1; k < u.size(); k += 2) u[k] -= D;
    const Certificate c = certify(far.problem(), far.to_local(u));
    EXPECT_NEAR(c.scale, scale, 1e-7 * scale) << D;
    EXPECT_LT(c.residual, 10 * c.attainable) << D;
  }
}

TEST(Certificate, WhereNothingTouchesAndNothingLoadsItsScaleIsTheForceThatClosesTheNearestGap) {
  ContactProblem p = one_node(Law::coulomb, 0.3);  // sqrt(k) = 2, 3
  p.increment.F << -4, 9e-3;
  p.increment.gap[0] = 2;
  EXPECT_DOUBLE_EQ(certify(p, Eigen::Vector2d(-1, 0)).scale, std::sqrt(4 + 9e-6));  // |F| < 2 3
  p.increment.gap[0] = -0.5;
  const Certificate c = certify(p, Eigen::Vector2d(-1, 0));
  EXPECT_DOUBLE_EQ(c.scale, 2 * 0.5);
  EXPECT_DOUBLE_EQ(c.residual, 3e-3);
  p.increment.gap[0] = -1 + 1e-6;  // nearer than the violation: nothing proves that it is open
  EXPECT_DOUBLE_EQ(certify(p, Eigen::Vector2d(-1, 0)).residual, 1);
}

TEST(Certificate, WhereAllIsRoundingItsScaleIsWhatDrivesTheBody) {
  const BlockOptions o;
  for (Real gap : {2.0, 1.0}) {  // clear of the obstacle, and brought there to touch it
    const Solved at = solved(driven_block(o, {0, -1, 0}, gap));
    const Certificate c = certify(at.problem(), at.x);
    EXPECT_NEAR(c.scale, norm_D(*at.problem().system, at.problem().increment.F), 1e-9 * c.scale);
    EXPECT_LT(c.residual, 1e-12);
  }
}

TEST(Certificate, ForcesWithinTenTimesTheirRoundingAreTakenForRounding) {
  // sqrt(k) = 2, 3; |F| = 20 stands for Dirichlet data, r_N and the load for what is at work
  ContactProblem p = one_node(Law::coulomb, 0.3);
  const auto scale = [&](Real r_N, Real load, Real rounding) {
    p.increment.F << r_N, 60;
    p.increment.load_norm = load;
    p.increment.rounding = rounding;
    return certify(p, Eigen::Vector2d(0, 60.0 / 9)).scale;
  };
  EXPECT_NEAR(scale(2e-3, 0, 0.99e-4), 1e-3, 1e-12);
  EXPECT_NEAR(scale(2e-3, 0, 1.01e-4), 20, 1e-3);
  EXPECT_NEAR(scale(0, 1e-3, 1.01e-4), 20, 1e-3);
  EXPECT_NEAR(scale(0, 1e-3, 0.99e-5), 1e-3, 1e-12);        // nothing touches: the load
  EXPECT_NEAR(scale(2e-7, 1e-3, 0.99e-7), 1e-5, 1e-9);      // a hundredth of it
  EXPECT_NEAR(scale(2e-7, 1e-3, 0.99e-4), 0.99e-4, 1e-12);  // never below rounding
}

TEST(Certificate, AnswersAreNoBetterKnownThanTheLoad) {
  ContactProblem p = one_node(Law::frictionless, 0);
  p.increment.F << 0, 0;
  p.increment.load_norm = 1;
  for (Real rounding : {1e-9, 1e-3, 0.05}) {
    p.increment.rounding = rounding;
    const Certificate c = certify(p, Eigen::Vector2d(0, 0));
    EXPECT_NEAR(c.residual, 0.1 * rounding, 1e-12);
    EXPECT_TRUE(may_be_rounding(c));
  }
}

TEST(Certificate, OfALoadThatInertiaTakesSoMuchCountsAsRoundingAllowsToKnow) {
  ContactProblem p = one_node(Law::coulomb, 0.3);
  const auto scale = [&](Real external, Real rounding) {
    p.increment.F << 0, 0;
    p.increment.load_norm = 1e-6;
    p.increment.external_norm = external;
    p.increment.rounding = rounding;
    return certify(p, Eigen::Vector2d(0, 0)).scale;
  };
  EXPECT_NEAR(scale(10, 1e-20), 1e-6, 1e-18);
  EXPECT_NEAR(scale(10, 1e-13), 1e-2, 1e-12);
  EXPECT_NEAR(scale(10, 1e-9), 10, 1e-12);
}

TEST(Certificate, ABodyThatStopsShortOfTheObstacleIsNotTakenForOpen) {
  // nothing touches yet, and what is left to go is small beside the way: 1e-9 of the load
  BlockOptions o;
  const Scene s = brought_from_far(o, 1e6);
  const Posed far = s.system();
  Vector u = Vector::Zero(s.n);
  for (Index k = 1; k < s.n; k += 2) u[k] = -1e6 + 1e-3;
  const Certificate c = certify(far.problem(), far.to_local(u));
  EXPECT_LT(c.residual * c.scale, 1e-8 * norm_D(*far.problem().system, far.problem().increment.F));
  EXPECT_GT(c.residual, 0.5);
}

TEST(Certificate, RoundingAllowsLessTheFartherTheBodyComesFrom) {
  const BlockOptions o;
  Real last = 0;
  for (Real D : {1.0, 1e3, 1e6}) {
    const Scene s = brought_from_far(o, D);
    const Posed far = s.system();
    const Certificate c = certify(far.problem(), solve(far.problem(), Settings()).x);
    EXPECT_GT(c.attainable, 100 * last) << D;
    last = c.attainable;
  }
  EXPECT_GT(last, 1e-6);
}

TEST(Certificate, RoundingOfTheTermsOfTheLoadCounts) {
  ContactProblem p = one_node(Law::coulomb, 0.3);
  p.increment.F << 1, 0;
  p.increment.load_norm = 0.5;
  const Real alone = certify(p, Eigen::Vector2d(0, 0)).attainable;
  EXPECT_EQ(alone, 0);
  p.increment.rounding = 1e-7;
  const Certificate c = certify(p, Eigen::Vector2d(0, 0));
  EXPECT_NEAR(c.attainable, 1e-7 / c.scale, 1e-20);
}

TEST(Certificate, ASeparatedNodeCarriesNoTangentialForceWhateverItsFriction) {
  // open by 0.75 with the rounding-size r_N = 1e-9: times mu it would allow the whole force
  ContactProblem p = one_node(Law::coulomb, 1e6);
  p.increment.F << -3, 1e-3;
  const Vector x = Eigen::Vector2d(-0.75 - 2.5e-10, 0);
  p.increment.load_norm = norm_D(*p.system, p.increment.F);
  const Certificate c = certify(p, x);
  EXPECT_NEAR(c.r[0], 1e-9, 1e-15);
  EXPECT_NEAR(c.friction * c.scale, 1e-3 / 3, 1e-12);
}

TEST(Certificate, SeesEachLawBroken) {
  const Solved at = solved(sheared_block());
  const ContactProblem& p = at.problem();
  EXPECT_LT(certify(p, at.x).residual, 1e-8);
  Vector y = at.x;
  y[0] += 1e-3;
  EXPECT_GT(certify(p, y).equilibrium, 1e-3);
  y = at.x;
  y[p.system->first[3]] += 1e-3;  // penetration
  EXPECT_GT(certify(p, y).normal, 1e-3);
  y = at.x;
  y[p.system->first[3] + 1] += 1e-3;  // sliding without its force
  EXPECT_GT(certify(p, y).friction, 1e-3);
}

TEST(Certificate, TheTwoTangentsOfANodeShareOneStiffness) {
  // k_T = 4 and 16: stuck at (1, 0) and at (0, 1) are equally wrong, by c_T = 10
  const ContactProblem p = one_node(Eigen::Vector3d(4, 4, 16), Law::tresca, 1e3);
  const Certificate first = certify(p, Eigen::Vector3d(0, 1, 0)),
                    second = certify(p, Eigen::Vector3d(0, 0, 1));
  EXPECT_NEAR(first.friction * first.scale, std::sqrt(10.0), 1e-14);
  EXPECT_NEAR(second.friction * second.scale, std::sqrt(10.0), 1e-14);
}

TEST(Certificate, WithoutALoadNothingIsDividedByZero) {
  BlockOptions o;
  o.pressure = o.shear = 0;
  const Scene s = block(o);
  const Posed system = s.system();
  EXPECT_EQ(certify(system.problem(), Vector::Zero(system.problem().dofs())).residual, 0);
  const Solution solution = solve(system.problem(), Settings());
  EXPECT_EQ(solution.status, Status::converged);
}

TEST(Certificate, WithoutALoadAFieldThatIsNotZeroIsAsWrongInAnyUnit) {
  BlockOptions o;
  o.pressure = o.shear = 0;
  o.clamp_side = true;
  const Scene s = block(o);
  const Posed system = s.system();
  const Vector x = Vector::Random(system.problem().dofs());
  for (Real size : {1.0, 1e-9, 1e-30}) EXPECT_GT(certify(system.problem(), size * x).residual, 0.1);
}

TEST(Certificate, APenetrationWithoutALoadIsMeasuredByTheForceThatClosesIt) {
  ContactProblem p = one_node(Law::frictionless, 0);
  p.increment.gap[0] = -0.5;
  const Certificate open = certify(p, Eigen::Vector2d(0, 0));
  EXPECT_DOUBLE_EQ(open.scale, 2 * 0.5);  // sqrt(4) 0.5
  EXPECT_DOUBLE_EQ(open.residual, 1);
  EXPECT_LT(certify(p, Eigen::Vector2d(-0.5, 0)).residual, 1e-15);
  p.increment.gap[0] = 0.5;
  EXPECT_EQ(certify(p, Eigen::Vector2d(0, 0)).residual, 0);
  p.increment.bilateral = true;  // a gap that has to close
  EXPECT_DOUBLE_EQ(certify(p, Eigen::Vector2d(0, 0)).residual, 1);
}

TEST(Certificate, MagnitudeIsTheProductOfTheSizes) {
  AssembledSystem s;
  s.A = sparse(2, 2, {{0, 0, 2}, {0, 1, -3}, {1, 0, -3}, {1, 1, 5}});
  Vector Ax;
  const Vector size = s.multiply_sized(Eigen::Vector2d(1, -1), Ax);
  EXPECT_EQ(size[0], 5);
  EXPECT_EQ(size[1], 8);
}

TEST(States, AreThoseOfTheForcesOfASolvedBlock) {
  const Solved at = solved(sheared_block());
  const ContactProblem& p = at.problem();
  const Certificate c = certify(p, at.x);
  const auto state = classify(p, at.x, c);
  int count[4] = {0, 0, 0, 0};
  for (Index k = 0; k < p.nodes(); ++k) {
    ++count[int(state[k])];
    const Index N = p.system->first[k];
    if (state[k] == NodeState::separated) {
      EXPECT_NEAR(c.r[N], 0, 1e-6);
    } else {
      EXPECT_NEAR(at.x[N], 0, 1e-9);
      EXPECT_GT(c.r[N], 0);
    }
    if (state[k] == NodeState::stick) {
      EXPECT_NEAR(at.x[N + 1], 0, 1e-9);
    }
    if (state[k] == NodeState::slip) {
      EXPECT_NEAR(std::abs(c.r[N + 1]), 0.3 * c.r[N], 1e-6);
    }
  }
  EXPECT_GT(count[int(NodeState::slip)], 0);
  EXPECT_GT(count[int(NodeState::stick)] + count[int(NodeState::separated)], 0);
}

namespace {

/// State of one node on springs k = (4, 9) at x, with the force (r_N, r_T) left to the obstacle.
NodeState state(Law law, Real coefficient, Eigen::Vector2d x, Eigen::Vector2d r, Real gap = 0,
                Real cohesion = 0) {
  ContactProblem p = one_node(law, coefficient);
  p.increment.cohesion = Vector::Constant(1, cohesion);
  p.increment.gap[0] = gap;
  p.increment.F = r + Eigen::Vector2d(4 * x[0], 9 * x[1]);
  p.increment.load_norm = 100;  // the scale is 1
  return classify(p, x, certify(p, x))[0];
}

}  // namespace

TEST(States, ANodeThatTouchesByItsCohesionAloneSlidesWhereItHasMoved) {
  EXPECT_EQ(state(Law::coulomb, 0.3, {0, 0}, {0, 0.2}, 0, 0.5), NodeState::stick);
  EXPECT_EQ(state(Law::coulomb, 0.3, {0, 1e-3}, {0, 0.2}, 0, 0.5), NodeState::slip);
  EXPECT_EQ(state(Law::coulomb, 0.3, {0, 0}, {0.1, 0.2}, 0, 0.5), NodeState::stick);
  EXPECT_EQ(state(Law::coulomb, 0.3, {0, 1}, {0.1, 0.53}, 0, 0.5), NodeState::slip);
}

TEST(States, ANodeIsSeparatedBeyondRoundingOnly) {
  EXPECT_EQ(state(Law::coulomb, 0.3, {-1, 0}, {0, 0}), NodeState::separated);
  EXPECT_EQ(state(Law::coulomb, 0.3, {-1e-6, 0}, {0, 0}), NodeState::separated);
  EXPECT_EQ(state(Law::coulomb, 0.3, {-1e-11, 0}, {0, 0}), NodeState::stick);
  EXPECT_EQ(state(Law::coulomb, 0.3, {-1, 0}, {0, 0}, -1), NodeState::stick);
  EXPECT_EQ(state(Law::frictionless, 0, {0, 0}, {1, 0}), NodeState::slip);
  EXPECT_EQ(state(Law::frictionless, 0, {-1, 0}, {0, 0}), NodeState::separated);
}

TEST(States, AForceInsideItsLimitSticksAndOneAtItsLimitThatMovesSlips) {
  EXPECT_EQ(state(Law::coulomb, 0.3, {0, 0}, {1, 0.2}), NodeState::stick);
  EXPECT_EQ(state(Law::coulomb, 0.3, {0, 1}, {1, 0.3}), NodeState::slip);
  EXPECT_EQ(state(Law::coulomb, 0.3, {0, -1e-8}, {1, -0.3}), NodeState::slip);
  EXPECT_EQ(state(Law::coulomb, 0.3, {0, 1}, {1, 0.3 - 1e-12}), NodeState::slip);
  EXPECT_EQ(state(Law::coulomb, 0.5, {0, 0}, {1, 0.5}), NodeState::stick);  // just held
  EXPECT_EQ(state(Law::tresca, 0.3, {0, 0}, {1, 0.2}), NodeState::stick);
  EXPECT_EQ(state(Law::tresca, 0.3, {0, 1}, {1, 0.3}), NodeState::slip);
}

TEST(States, ANodeWhoseLimitIsZeroSlidesFreelyMovedOrNot) {
  for (Law law : {Law::coulomb, Law::tresca})
    for (Real x_T : {0.0, 1.0}) EXPECT_EQ(state(law, 0, {0, x_T}, {1, 0}), NodeState::slip);
}

TEST(States, ANodeThatTouchesWithoutAForceFollowsItsDisplacement) {
  for (Real r_N : {1e-12, 0.0, -1e-12}) {
    EXPECT_EQ(state(Law::coulomb, 0.3, {0, 0}, {r_N, 0}), NodeState::stick) << r_N;
    EXPECT_EQ(state(Law::coulomb, 0.3, {0, 1e-8}, {r_N, 1e-13}), NodeState::stick) << r_N;
    EXPECT_EQ(state(Law::coulomb, 0.3, {0, 1e-3}, {r_N, 1e-13}), NodeState::slip) << r_N;
    EXPECT_EQ(state(Law::coulomb, 1e9, {0, 1e-3}, {r_N, 1e-13}), NodeState::slip) << r_N;
  }
  EXPECT_EQ(state(Law::tresca, 1e-13, {0, 0}, {1, 0}), NodeState::stick);
  EXPECT_EQ(state(Law::tresca, 1e-13, {0, 1e-3}, {1, 1e-13}), NodeState::slip);
}

TEST(States, BilateralContactTouchesUnderTension) {
  ContactProblem p = one_node(Law::coulomb, 0.5);
  p.increment.bilateral = true;
  p.increment.F << -2, 0.9;
  EXPECT_EQ(classify(p, Vector::Zero(2), certify(p, Vector::Zero(2)))[0], NodeState::stick);
  p.increment.F << -2, 1.0 + 9;
  const Eigen::Vector2d x(0, 1);
  EXPECT_EQ(classify(p, x, certify(p, x))[0], NodeState::slip);
}

TEST(States, ANodeWhoseTangentsAreHeldSticksWithFrictionAndSlipsWithout) {
  ContactProblem p = one_node(Vector::Constant(1, 4.0), Law::coulomb, 0.3);
  p.increment.F << 1;
  EXPECT_EQ(classify(p, Vector::Zero(1), certify(p, Vector::Zero(1)))[0], NodeState::stick);
  p.increment.mu[0] = 0;
  EXPECT_EQ(classify(p, Vector::Zero(1), certify(p, Vector::Zero(1)))[0], NodeState::slip);
}

TEST(States, ALooseAnswerLeavesMoreInDoubtButNotEverything) {
  // the equilibrium of a second spring is off by `error`; the node is open by 1e-8 or 1e-4
  const auto state_at = [](Real error, Real open) {
    const auto s = std::make_shared<AssembledSystem>();
    s->A.resize(3, 3);
    for (Index i = 0; i < 3; ++i) s->A.insert(i, i) = 1;
    s->A.makeCompressed();
    s->D = Vector::Ones(3);
    s->first = {1, 3};
    s->weight = node_weights(*s);
    ContactProblem p{s, {}};
    p.increment.F = Eigen::Vector3d(1 + error, -open, 0);
    p.increment.gap = Vector::Zero(1);
    p.increment.law = Law::coulomb;
    p.increment.mu = Vector::Constant(1, 0.3);
    p.increment.load_norm = 1;
    const Eigen::Vector3d x(1, -open, 0);
    return classify(p, x, certify(p, x))[0];
  };
  EXPECT_EQ(state_at(0, 1e-8), NodeState::separated);
  EXPECT_EQ(state_at(1e-7, 1e-8), NodeState::stick);
  EXPECT_EQ(state_at(1e-2, 1e-8), NodeState::stick);
  EXPECT_EQ(state_at(1e-2, 1e-4), NodeState::separated);
}
