// A problem solved through the one public header, without FreeFEM: a contact node hangs by a spring
// (k along y and along x) on a second node, which is held by a softer one (k0), pressed by P and
// pulled by Q > mu P. The closed form: the contact carries R = P k/(k + k0) and slides under mu R.
#include <cmath>
#include <cstdio>

#include "frictioncg.h"

using namespace frictioncg;

int main() {
  const Real k = 100, k0 = 10, P = 4, Q = 3, mu = 0.5;
  // dofs: u_x, u_y of the contact node, then of the node above it
  const Index i[] = {0, 0, 2, 2, 1, 1, 3, 3}, j[] = {0, 2, 0, 2, 1, 3, 1, 3};
  const Real a[] = {k, -k, -k, k + k0, k, -k, -k, k + k0};
  const Triplets A{4, 8, i, j, a, 0, false};

  ContactPoint point;
  point.dof = {0, 1, -1};
  point.normal = {0, -1, 0};
  point.friction = true;
  const LocalSystem local(A, 2, {point});

  const Vector b = (Vector(4) << 0, 0, Q, -P).finished();
  const PointLaws laws{Law::coulomb, false, Vector::Zero(1), Vector::Constant(1, mu)};
  const LocalIncrement now = local.increment(b, {}, laws);
  Solver solver(local.system());
  const Solution s = solver.solve(now.increment, Settings());

  const Vector u = local.to_global(s.x, now.u0), force = local.force_to_global(s.certificate.r);
  const Real R = P * k / (k + k0), slip = (Q - mu * R) / k0 - mu * R / k;
  std::printf("force (%g, %g), of the closed form (%g, %g); slip %g, %g\n", force[0], force[1],
              -mu * R, R, u[0], slip);
  const bool right = s.status == Status::converged && s.state[0] == NodeState::slip &&
                     std::abs(force[0] + mu * R) < 1e-8 && std::abs(force[1] - R) < 1e-8 &&
                     std::abs(u[0] - slip) < 1e-8 && std::abs(u[1]) < 1e-8;
  return right ? 0 : 1;
}
