#pragma once
#include "condensed/semismooth_newton.h"
#include "condensed/path_matrix.h"

namespace frictioncg {

/// A primal-dual interior point on the coupled laws, where active sets do not settle: in slender
/// and soft bodies each node that opens or closes moves all others. With s = gap - x_N, and t_i a
/// bound on the slip, the central path is
///   S x + r = f,   s r_N = tau,   g t - r_T.x_T = tau,   t r_T - g x_T = 0,
///   s, r_N > 0,  g > |r_T|,  t > |x_T|,  g = min(c + mu r_N, cap) or given,
/// and its end, tau = 0, obeys the laws: unilateral contact, and r_T = g x_T/|x_T| or x_T = 0. Only
/// cohesion c is not theirs: open nodes keep it along the path, and lose it to Newton's method
/// after it. Everything is scaled by D^{1/2}. A step is Newton's, along Mehrotra's predictor and
/// corrector.
class CentralPath {
 public:
  explicit CentralPath(const CondensedProblem& problem);

  /// On the last dofs of a problem, or on all of them. K: as f and x, in units of D^{1/2}; D > 0.
  CentralPath(const ContactProblem& laws, std::unique_ptr<PathMatrix> K, const Vector& f,
              const Vector& D, Observer* observer);

  /// Along the path towards its end; returns the steps it took. Where it cannot start, and for
  /// bilateral contact, none.
  Index follow(Index max_steps);
  /// On from its end, as far as rounding lets it. Returns the number of steps; 0 where they lead
  /// nowhere.
  Index go_on(Index max_steps);
  /// It stood still long before its end: as a start this is none.
  bool stalled() const { return mean_product(at_) > far_from_end * first_; }

  Vector x() const { return at_.y.cwiseQuotient(unit_); }

 private:
  /// A point of the path, or a step between two.
  struct Point {
    Vector y, r, s, t;  ///< n, n, m, m
  };
  /// The laws of a node in a step: dr = c + M dx.
  struct Linear {
    NodeVector c;
    NodeBlock M;
    Real rest = 0;  ///< right side of the law that has dt
  };
  static constexpr Real far_from_end = 1e-2;

  bool start();
  Index follow_to(Real goal, Index most);
  Vector pulled_to(const Vector& gap) const;
  void bring_near();
  bool bring_further();
  void make_positive();
  Real mean_product(const Point& p) const;
  bool factor();
  void linearize(Real tau, const Point* before);
  void linearize_friction(Index i, Real tau, const Point* before);
  Point step();
  Real room(const Point& d) const;
  void move(Point& p, const Point& d, Real part) const;
  void cut_shear();
  Real uncapped(Index i, const Point& p) const { return mu_[i] * p.r[normal(i)] + g_[i]; }
  Real limit(Index i, const Point& p) const { return std::min(uncapped(i, p), cap_[i]); }
  /// Of the limit, over r_N.
  Real slope(Index i) const { return uncapped(i, at_) < cap_[i] ? mu_[i] : 0; }
  Index normal(Index i) const { return problem_.system->first[i] - offset_; }
  Index tangents(Index i) const { return problem_.tangents(i); }

  const ContactProblem& problem_;
  const std::unique_ptr<PathMatrix> K_;
  Observer* const observer_;
  const Index nodes_, offset_;  ///< dofs that the path leaves out come first
  /// unit = D^{1/2}; the others in its units. g: given limits, or cohesion
  Vector unit_, f_, gap_, mu_, g_, cap_;
  Vector true_gap_;  ///< m; gap_ may be nearer, where nothing reaches either
  std::vector<char> closes_, rubs_;
  bool symmetric_ = true;
  std::vector<Linear> laws_;  ///< m
  Point at_;
  Real first_ = 0;  ///< mean product at the start; 0 before it
};

/// The central path, and Newton's method on the laws themselves from the branches at its end.
Attempt by_interior_point(const CondensedProblem& problem, Index max_steps);

}  // namespace frictioncg
