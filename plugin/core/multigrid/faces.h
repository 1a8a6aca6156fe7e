#pragma once
#include "model/branch.h"
#include "model/law.h"
#include "multigrid/hierarchy.h"

namespace frictioncg {

/// The faces of all contact nodes, and what they make of the linear system: which dofs they fix,
/// and the rows of slip. Vectors of the contact dofs (contact_dofs) carry the suffix C.
///
/// Branches are chosen from forces that obey the present laws, f where a node slips and 0 where it
/// is open, not from b: an inexact x leaves b on slipping nodes anywhere.
class Faces {
 public:
  explicit Faces(const ContactProblem& problem);

  void start_from(const Vector& x, const Vector& b_C);  ///< the branches that any (x, b) is on

  void start_from(const Branches& faces);  ///< m, of another increment
  const Branches& all() const { return face_; }

  /// The branches that the laws ask for at x, b.
  void choose(const Vector& x, const Vector& b_C);

  /// Takes g of the slip rows as it was when the branches were chosen: the rows become symmetric.
  void lag(bool lagged) { lagged_ = lagged; }

  void place(Vector& x) const;  ///< x onto the faces: x_N = gap, x_T = 0
  /// Contact rows of the residual of the present linear system, 0 on fixed dofs.
  void residual(const Vector& x, const Vector& b_C, Eigen::Ref<Vector> s_C) const;
  /// Contact rows of the Jacobian on z, from those of A z.
  void jacobian(const Vector& z, const Vector& Az_C, Eigen::Ref<Vector> Jz_C) const;
  /// By how much x, b violate the laws as certify sees them, in norm_D.
  Real violation(const Vector& x, const Vector& b_C) const;
  /// How far the friction of sliding nodes is from the direction of their slip, in norm_D: of each
  /// the slip as a force, or what friction misses of minus its limit along the slip, whichever is
  /// less. Where a node hardly slides the certificate does not see it: its residual is of second
  /// order, slip times angle.
  Real misdirection(const Vector& x, const Vector& b_C) const;

  const std::vector<char>& fixed() const { return fixed_; }                 ///< contact_dofs
  const std::vector<TangentialStiffness>& stiffness() const { return W_; }  ///< of the slip rows

 private:
  Index normal(Index i) const { return system_.first[i] - system_.interior(); }
  Eigen::Vector2d friction(Index i, const Vector& x, const Vector& b_C) const;
  void update_rows();

  const System& system_;
  const Increment& increment_;
  Branches face_;
  Vector c_;    ///< m [force/length]: of the choice between stick and slip
  Vector c_D_;  ///< m, weight of the tangents: that of the certificate
  std::vector<char> fixed_;
  std::vector<TangentialStiffness> W_;
  bool lagged_ = false;
};

/// The faces where Newton's method starts: stick (all_stick), and open where free obstacles do not
/// reach under their loads f, if each contact node i has a spring k_i of its own for a body:
///
///   min_q  1/2 sum_closed k_i (|(C_i q)_N - gap_i|^2 + |(C_i q)_T|^2) - f'q,
///   closed: (C_i q)_N >= gap_i
///
/// C being the border. From stick everywhere a sphere sticks to what it does not touch, and lets
/// go of it step by step. Stick, too, where the closed nodes could not hold f.
Branches reached(const ContactProblem& problem);

}  // namespace frictioncg
