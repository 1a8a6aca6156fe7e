#pragma once
// Scenes of two bodies as contact problems, through the whole core.
#include "core/assembly/local_system.h"
#include "core/assembly/mortar/coupling.h"
#include "core/solver.h"
#include "tied.h"

namespace frictioncg::mortar::test {

/// The triplets of a scene with Dirichlet rows of tgv = 1e30 or, with unit_rows, of the identity.
struct Assembled {
  std::vector<Index> i, j;
  std::vector<Real> a;
  Vector b;
  Triplets triplets() const { return {Index(b.size()), a.size(), i.data(), j.data(), a.data()}; }

  Assembled(const Scene& s, bool unit_rows) : b(s.load) {
    const Matrix A = s.bodies.stiffness();
    for (Index row = 0; row < A.rows(); ++row) {
      const bool held = s.held[row / s.d()] >> (row % s.d()) & 1;
      for (Matrix::InnerIterator it(A, row); it; ++it) {
        const bool diagonal = it.col() == row;
        i.push_back(row);
        j.push_back(Index(it.col()));
        a.push_back(!held       ? it.value()
                    : diagonal  ? (unit_rows ? 1 : 1e30)
                    : unit_rows ? 0
                                : it.value());
      }
      if (held) b[row] = s.data[row] * (unit_rows ? 1 : 1e30);
    }
  }
};

struct Answer {
  Solution solution;
  Vector u, force;  ///< force: of the contact, on both bodies
  Index nodes = 0;
};

inline Answer solve_contact(const Scene& s, Real mu, const Settings& settings,
                            bool unit_rows = false, const Vector& u_old = {},
                            bool bilateral = false) {
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
  laws.friction = Vector::Constant(Index(points.size()), mu);
  for (std::size_t k = 0; k < points.size(); ++k) laws.gap[Index(k)] = mortar.nodes()[k].gap;
  const LocalIncrement now = local.increment(assembled.b, u_old, laws);
  Solver solver(local.system());
  Answer answer;
  answer.solution = solver.solve(now.increment, settings);
  answer.u = local.to_global(answer.solution.x, now.u0);
  answer.force = local.force_to_global(answer.solution.certificate.r);
  answer.nodes = local.nodes();
  return answer;
}

}  // namespace frictioncg::mortar::test
