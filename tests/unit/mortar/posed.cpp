#include "posed.h"

namespace frictioncg::mortar::test {

namespace {

/// The contact points of a mortar, one per contact node, in their order; without friction as yet.
std::vector<ContactPoint> contact_points(const Mortar& mortar, const NodeDofs& dof) {
  std::vector<ContactPoint> points;
  for (const SlaveNode& node : mortar.nodes()) {
    ContactPoint point;
    point.dof = dof[node.node];
    for (int c = 0; c < 3; ++c) point.normal[c] = node.normal[c];
    points.push_back(point);
  }
  return points;
}

}  // namespace

Answer solve_contact(const Scene& s, Real mu, const Settings& settings, bool unit_rows,
                     const Vector& u_old, bool bilateral) {
  const Assembled assembled(s, unit_rows);
  const Triplets A = assembled.triplets();
  const int d = s.d();
  NodeDofs dof(s.bodies.X.size());
  for (Index i = 0; i < s.bodies.nodes(); ++i)
    for (int c = 0; c < d; ++c) dof[i][c] = d * i + c;
  const Dirichlet dirichlet(A, {});
  const Mortar mortar({d, s.bodies.X, held_components(d, dof, dirichlet)}, s.pairs, s.options);
  std::vector<ContactPoint> points = contact_points(mortar, dof);
  for (ContactPoint& p : points) p.friction = mu > 0;
  const LocalSystem local(A, d, points, {}, dirichlet, couple(mortar, d, dof, dirichlet, A.n));
  PointLaws laws;
  laws.law = mu > 0 ? Law::coulomb : Law::frictionless;
  laws.bilateral = bilateral;
  laws.gap.resize(Index(points.size()));
  laws.mu = Vector::Constant(Index(points.size()), mu);
  for (std::size_t k = 0; k < points.size(); ++k) laws.gap[Index(k)] = mortar.nodes()[k].gap;
  const LocalIncrement now = local.increment(assembled.b, u_old, laws);
  Solver solver(local.system());
  Answer answer;
  answer.solution = solver.solve(now.increment, settings);
  answer.u = local.to_global(answer.solution.x, now.u0);
  answer.force = local.force_to_global(answer.solution.certificate.r);
  answer.nodes = local.nodes();
  answer.rotated = local.rotated();
  return answer;
}

}  // namespace frictioncg::mortar::test
