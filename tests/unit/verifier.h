#pragma once
// The judge of a solution: dense, in global components, straight from the script's data. It shares
// no code with the solver.
#include <algorithm>
#include <cmath>

#include "scene.h"

namespace frictioncg::test {

/// The largest violation of each law; forces relative to the largest nodal load (or contact force),
/// lengths to the largest displacement.
struct Verdict {
  double equilibrium = 0, penetration = 0, tension = 0, complementarity = 0, cone = 0, slip = 0;
  double worst() const {
    return std::max({equilibrium, penetration, tension, complementarity, cone, slip});
  }
};

inline Verdict verify(const Scene& s, const Vector& u, const Vector& force) {
  Eigen::VectorXd balance = s.b + force;  // b + f - A u = 0 on free dofs
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(s.n), others = Eigen::VectorXd::Zero(s.n);
  for (std::size_t k = 0; k < s.a.size(); ++k) {
    balance[s.i[k]] -= s.a[k] * u[s.j[k]];
    if (s.i[k] == s.j[k])
      diagonal[s.i[k]] = s.a[k];
    else
      others[s.i[k]] = std::max(others[s.i[k]], std::abs(s.a[k]));
  }
  double force_unit = 0;
  for (Index i = 0; i < s.n; ++i) {
    const bool dirichlet = diagonal[i] > 1e20 || others[i] == 0;
    if (dirichlet) continue;
    force_unit = std::max({force_unit, std::abs(s.b[i]), std::abs(force[i])});
  }
  for (std::size_t k = 0; k < s.a.size(); ++k)  // prescribed displacements load the body, too
    if (s.a[k] < 1e20) force_unit = std::max(force_unit, std::abs(s.a[k] * u[s.j[k]]) * 1e-3);
  force_unit = std::max(force_unit, 1e-300);
  double stiffest =
      1e-300;  // where all sticks, u = 0 is no unit of length, but the load over the stiffness is
  for (Index i = 0; i < s.n; ++i)
    if (diagonal[i] <= 1e20 && others[i] > 0) stiffest = std::max(stiffest, diagonal[i]);
  const double length_unit = std::max({u.cwiseAbs().maxCoeff(), force_unit / stiffest, 1e-300});

  Verdict v;
  for (Index i = 0; i < s.n; ++i)
    if (!(diagonal[i] > 1e20 || others[i] == 0))
      v.equilibrium = std::max(v.equilibrium, std::abs(balance[i]) / force_unit);
  std::vector<char> may_touch(s.n, 0);
  for (std::size_t p = 0; p < s.points.size(); ++p) {
    double u_N = 0, F_N = 0;
    Eigen::Vector3d u_T = Eigen::Vector3d::Zero(), F_T = Eigen::Vector3d::Zero();
    for (int c = 0; c < s.d; ++c) {
      const Index i = s.points[p].dof[c];
      may_touch[i] = 1;
      u_N += s.points[p].normal[c] * u[i];
      F_N += s.points[p].normal[c] * force[i];
      u_T[c] = u[i] - (s.u_old.size() ? s.u_old[i] : 0);
      F_T[c] = force[i];
    }
    double slip_N = 0;
    for (int c = 0; c < s.d; ++c) slip_N += s.points[p].normal[c] * u_T[c];
    for (int c = 0; c < s.d; ++c) {
      u_T[c] -= slip_N * s.points[p].normal[c];
      F_T[c] -= F_N * s.points[p].normal[c];
    }
    v.penetration = std::max(v.penetration, (u_N - s.gap[p]) / length_unit);
    v.tension = std::max(v.tension, F_N / force_unit);
    v.complementarity =
        std::max(v.complementarity,
                 std::min(std::abs(F_N) / force_unit, std::abs(s.gap[p] - u_N) / length_unit));
    const double g = s.law == Law::coulomb  ? s.friction[p] * std::abs(F_N)
                     : s.law == Law::tresca ? s.friction[p]
                                            : 0;
    // orthotropic friction: an ellipse with the half-axes g along e and g across in the plane's
    // other direction; the slip that goes with a force on it is its outward normal, reversed
    const double q = s.points[p].across;
    Eigen::Vector3d normal(s.points[p].normal.data()), e(s.points[p].direction.data());
    e -= normal * normal.dot(e);
    if (q == 1) e = F_T;
    if (e.norm() > 0) e.normalize();
    const Eigen::Vector3d cross = normal.cross(e);
    const Eigen::Vector3d F_unit = F_T + (1 / q - 1) * F_T.dot(cross) * cross;
    const Eigen::Vector3d u_unit = u_T + (q - 1) * u_T.dot(cross) * cross;
    v.cone = std::max(v.cone, (F_unit.norm() - g) / force_unit);
    // where it slips, the force is at its limit and against the slip
    const double limit =
        (F_unit + g * u_unit / std::max(u_unit.norm(), 1e-300)).norm() / force_unit;
    v.slip = std::max(v.slip, std::min(u_T.norm() / length_unit, limit));
  }
  for (Index i = 0; i < s.n; ++i)
    if (!may_touch[i]) v.equilibrium = std::max(v.equilibrium, std::abs(force[i]) / force_unit);
  return v;
}

}  // namespace frictioncg::test
