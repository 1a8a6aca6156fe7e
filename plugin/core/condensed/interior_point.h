#pragma once
#include <memory>

#include "condensed/attempt.h"
#include "condensed/path_matrix.h"

namespace frictioncg {

/// A primal-dual interior point on the coupled laws, where active sets do not settle: in slender
/// and soft bodies each node that opens or closes moves all others. With s = gap - x_N, and t_i a
/// bound on the slip, the central path is
///   S x + r = f,   s r_N = tau,   g t - r_T.x_T = tau,   t r_T - g x_T = 0,
///   s, r_N > 0,  g > |r_T|,  t > |x_T|,  g = mu r_N or given,
/// and its end, tau = 0, obeys the laws: unilateral contact, and r_T = g x_T/|x_T| or x_T = 0.
/// Of cohesion c and a cap,  a = c r_N/(r_N + fade s) + mu r_N,  (a - g)(cap - g) = theta a cap:
/// theta falls with tau, and g becomes the lesser of a and cap; fade rises to 1, and open nodes
/// lose their cohesion, once those that close are told from them. Everything is scaled by D^{1/2}.
/// A step is Newton's, along Mehrotra's predictor and corrector.
class CentralPath {
 public:
  explicit CentralPath(const CondensedProblem& problem);

  /// On the last dofs of a problem, or on all of them. K: as f and x, in units of D^{1/2}; D > 0.
  CentralPath(const ContactProblem& laws, std::unique_ptr<PathMatrix> K, const Vector& f,
              const Vector& D, Observer* observer);

  /// Along the path towards its end; returns the steps it took. Where it cannot start, and for
  /// bilateral contact, none.
  Index follow(Index max_steps);

  Vector x() const { return at_.y.cwiseQuotient(unit_); }

 private:
  /// A point of the path, or a step between two; r_N apart from r_T.
  struct Point {
    Vector y, s, N, T, t;  ///< n, m, m, n (its tangential part), m
  };
  /// dr_T = a + B dx_T + e dr_N, what the laws of a node leave of friction.
  struct Friction {
    Vector a, e;    ///< n
    DenseMatrix B;  ///< d - 1 columns: the blocks of the nodes, one below the other
    Vector rest;    ///< m, right side of the law that has dt
  };
  bool start();
  void make_positive();
  Real mean_product(const Point& p) const;
  bool factor();
  void linearize(Real tau, const Point* before);
  void linearize_friction(Index i, Real tau, const Point* before);
  Point step();
  Real room(const Point& d) const;
  void move(Point& p, const Point& d, Real part) const;
  Real limit(Index i, const Point& p) const {
    return bends_[i] ? bent_limit(i, p).g : mu_[i] * p.N[i] + g_[i];
  }
  /// The limit of a node that has cohesion or a cap, and its derivatives.
  struct Bent {
    Real g, by_N, by_s;
  };
  Bent bent_limit(Index i, const Point& p) const;
  /// Of the limit, along d.
  Real change(Index i, const Point& d) const { return by_N_[i] * d.N[i] + by_s_[i] * d.s[i]; }
  bool inside(const Point& p) const;
  void choose_bends(Real fall);
  Index normal(Index i) const { return problem_.system->first[i] - offset_; }
  Index tangents(Index i) const { return problem_.tangents(i); }

  const ContactProblem& problem_;
  const std::unique_ptr<PathMatrix> K_;
  Observer* const observer_;
  const Index nodes_, offset_;  ///< dofs that the path leaves out come first
  /// unit = D^{1/2}; the others in its units. g: given limits
  Vector unit_, f_, gap_, mu_, g_, cohesion_, cap_;
  std::vector<char> closes_, rubs_, bends_;
  Real theta_ = 1, fade_ = 1, first_fade_ = 1;
  bool symmetric_ = true;
  Vector alpha_, omega_;  ///< m: dr_N = alpha + omega dx_N
  Vector by_N_, by_s_;    ///< m: dg = by_N dr_N + by_s ds
  Friction friction_;
  Point at_;
};

/// The central path, and Newton's method on the laws themselves from the branches at its end.
Attempt by_interior_point(const CondensedProblem& problem, Index max_steps);

}  // namespace frictioncg
