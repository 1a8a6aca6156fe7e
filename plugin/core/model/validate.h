#pragma once
#include "model/contact_problem.h"
#include "settings.h"

namespace frictioncg {

/// Sizes whose squares, and those of 1e-16 of them, are normal numbers.
constexpr Real smallest = 1e-80, largest = 1e80;

/// Below it SSOR divides rounding by omega, and relaxes nothing.
constexpr Real least_omega = 0.01;

inline bool has_squares(Real stiffness) { return stiffness >= smallest && stiffness <= largest; }

// What the core refuses, whoever calls it. Each throws IllegalInput with one sentence: what, its
// value, where (contact nodes and dofs by their index), the rule, the remedy.

/// A vector has a value for each dof, contact node or point.
void require_size(const char* name, Index size, Index wanted, const char* of);

/// Sizes, signs, finite entries; that A is symmetric is taken on trust.
void validate(const System& system);

/// Sizes, signs, finite values, and loads whose squares neither overflow nor vanish.
void validate(const Increment& increment, const System& system);

/// Takes loads and gaps whose squares vanish for none: what a displacement of before leaves where
/// nothing acts any more, call after call.   Collective.
void forget_what_vanishes(const System& system, Increment& increment);

/// Options that some methods do not heed.
enum class Option { reg, regeps, precon, omega, step, newton, memory, threads };

/// What is wrong with giving the option, after "... has no effect with this method"; null where it
/// has one.
const char* without_effect(Option option, const Settings& settings);

/// Ranges, and options without effect: they would let the caller believe in what does not happen.
void validate(const Settings& settings);

/// The start of a solve: n finite values, or none.
void validate_start(const Vector& x0, const System& system);

}  // namespace frictioncg
