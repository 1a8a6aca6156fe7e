#pragma once
// Statics of rigid bodies on contact and friction, straight from the script's data: which loads can
// be held. A linear program by the simplex method; it shares no code with the solver's test.
#include <Eigen/Core>

#include <cmath>
#include <vector>

#include "scene.h"

namespace frictioncg::test {

/// Sum of |t - G lambda| over lambda >= 0, at its least: phase 1 of the simplex method, with
/// Bland's rule; 0 where t lies in the cone of the columns of G.
double distance_to_cone(Eigen::MatrixXd G, Eigen::VectorXd t);

/// A scene's rigid motions, by the eigenvalues of A, and the forces that can act on them.
class RigidStatics {
 public:
  explicit RigidStatics(const Scene& s);

  int motions() const { return int(W_.cols()); }

  /// Whether forces of the friction cones, polygons of `sides` in 3D, inside the circle or around
  /// it, balance the load times (1, 1, ...) plus `more`.
  bool held(double friction_factor, const Eigen::VectorXd& more, bool around = false) const;

  /// The answer of statics, where it is sure by a relative margin: +1 held, -1 not, 0 unsure.
  int verdict(double margin) const;

 private:
  Eigen::MatrixXd columns(double friction_factor, bool around) const;

  const Scene& s_;
  Eigen::MatrixXd W_;
  Eigen::VectorXd load_;
};

/// A ladder of length 4 and thickness 0.2 leaning on a wall at `degrees`, under its own weight (1 a
/// unit of area): P1 elasticity on 2 n x m triangles; both end faces may touch floor or wall.
Scene ladder(double degrees, double mu_floor, double mu_wall, int n = 20, int m = 2);

}  // namespace frictioncg::test
