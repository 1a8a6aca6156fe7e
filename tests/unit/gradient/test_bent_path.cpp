// The path beyond the first gap, against the minimum of J along it.
#include <gtest/gtest.h>

#include "core/gradient/bent_path.h"
#include "unit/scene.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

ContactProblem pressed(Law law) {
  BlockOptions o;
  o.cells = 6;
  o.clamp_side = true;
  o.law = law;
  o.mu = 0.05;
  ContactProblem p = block(o).system().problem();
  p.increment.gap.setConstant(1e6);  // out of reach
  return p;
}

/// A step from x = 0 on, to the gap of one node and beyond.
struct Bend {
  const ContactProblem& p;
  Iterate it;
  std::unique_ptr<Preconditioner> P;
  LineSearch search;

  explicit Bend(const ContactProblem& problem)
      : p(problem),
        it(p),
        P(make_preconditioner(*p.system, Precon::diagonal, 1)),
        search(*p.system, Step::exact) {
    it.x = Vector::Zero(p.dofs());
    it.g = p.increment.law == Law::tresca ? p.increment.g : Vector(Vector::Zero(p.nodes()));
    it.faces.start(it.x, it.g, Tangents::sliding, false);
    it.rows.start(p.increment.F);
    P->start(p.increment.F);
    it.phi = {Regularization::square_root, 1e-5};
    it.update_friction();
    P->set_contact(it.r, it.part);
  }
  Real beyond_the_gap(const Vector& v) {
    Line line;
    line.vAv = P->curvature(v);
    line.a = p.increment.F.dot(v);
    const Real rho = it.faces.step_to_gap(it.x, v);
    P->advance(rho, v, it.x);
    it.rows.advance(rho, v);
    EXPECT_TRUE(it.faces.close_gaps(it.x, v, rho));
    return follow_bent_path(it, *P, search, v, rho, line);
  }
  /// J' along w at x.
  Real slope(const Vector& w) const {
    Real sum = (p.system->entries() * it.x - p.increment.F).dot(w);
    for (Index i = 0; i < p.nodes(); ++i) {
      const Index T = p.system->first[i] + 1, t = p.tangents(i);
      const Vector x_T = it.x.segment(T, t);
      if (it.g[i] > 0) sum += it.g[i] * it.phi.slope_over_t(x_T.norm()) * x_T.dot(w.segment(T, t));
    }
    return sum;
  }
};

/// The way of the body without an obstacle, held by some springs.
Vector way_down(const ContactProblem& p) {
  Eigen::MatrixXd A = p.system->entries();
  A.diagonal() *= 1.1;
  return A.llt().solve(p.increment.F);
}

/// The node whose normal moves most.
Index foremost(const ContactProblem& p, const Vector& v) {
  Index most = 0;
  for (Index i = 0; i < p.nodes(); ++i)
    if (v[p.system->first[i]] > v[p.system->first[most]]) most = i;
  return most;
}

}  // namespace

TEST(BentPath, EndsWhereJIsLeastAlongTheBentDirection) {
  for (Law law : {Law::frictionless, Law::tresca}) {
    ContactProblem p = pressed(law);
    Vector v = way_down(p);
    const Real a = p.increment.F.dot(v), least = a / v.dot(p.system->entries() * v);
    const Index node = foremost(p, v), N = p.system->first[node];
    p.increment.gap[node] = 0.1 * least * v[N];
    Bend bend(p);
    EXPECT_GT(bend.beyond_the_gap(v), 0);
    EXPECT_EQ(bend.it.x[N], p.increment.gap[node]);
    v[N] = 0;
    EXPECT_NEAR(bend.slope(v), 0, 1e-12 * a) << int(law);
  }
}

TEST(BentPath, StaysAtTheGapWhereJDoesNotFallBeyond) {
  for (Law law : {Law::frictionless, Law::tresca}) {
    ContactProblem p = pressed(law);
    const Vector down = way_down(p);
    const Index node = foremost(p, down), N = p.system->first[node];
    p.increment.gap[node] = 1e-6;
    Bend bend(p);
    Vector v = -1e-3 * down;
    v[N] = down[N];
    EXPECT_EQ(bend.beyond_the_gap(v), 0);
    v *= p.increment.gap[node] / v[N];
    EXPECT_LT((bend.it.x - v).norm(), 1e-14 * v.norm()) << int(law);
  }
}
