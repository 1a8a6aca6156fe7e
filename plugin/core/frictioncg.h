#pragma once
// Contact with Coulomb friction, without FreeFEM: all that a program needs, in the order of its
// use.
//
//   LocalSystem local(A, 2, points);              an assembled matrix and the points that may touch
//   auto [increment, u0] = local.increment(b, {}, {Law::coulomb, false, gap, mu});
//   Solver solver(local.system());                keeps the factorization from load to load
//   Solution s = solver.solve(increment, Settings());
//   s.status, s.certificate.residual              how it ended, and how far from the laws
//   local.to_global(s.x, u0)                      displacement
//   local.force_to_global(s.certificate.r)        forces of the obstacle
//
// A system that is already in local frames goes to the Solver as it is (model/system.h). What is
// illegal throws IllegalInput; nothing is printed. Link libfrictioncg.a (make core), CHOLMOD, BLAS.
#include "assembly/local_system.h"
#include "model/validate.h"
#include "solver.h"
