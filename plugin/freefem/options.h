#pragma once
#include "freefem.h"

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
  constexpr std::pair<Parameter, Option> options[] = {
      {p_reg, Option::reg},      {p_regeps, Option::regeps}, {p_precon, Option::precon},
      {p_omega, Option::omega},  {p_step, Option::step},     {p_newton, Option::newton},
      {p_memory, Option::memory}};
  for (const auto& [p, option] : options) {
    const char* const because = args.has(p) ? without_effect(option, s) : nullptr;
    if (!because) continue;
    const bool of_precon = p == p_omega && !takes_newton_steps(s);
    throw IllegalInput(std::string(parameters[p].name) + " has no meaning with " +
                       (of_precon ? std::string("precon=\"") + name_of(s.precon, preconditioners)
                                  : std::string("method=\"") + name_of(s.method, methods)) +
                       "\"" + because);
  }
}

/// The settings of a call. Refused here is what a script alone can say: zeros, which stand for the
/// defaults in the core.
inline Settings read_settings(Stack stack, const Arguments& args) {
  Settings s;
  s.method = args.chosen(stack, p_method, methods, s.method);
  s.reg = args.chosen(stack, p_reg, regularizations, s.reg);
  s.precon = args.chosen(stack, p_precon, preconditioners, s.precon);
  s.step = args.chosen(stack, p_step, steps, s.step);
  s.newton = args.value(stack, p_newton, s.newton);
  s.regeps = args.value(stack, p_regeps, s.regeps);
  s.omega = args.value(stack, p_omega, s.omega);
  s.tol = args.value(stack, p_tol, s.tol);
  if (args.has(p_nbiter)) s.nbiter = bound_on_iterations(args.value(stack, p_nbiter, 0.0));
  s.memory = 1e9 * args.value(stack, p_memory, s.memory / 1e9);
  require(!args.has(p_regeps) || s.regeps != 0, p_regeps, 0, "leave it out to have the default");
  require(!args.has(p_omega) || s.omega != 0, p_omega, 0, "leave it out to have the default");
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
