#pragma once
#include "freefem.h"

#include "scene.h"

namespace frictioncg {

/// What the data of a call may be compared with.
struct Scales {
  Real extent = 0;     ///< of the contact boundary [length]
  Real moved = 0;      ///< what the load would move by the diagonal of A alone; 0 without a load
  Real stiffness = 0;  ///< mean of the diagonal of A on free dofs
  Real stiffest = 0;   ///< the largest of it
};

inline Scales scales_of(const Scene& scene, const Vector& b) {
  Scales s;
  if (scene.nodes.empty()) s.extent = 2 * extent_of(scene.places()).radius;  // nothing faces
  for (const BoundaryNode& n : scene.nodes) {
    s.extent = std::max(s.extent, Norme2(n.x - scene.nodes.front().x));
    s.extent = std::max(s.extent, std::pow(n.weight, 1.0 / (scene.d - 1)));
  }
  Real load = 0;
  for (long i = 0; i < scene.ndof(); ++i)
    if (!scene.held[i]) load = std::max(load, std::abs(b[i]));
  const Vector& D = scene.system->system()->D;
  s.stiffness = D.mean();
  s.stiffest = D.size() > 0 ? D.maxCoeff() : 0;
  s.moved = load / s.stiffness;
  return s;
}

/// A dof in words: u1, and (0, 0.5).
struct DofInWords {
  std::string component = "u", place = "a node";
};
inline DofInWords in_words(const Scene& scene, long dof) {
  for (const NodePlace& n : scene.places())
    for (int c = 0; c < scene.d; ++c)
      if (n.dof[c] == dof) return {"u" + std::to_string(c + 1), coordinates(as_R3(n.x), scene.d)};
  return {};
}

constexpr const char* assemble_both = "assemble A and b by one varf, as in a(Vh, Vh) and a(0, Vh)";

/// Refuses Dirichlet data in b, tgv u_D, where A has no Dirichlet row: they would be a load that
/// moves the body 1e10 times its own size and more. Larger than tgv makes them is a mere overflow.
inline void refuse_data_without_row(const Scene& scene, const Vector& b, const Scales& s) {
  constexpr Real absurd = 1e10, overflow = 1e60;
  for (long i = 0; i < scene.ndof(); ++i) {
    const Real size = std::abs(b[i]);
    if (scene.held[i] || !(size > absurd * s.extent * s.stiffness) || size > overflow) continue;
    const DofInWords dof = in_words(scene, i);
    std::ostringstream m;
    m << "b[" << i << "] = " << b[i] << " is Dirichlet data, tgv times a displacement, where A has "
      << "no Dirichlet row: it lacks the on(..., " << dof.component << "=...) at " << dof.place
      << " that b has; " << assemble_both;
    throw IllegalInput(m.str());
  }
}

/// What b has at the Dirichlet dofs of a body, where it is too small to be data of tgv = 1e30: how
/// many nodes have something there, and how many 0.
struct Leftover {
  Real loaded = 0, empty = 0;
  Real most = 0;  ///< the largest of b there [force]
  /// Of each component, the least and the largest.
  std::array<Real, 3> least, largest;

  Leftover() {
    least.fill(std::numeric_limits<Real>::infinity());
    largest.fill(-std::numeric_limits<Real>::infinity());
  }
  void add(const Scene& scene, const Vector& b, const NodePlace& n) {
    bool held = false, any = false;
    for (int c = 0; c < scene.d; ++c) {
      const Index i = n.dof[c];
      if (!scene.held[i]) continue;
      held = true;
      if (b[i] == 0) continue;
      any = true;
      most = std::max(most, std::abs(b[i]));
      least[c] = std::min(least[c], b[i]);
      largest[c] = std::max(largest[c], b[i]);
    }
    loaded += any;
    empty += held && !any;
  }
  /// One value for all nodes: forces of a mesh are smaller at the ends of a boundary.
  bool uniform() const {
    for (int c = 0; c < 3; ++c)
      if (least[c] < largest[c]) return false;
    return loaded > 2;
  }
};

/// The nodes of this process by body.
inline std::map<Index, Leftover> leftovers(const Scene& scene, const Vector& b) {
  std::map<Index, Leftover> bodies;
  for (const NodePlace& n : scene.places()) bodies[n.body].add(scene, b, n);
  return bodies;
}

/// The dof held whose data are largest, or -1 where all are 0. u0 (ndof): the data [length].
inline long largest_data(const Scene& scene, const Vector& b, const Vector& u0) {
  long most = -1;
  for (long i = 0; i < scene.ndof(); ++i)
    if (scene.held[i] && b[i] != 0 && (most < 0 || std::abs(u0[i]) > std::abs(u0[most]))) most = i;
  return most;
}

/// b = tgv u_D against tgv in A: another tgv makes u_D huge (A with -1, b with 1e30) or next to
/// nothing (the other way round), less than the rounding of an expression that should be 0.
constexpr Real tgv_ratio = 1e20;
inline bool is_huge(Real u, const Scales& s) { return u > tgv_ratio * std::max(s.extent, s.moved); }
inline bool is_tiny(Real u, const Scales& s) { return u > 0 && u * tgv_ratio < s.extent; }

[[noreturn]] inline void refuse_data(const Vector& b, const Vector& u0, long i,
                                     const std::string& why) {
  std::ostringstream m;
  m << "b[" << i << "] = " << b[i] << " prescribes a displacement of " << u0[i]
    << " in the Dirichlet row of A; " << why;
  throw IllegalInput(m.str());
}

constexpr const char* different_tgv =
    "A and b were assembled with different tgv: give both the same, as in a(Vh, Vh, tgv=-1) and "
    "a(0, Vh, tgv=-1)";

/// Refuses huge data.
inline void refuse_huge_data(const Scene& scene, const Vector& b, const Vector& u0,
                             const Scales& s) {
  const long i = largest_data(scene, b, u0);
  if (i >= 0 && is_huge(std::abs(u0[i]), s)) refuse_data(b, u0, i, different_tgv);
}

/// Data that are next to nothing are 0 where b = A U + r leaves the rest: what the other entries of
/// the row make of a displacement U, at every node, of its own size at each. Refused is what they
/// cannot make (U as large as a thousand bodies), what is the same at all nodes (data of another
/// tgv), and loads at some nodes only, 0 at most of them (b without the on() of A). i: the dof of
/// the largest data.
inline void refuse_tiny_data(const Scene& scene, const Vector& b, const Vector& u0, long i,
                             const Scales& s, const Leftover& left) {
  constexpr Real bodies = 1e3;
  if (left.uniform() || left.most > bodies * s.stiffest * s.extent)
    refuse_data(b, u0, i, different_tgv);
  if (left.loaded == 0 || left.empty < left.loaded) return;
  const DofInWords dof = in_words(scene, i);
  refuse_data(b, u0, i,
              "b lacks the on(..., " + dof.component + "=...) at " + dof.place +
                  " that A has: " + assemble_both + ", or set to 0 what b has in Dirichlet rows");
}

/// Refuses data that A and b cannot have been assembled with alike. Returns the largest entry of b
/// that counts as none, or 0. With `at` the load is A U + r, whose rows have such entries always.
inline Real check_data(const Scene& scene, const Vector& b, const Vector& u0) {
  const Scales s = scales_of(scene, b);
  refuse_data_without_row(scene, b, s);
  refuse_huge_data(scene, b, u0, s);
  const long i = largest_data(scene, b, u0);
  if (i < 0 || scene.at || !is_tiny(std::abs(u0[i]), s)) return 0;
  Real most = 0;
  for (const auto& [body, left] : leftovers(scene, b)) {
    refuse_tiny_data(scene, b, u0, i, s, left);
    most = std::max(most, left.most);
  }
  return most;
}

}  // namespace frictioncg
