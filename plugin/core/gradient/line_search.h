#pragma once
#include "model/system.h"
#include "gradient/preconditioner.h"
#include "gradient/regularization.h"

namespace frictioncg {

/// J along x + rho v, before friction acts on the step.
struct Line {
  Real r_v = 0;   ///< <-J', v> at x
  Real a = 0;     ///< <F - Ax, v>
  Curvature vAv;  ///< <Av, v>
};

/// The coefficient rho of the descent x + rho v: J'(rho) = 0, eq. (13), J convex along v with
///   J'(rho) = rho <Av,v> - <F-Ax,v> + sum_i g_i phi'(|x_T + rho v_T|) (x_T + rho v_T).v_T / |.|
class LineSearch {
 public:
  /// safeguarded: (14) is replaced by (13) where it overshoots; else it is taken as printed.
  LineSearch(const System& system, Step step, bool safeguarded = true);

  /// rho in (0, rho_max] for the direction v, line.r_v > 0; infinite where J decreases for ever
  /// along a rigid motion.
  Real operator()(const Phi& phi, const Vector& g, const Vector& x, const Vector& v,
                  const Line& line, Real rho_max);

 private:
  struct Node {
    Real g;           ///< sliding limit
    Real xx, xv, vv;  ///< x_T.x_T, x_T.v_T, v_T.v_T
    Real slip(Real rho) const { return std::sqrt(std::max(0.0, xx + rho * (2 * xv + rho * vv))); }
  };
  struct Break {
    Real rho, slope, curvature;  ///< J' gains slope + curvature rho beyond rho
  };

  void gather(const Vector& g, const Vector& x, const Vector& v);
  Real friction_curvature(const Phi& phi, Real rho) const;
  Real slope(const Phi& phi, Real rho) const;
  Real rise(const Phi& phi, Real rho) const;
  Real newton(const Phi& phi, Real r_v, Real rho_max) const;
  Real walk(const Phi& phi, Real rho_max);
  Real bracketed_newton(const Phi& phi, Real high) const;
  Real false_position(const Phi& phi, Real high) const;

  const System& system_;
  const Step step_;
  const bool safeguarded_;
  bool single_tangent_ = true;  ///< no node has two tangents
  std::vector<Node> nodes_;     ///< those that move tangentially and have g > 0
  std::vector<Break> breaks_;
  Real a_ = 0;  ///< <F - Ax, v>
  Real vAv_ = 0;
};

}  // namespace frictioncg
