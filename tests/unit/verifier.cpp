#include "verifier.h"

namespace frictioncg::test {

Eigen::VectorXd free_diagonal(const Scene& s) {
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(s.n), others = Eigen::VectorXd::Zero(s.n);
  for (std::size_t k = 0; k < s.a.size(); ++k)
    if (s.i[k] == s.j[k])
      diagonal[s.i[k]] = s.a[k];
    else
      others[s.i[k]] = std::max(others[s.i[k]], std::abs(s.a[k]));
  for (Index i = 0; i < s.n; ++i)
    if (diagonal[i] > 1e20 || others[i] == 0) diagonal[i] = 0;
  return diagonal;
}

/// Pressures and gaps below this are none, for cohesion, which is lost with them.
constexpr double edge = 1e-6;

void verify_point(const Scene& s, std::size_t p, const Vector& u, const Vector& force, double k,
                  double unit, Verdict& v) {
  const ContactPoint& point = s.points[p];
  double u_N = 0, F_N = 0, slip_N = 0;
  Eigen::Vector3d u_T = Eigen::Vector3d::Zero(), F_T = Eigen::Vector3d::Zero();
  for (int c = 0; c < s.d; ++c) {
    const Index i = point.dof[c];
    u_N += point.normal[c] * u[i];
    F_N += point.normal[c] * force[i];
    u_T[c] = u[i] - (s.u_old.size() ? s.u_old[i] : 0);
    F_T[c] = force[i];
    slip_N += point.normal[c] * u_T[c];
  }
  const Eigen::Vector3d normal(point.normal.data());
  u_T -= slip_N * normal;
  F_T -= F_N * normal;
  const double per_force = 1 / (std::sqrt(k) * unit), per_length = std::sqrt(k) / unit;
  v.penetration = std::max(v.penetration, (u_N - s.gap[p]) * per_length);
  v.tension = std::max(v.tension, F_N * per_force);
  v.complementarity = std::max(v.complementarity, std::min(std::abs(F_N) * per_force,
                                                           std::abs(s.gap[p] - u_N) * per_length));
  double g = s.law == Law::coulomb  ? s.friction[p] * std::max(-F_N, 0.0)
             : s.law == Law::tresca ? s.friction[p]
                                    : 0;
  // orthotropic friction: an ellipse with the half-axes g along e and g across in the plane's
  // other direction; the slip that goes with a force on it is its outward normal, reversed
  const double q = point.mu_ratio;
  Eigen::Vector3d e(point.direction.data());
  e -= normal * normal.dot(e);
  if (q == 1) e = F_T;
  if (e.norm() > 0) e.normalize();
  const Eigen::Vector3d cross = normal.cross(e);
  const Eigen::Vector3d F_unit = F_T + (1 / q - 1) * F_T.dot(cross) * cross;
  const Eigen::Vector3d u_unit = u_T + (q - 1) * u_T.dot(cross) * cross;
  // errors count as forces, in which the disc is the ellipse again
  const auto size = [&](const Eigen::Vector3d& f) {
    return (f + (q - 1) * f.dot(cross) * cross).norm();
  };
  const double most = s.cap.size() > 0 ? s.cap[p] : INFINITY;
  g = std::min(g, most);
  if (s.cohesion.size() > 0) {
    // all of it under pressure, none behind a gap; at the edge of both, as much as there is shear
    const double cohesion = s.cohesion[p], pressure = -F_N * per_force,
                 distance = (s.gap[p] - u_N) * per_length;
    if (std::max(pressure, distance) < edge)
      g = std::min(std::max(g, F_unit.norm()), std::min(g + cohesion, most));
    else if (pressure > distance)
      g = std::min(g + cohesion, most);
    else
      g = 0;
  }
  v.cone = std::max(v.cone, (1 - g / std::max(F_unit.norm(), 1e-300)) * F_T.norm() * per_force);
  // where it slips, the force is at its limit and against the slip
  const double against = size(F_unit + g * u_unit / std::max(u_unit.norm(), 1e-300));
  v.slip = std::max(v.slip, std::min(u_T.norm() * per_length, against * per_force));
}

Verdict verify(const Scene& s, const Vector& u, const Vector& force) {
  const Eigen::VectorXd diagonal = free_diagonal(s);
  Eigen::VectorXd balance = s.b + force;  // b + f - A u = 0 on free dofs
  for (std::size_t k = 0; k < s.a.size(); ++k) balance[s.i[k]] -= s.a[k] * u[s.j[k]];
  double load = 0, contact = 0, closing = 0, internal = 0;
  std::vector<double> stiffness(s.points.size(), 0);
  std::vector<char> may_touch(s.n, 0);
  for (std::size_t p = 0; p < s.points.size(); ++p) {
    double squares = 0;
    int free = 0;
    for (int c = 0; c < s.d; ++c) {
      const Index i = s.points[p].dof[c];
      may_touch[i] = 1;
      squares += force[i] * force[i];
      stiffness[p] += diagonal[i];
      free += diagonal[i] > 0;
    }
    if (free == 0) continue;
    stiffness[p] /= free;
    contact = std::max(contact, std::sqrt(squares / stiffness[p]));
    closing = std::max(closing, -s.gap[p] * std::sqrt(stiffness[p]));
  }
  for (Index i = 0; i < s.n; ++i)
    if (diagonal[i] > 0) load = std::max(load, std::abs(s.b[i]) / std::sqrt(diagonal[i]));
  Eigen::VectorXd sizes = Eigen::VectorXd::Zero(s.n);
  for (std::size_t k = 0; k < s.a.size(); ++k) sizes[s.i[k]] += std::abs(s.a[k] * u[s.j[k]]);
  for (Index i = 0; i < s.n; ++i)
    if (diagonal[i] > 0) internal = std::max(internal, sizes[i] / std::sqrt(diagonal[i]));
  // Contact forces, and a hundredth of the load, for they may vanish. Below a millionth of what
  // drives the body, its load or the penetration that it starts from, they are none.
  const double driving = std::max(load, closing);
  double unit = contact > 1e-6 * driving ? std::max(contact, 0.01 * load) : driving;
  // no forces but rounding: those that move it
  if (unit <= 1e-13 * internal) unit = internal;
  unit = std::max(unit, 1e-300);
  Verdict v;
  for (std::size_t p = 0; p < s.points.size(); ++p)
    if (stiffness[p] > 0) verify_point(s, p, u, force, stiffness[p], unit, v);

  for (Index i = 0; i < s.n; ++i) {
    if (diagonal[i] == 0) continue;
    const double error = std::max(std::abs(balance[i]), may_touch[i] ? 0 : std::abs(force[i]));
    v.equilibrium = std::max(v.equilibrium, error / std::sqrt(diagonal[i]) / std::max(unit, load));
  }
  return v;
}

}  // namespace frictioncg::test
