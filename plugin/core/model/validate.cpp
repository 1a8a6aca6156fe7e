#include "model/validate.h"

namespace frictioncg {

namespace {

/// Each value of a vector over the contact nodes, or the dofs, against its rule.
template <class Holds>
void require_each(const char* name, const Vector& values, const char* where, Holds holds,
                  const char* rule) {
  for (Index i = 0; i < values.size(); ++i)
    if (!holds(values[i])) refuse(name, " = ", values[i], " at ", where, " ", i, "; ", rule);
}

bool is_finite(Real value) { return std::isfinite(value); }

bool is_nonnegative(Real value) { return std::isfinite(value) && value >= 0; }

void validate_layout(const System& s) {
  if (s.dimension != 2 && s.dimension != 3)
    refuse("dimension = ", s.dimension, "; a system has dimension 2 or 3");
  if (s.first.empty() || s.first.front() < 0)
    refuse(
        "first does not say where the contact dofs begin; it holds the first dof of each contact "
        "node, then the number of dofs");
  for (Index i = 0; i < s.nodes(); ++i) {
    const Index size = s.first[i + 1] - s.first[i];
    if (size < 1 || size > s.dimension)
      refuse("contact node ", i, " owns ", size, " dofs; it has its normal and at most ",
             s.dimension - 1, " tangents");
  }
  if (s.entries().rows() != s.dofs() || s.entries().cols() != s.dofs())
    refuse("A is ", s.entries().rows(), " x ", s.entries().cols(), " but first ends at ", s.dofs(),
           "; A has a row and a column for each dof");
  if (!s.entries().isCompressed()) refuse("A is not compressed; call makeCompressed()");
}

/// The largest force and gap of an increment, in units of the root of force times length.
struct LoadSize {
  Real force = 0, gap = 0;
  LoadSize(const Increment& increment, const System& system) {
    if (increment.F.size() > 0)
      force = (increment.F.array().abs() / system.weight.array().sqrt()).maxCoeff();
    for (Index i = 0; i < system.nodes(); ++i)
      if (std::isfinite(increment.gap[i]))
        gap = std::max(gap, std::abs(increment.gap[i]) * std::sqrt(system.weight[system.first[i]]));
  }
  Real most() const { return std::max(force, gap); }
};

void validate_load(const Increment& increment, const System& system) {
  const LoadSize size(increment, system);
  if (size.force <= largest && (size.most() == 0 || size.most() >= smallest)) return;
  refuse("the load is ", size.most(),
         " in units of the root of force times length; squares of what is not "
         "between ",
         smallest, " and ", largest, " are lost to the range of numbers: choose other units");
}

/// Options that differ from their defaults, and have no effect.
void refuse_without_effect(const Settings& s) {
  const Settings standard;
  const auto rule = [&](bool differs, const char* name, Option option) {
    const char* const because = differs ? without_effect(option, s) : nullptr;
    if (because) refuse(name, " has no effect with this method", because);
  };
  rule(s.reg != standard.reg, "reg", Option::reg);
  rule(s.regeps != standard.regeps, "regeps", Option::regeps);
  rule(s.step != standard.step, "step", Option::step);
  rule(s.precon != standard.precon, "precon", Option::precon);
  rule(s.omega != standard.omega, "omega", Option::omega);
  rule(s.newton != standard.newton, "newton", Option::newton);
  rule(s.memory != standard.memory, "memory", Option::memory);
  rule(s.threads > 1, "threads", Option::threads);
  if (s.precon == Precon::multigrid && condenses(s))
    refuse(
        "precon=\"multigrid\" preconditions A, and this method iterates on the contact dofs; take "
        "method=\"GC3\" or \"GCX\"");
}

}  // namespace

void require_size(const char* name, Index size, Index wanted, const char* of) {
  if (size != wanted)
    refuse(name, " has ", size, " values; it takes ", wanted, ", one for each ", of);
}

const char* without_effect(Option option, const Settings& s) {
  const bool condensed = condenses(s), smooths = smooths_friction(s);
  const char* const none = nullptr;
  if (option == Option::newton) return condensed ? none : "; leave it out, or the method";
  if (option == Option::memory) return may_factor(s) ? none : "; leave it out, or the method";
  if (option == Option::threads) {
    const bool cycles = s.method == Method::automatic || s.method == Method::multigrid ||
                        s.precon == Precon::multigrid;
    return cycles ? none : ", which takes one; leave it out, or the method";
  }
  if (takes_newton_steps(s))
    return condensed ? ", whose answer is not regularized; leave it out, or add method=\"GC3\" or "
                       "newton=false"
                     : ", whose answer is not regularized; leave it out, or the method";
  const bool relaxes =
      s.method == Method::sorp || s.precon == Precon::ssor || s.precon == Precon::hessian_ssor;
  if (option == Option::omega)
    return relaxes ? none : ", which does not relax; leave it out, or take an SSOR";
  if (option == Option::precon)
    return s.method != Method::sorp ? none : ", which does not precondition; leave it out";
  if (option == Option::step)
    return smooths ? none : ", which has no such line search; leave it out";
  return smooths ? none : ", which does not regularize; leave it out";
}

void validate(const System& s) {
  validate_layout(s);
  const Index n = s.dofs();
  if (!Eigen::Map<const Vector>(s.entries().valuePtr(), s.entries().nonZeros()).allFinite())
    refuse("A has an entry that is not finite; every entry is a number");
  require_size("D", Index(s.D.size()), n, "dof");
  require_size("weight", Index(s.weight.size()), n, "dof");
  if (!s.mesh_node.empty()) require_size("mesh_node", Index(s.mesh_node.size()), n, "dof");
  require_each(
      "D", s.D, "dof", has_squares,
      "the diagonal of A is > 0, between 1e-80 and 1e80 (squares must not overflow): check "
      "the coefficients, or choose other units");
  require_each("weight", s.weight, "dof", has_squares,
               "a weight is a stiffness between 1e-80 and 1e80: take node_weights");
  for (Index i = 0; i < Index(s.mesh_node.size()); ++i)
    if (s.mesh_node[i] < 0)
      refuse("mesh_node = ", s.mesh_node[i], " at dof ", i, "; mesh nodes are numbered from 0");
}

void validate(const Increment& increment, const System& system) {
  require_size("F", Index(increment.F.size()), system.dofs(), "dof");
  require_size("gap", Index(increment.gap.size()), system.nodes(), "contact node");
  require_each("F", increment.F, "dof", is_finite, "a load is a finite force");
  if (increment.bilateral)
    require_each("gap", increment.gap, "contact node", is_finite,
                 "bilateral contact closes a gap of finite length");
  else
    require_each(
        "gap", increment.gap, "contact node", [](Real g) { return g > -INFINITY; },
        "a gap is a length, or infinite where the node cannot touch");
  const auto require = [&](const char* name, const Vector& values, const char* rule) {
    require_size(name, Index(values.size()), system.nodes(), "contact node");
    require_each(name, values, "contact node", is_nonnegative, rule);
  };
  if (increment.law == Law::coulomb) {
    require("mu", increment.mu,
            "a friction coefficient is a number >= 0: give 0 where nothing rubs");
    for (const auto& [name, values] :
         {std::pair{"cohesion", &increment.cohesion}, {"cap", &increment.cap}})
      if (values->size() > 0) require(name, *values, "what bounds friction is a force >= 0");
  }
  if (increment.law == Law::tresca)
    require("g", increment.g, "a sliding limit is a force >= 0: give 0 where nothing rubs");
  validate_load(increment, system);
  const Vector norms = Eigen::Vector4d(increment.load_norm, increment.external_norm,
                                       increment.rounding, increment.force_scale);
  if (!norms.allFinite() || norms.minCoeff() < 0)
    refuse("load_norm, external_norm, rounding and force_scale = ", norms[0], ", ", norms[1], ", ",
           norms[2], ", ", norms[3], "; norms of forces are finite and >= 0");
}

void forget_what_vanishes(const System& system, Increment& increment) {
  if (system.largest(LoadSize(increment, system).most()) >= smallest) return;
  increment.F.setZero();
  for (Real& gap : increment.gap)
    if (std::isfinite(gap)) gap = 0;
}

void validate(const Settings& s) {
  if (!(s.tol > 0 && s.tol < 1)) refuse("tol = ", s.tol, "; the tolerance lies between 0 and 1");
  if (!(s.regeps >= 0 && std::isfinite(s.regeps)))
    refuse("regeps = ", s.regeps,
           "; the regularization is a length > 0; leave it out to scale it from the scene");
  if (s.omega != 0 && !(s.omega >= least_omega && s.omega < 2))
    refuse("omega = ", s.omega, "; a relaxation parameter lies between ", least_omega,
           " and 2; leave it out to take that of the method");
  if (s.nbiter < 0)
    refuse("nbiter = ", s.nbiter,
           "; the bound on the iterations is >= 1: leave it out (0) to take that of the scene");
  if (!(s.memory > 0))
    refuse("memory = ", s.memory / 1e9, "; the memory bound is a number of GB > 0");
  if (s.threads < 0)
    refuse("threads = ", s.threads, "; threads are 1 or more, or 0 for as many as OpenMP has");
  if (!(s.partial >= 1) || !std::isfinite(s.partial))
    refuse("partial = ", s.partial, "; partial convergence is looser than tol: a factor >= 1");
  if (!(s.stop_on_step >= 0 && s.stop_on_step < 1))
    refuse("stop_on_step = ", s.stop_on_step, "; a relative step lies between 0 and 1");
  refuse_without_effect(s);
}

void validate_start(const Vector& x0, const System& system) {
  if (x0.size() == 0) return;
  require_size("x0", Index(x0.size()), system.dofs(), "dof");
  require_each("x0", x0, "dof", is_finite, "a start is a finite displacement: leave it out");
}

}  // namespace frictioncg
