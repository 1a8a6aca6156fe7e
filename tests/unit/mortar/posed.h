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
  bool rotated = false;
};

Answer solve_contact(const Scene& s, Real mu, const Settings& settings, bool unit_rows = false,
                     const Vector& u_old = {}, bool bilateral = false);

}  // namespace frictioncg::mortar::test
