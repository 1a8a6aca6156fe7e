#pragma once
#include "freefem.h"

#include <cmath>
#include <limits>
#include <sstream>

#include "../core/model/validate.h"
#include "arguments.h"

namespace frictioncg {

/// Throws IllegalInput unless the rule holds for x, the value of the option p.
inline void require(bool holds, Parameter p, double x, const char* rule) {
  if (holds) return;
  std::ostringstream m;
  m << parameters[p].name << " = " << x << "; " << rule;
  throw IllegalInput(m.str());
}

/// A bound on the iterations: a whole number that fits, whatever a script writes.
inline Index bound_on_iterations(double nbiter) {
  require(nbiter >= 1, p_nbiter, nbiter,
          "the bound on the iterations is >= 1 (FreeFEM's whole numbers end at 2^31: write 1e10)");
  require(nbiter == std::floor(nbiter), p_nbiter, nbiter,
          "the bound on the iterations is a whole number");
  return static_cast<Index>(
      std::min<double>(nbiter, std::numeric_limits<Index>::max() / 2));  // sums of bounds fit
}

/// An option without effect is refused: it would let the user believe in what does not happen. The
/// core sees values alone; here what is given counts, be it the default.
inline void refuse_without_effect(const Arguments& args, const Settings& s) {
  const bool newton = takes_newton_steps(s), smooth = smooths_friction(s);
  const auto rule = [&](Parameter p, bool has_effect, const char* because) {
    if (!args.has(p) || has_effect) return;
    const std::string name = parameters[p].name, method = name_of(s.method, methods);
    throw IllegalInput(name + " has no meaning with method=\"" + method + "\"" + because);
  };
  for (Parameter p : {p_reg, p_regeps, p_precon, p_omega, p_step})
    rule(p, !newton,
         condenses(s) ? ", whose answer is not regularized; add method=\"GC3\" or newton=false"
                      : ", whose answer is not regularized; leave it out, or the method");
  for (Parameter p : {p_reg, p_regeps})
    rule(p, smooth, ", which does not regularize; leave it out");
  rule(p_step, smooth, ", which has no such line search; leave it out");
  rule(p_precon, s.method != Method::sorp,
       ", which neither regularizes nor preconditions; leave it out");
  for (Parameter p : {p_newton, p_polish}) rule(p, condenses(s), "; leave it out, or the method");
  rule(p_memory, may_factor(s), "; leave it out, or the method");
  if (args.has(p_omega) && !relaxes(s))
    throw IllegalInput(std::string("omega has no meaning with precon=\"") +
                       name_of(s.precon, preconditioners) +
                       "\", which does not relax; leave it out, or take an SSOR");
}

/// The settings of a call. Refused here is what a script alone can say: zeros, which stand for the
/// defaults in the core, and its units.
inline Settings read_settings(Stack stack, const Arguments& args) {
  Settings s;
  s.method = args.chosen(stack, p_method, methods, s.method);
  s.reg = args.chosen(stack, p_reg, regularizations, s.reg);
  s.precon = args.chosen(stack, p_precon, preconditioners, s.precon);
  s.step = args.chosen(stack, p_step, steps, s.step);
  s.newton = args.value(stack, args.has(p_newton) ? p_newton : p_polish, s.newton);
  s.regeps = args.value(stack, p_regeps, s.regeps);
  s.omega = args.value(stack, p_omega, s.omega);
  s.tol = args.value(stack, p_tol, s.tol);
  if (args.has(p_nbiter)) s.nbiter = bound_on_iterations(args.value(stack, p_nbiter, 0.0));
  s.memory = 1e9 * args.value(stack, p_memory, s.memory / 1e9);
  require(!args.has(p_regeps) || (s.regeps > 0 && std::isfinite(s.regeps)), p_regeps, s.regeps,
          "the regularization is a length > 0; leave it out to scale it from the scene");
  require(!args.has(p_omega) || (s.omega >= least_omega && s.omega < 2), p_omega, s.omega,
          "a relaxation parameter lies between 0.01 and 2");
  require(s.memory > 0, p_memory, s.memory / 1e9, "the memory bound is a number of GB > 0");
  refuse_without_effect(args, s);
  validate(s);
  return s;
}

/// 0 silent, 1 plan and end, 2 iterations, 3 phases and counters: FreeFEM's verbosity, unless verb
/// is given.
inline long read_verb(Stack stack, const Arguments& args) {
  return args.value<long>(stack, p_verb, std::min(verbosity, 3L));
}

}  // namespace frictioncg
