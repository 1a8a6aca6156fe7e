#pragma once
#include "freefem.h"

#include "scene.h"

namespace frictioncg {

/// Lengths that a displacement of the scene may be compared with.
struct Lengths {
  Real extent = 0;  ///< of the contact boundary
  Real moved = 0;   ///< what the load would move by the diagonal of A alone; 0 without a load
};

inline Lengths lengths_of(const Scene& scene, const Vector& b) {
  Lengths l;
  const Fem2D::R3 first = scene.nodes.front().x;
  for (const BoundaryNode& n : scene.nodes) {
    l.extent = std::max(l.extent, Norme2(n.x - first));
    l.extent = std::max(l.extent, std::pow(n.weight, 1.0 / (scene.d - 1)));
  }
  Real load = 0;
  for (long i = 0; i < scene.ndof(); ++i)
    if (!scene.held[i]) load = std::max(load, std::abs(b[i]));
  l.moved = load / scene.system->system()->D.mean();
  return l;
}

/// Refuses Dirichlet data that A and b cannot have been assembled with alike: b = tgv u_D against
/// tgv in A, so that another tgv makes u_D huge (A with -1, b with 1e30) or next to nothing (the
/// other way round). u0 (ndof): the data, at the dofs held [length].
inline void refuse_other_tgv(const Scene& scene, const Vector& b, const Vector& u0,
                             const Lengths& l) {
  constexpr Real apart = 1e20;  // between 1, for tgv=-1, and 1e30
  long most = -1;
  for (long i = 0; i < scene.ndof(); ++i)
    if (scene.held[i] && b[i] != 0 && (most < 0 || std::abs(u0[i]) > std::abs(u0[most]))) most = i;
  if (most < 0) return;
  const Real u = std::abs(u0[most]);
  const bool huge = u > apart * std::max(l.extent, l.moved);
  const bool tiny = u * apart < (l.moved > 0 ? std::min(l.extent, l.moved) : l.extent);
  if (!huge && !tiny) return;
  std::ostringstream m;
  m << "b[" << most << "] = " << b[most] << " prescribes a displacement of " << u0[most]
    << " in the Dirichlet row of A; A and b were assembled with different tgv: give both the same, "
       "as in a(Vh, Vh, tgv=-1) and a(0, Vh, tgv=-1)";
  throw IllegalInput(m.str());
}

}  // namespace frictioncg
