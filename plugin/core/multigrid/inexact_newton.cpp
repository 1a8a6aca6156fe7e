#include "multigrid/inexact_newton.h"

#include <cmath>
#include <limits>

#include "model/certificate.h"

namespace frictioncg {

namespace {

constexpr Index patience = 40;         ///< inner iterations in which the residual must fall tenfold
constexpr Index little_patience = 12;  ///< the same where the caller has another method
constexpr Index least_cycles = 8;      ///< from which on a rate is one
constexpr Real settled = 0.1;          ///< violation over the first, below which few faces change
constexpr Real of_unsettled = 2.5;     ///< cycles over those of one linear system, before that
constexpr Real in_time = 0.5;          ///< of the affordable cycles, to settle the faces
constexpr Real tenfold = 0.1;          ///< fall of the residual that patience waits for
constexpr Real share = 0.5;            ///< of tol that the linear residual may take
constexpr int most_retreats = 10, most_drifts = 4;
constexpr Real least_Gamma = 1e-3, most_Gamma = 0.3, Gamma_of_springs = 0.1;
constexpr Real sharper = 0.2, least_goal = 1e-4;  ///< of goals that did not do
constexpr Real as_before = 1.01;                  ///< over the goal: the same
constexpr Real better = 0.9;                      ///< fall of the violation that counts
constexpr int stuck_after = 12;                   ///< updates without it: the faces keep changing
constexpr Real drop = 0.7;                        ///< fall of the violation that doubles Gamma
constexpr int dull_after = 3;                     ///< updates without it: Gamma is reduced ...
constexpr Real less_Gamma = 0.3;                  ///< ... to this share
/// Springs, over D: the first; their change by a release, by one after a retreat, by a retreat, and
/// where they were too weak for the hierarchy.
constexpr Real first_spring = 1e-2, weaker = 0.1, little_weaker = 0.3, stiffer = 10, firmer = 3;
constexpr Real spring_share = 0.1;  ///< of the springs' force: laws that hold to it release them
constexpr Real lasting = 0.9;       ///< of the springs' force before: the body drifts
/// Of the violation over the first, where the caller has another method: in slender bodies it
/// doubled within three updates, and fell later if at all.
constexpr Real runaway = 2;
constexpr Index settling = 3;        ///< updates before that, in which it may grow all the same
constexpr Real out_of_bounds = 1e3;  ///< violation over the first with the present springs

}  // namespace

InexactNewton::InexactNewton(const ContactProblem& problem, Hierarchy& hierarchy,
                             Observer* observer)
    : problem_(problem),
      system_(*problem.system),
      hierarchy_(hierarchy),
      observer_(observer),
      faces_(problem),
      inner_(system_),
      springs_(Vector::Zero(system_.contact_dofs())) {}

Status InexactNewton::solve(Real tol, Index max_iterations, const Vector& x0,
                            const Branches& start) {
  goal_ = tol * driving_norm(system_, problem_.increment);
  max_iterations_ = max_iterations;
  x_ = x0.size() > 0 ? x0 : Vector(Vector::Zero(system_.dofs()));
  rest_ = x_;
  recompute_forces();
  if (x0.size() > 0)
    faces_.start_from(x_, b_C_);
  else if (!start.empty())
    faces_.start_from(start);
  else
    faces_.start_from_stick();
  while (iterations_ < max_iterations_) {
    move_onto_faces();
    hierarchy_.truncate(faces_.fixed(), faces_.stiffness(), springs_);
    const bool solved = solve_faces();
    ++updates_;
    if (inner_.indefinite()) return Status::not_positive_definite;
    if (gave_up_) return ended(Status::stagnated);
    const Real violation = faces_.violation(x_, b_C_);
    if (std::hypot(inner_.norm(), violation) <= std::max(goal_, spring_share * spring_force())) {
      const bool held = spring_force() > goal_;
      const bool goes_on = release_springs();
      if (accept(tol, held)) return Status::converged;
      if (!goes_on) return ended(Status::stagnated);
      if (goal_ <= least_goal_) return ended(Status::stagnated);
    } else if (!progress(solved, violation)) {
      if (accepted_.size() > 0 || gave_up_ || !retreat(solved)) return ended(Status::stagnated);
      continue;
    }
    faces_.lag(!solved);
    faces_.choose(x_, b_C_);
  }
  return ended(Status::max_iterations);
}

/// Whether the laws hold at x, friction along the slip included; else what to aim for next. held:
/// springs took a part of the load.
bool InexactNewton::accept(Real tol, bool held) {
  const Certificate certificate = certify(problem_, x_);
  const Real goal = tol * certificate.scale;
  if (certificate.residual <= tol) {
    if (faces_.misdirection(x_, b_C_) <= goal) return true;
    accepted_ = x_;
  }
  // the scale is known now; where it was already, and did not do, rounding is near
  goal_ = goal_ <= as_before * goal && !held ? sharper * goal_ : goal;
  least_goal_ = least_goal * goal;
  return false;
}

/// What was accepted once counts, whatever came after it.
Status InexactNewton::ended(Status otherwise) {
  if (accepted_.size() == 0) return otherwise;
  x_ = accepted_;
  return Status::converged;
}

void InexactNewton::recompute_forces() {
  system_.multiply(x_, b_);
  b_ = problem_.increment.F - b_;
  b_C_ = b_.tail(springs_.size()) + springs_.cwiseProduct((rest_ - x_).tail(springs_.size()));
}

/// x onto the faces, and b with it.
void InexactNewton::move_onto_faces() {
  const Vector before = x_.tail(springs_.size());
  faces_.place(x_);
  const Vector moved = x_.tail(springs_.size()) - before;
  b_.tail(springs_.size()) = b_C_ - springs_.cwiseProduct(moved);
  system_.move_contact(moved, b_);
  b_C_ = b_.tail(springs_.size());
}

/// The linear system of the present faces, to Gamma times what they violate. False where the
/// residual does not fall.
bool InexactNewton::solve_faces() {
  s_ = b_;
  faces_.residual(x_, b_C_, s_.tail(springs_.size()));
  inner_.start(s_);
  const Real from = inner_.norm();
  const Index begin = iterations_;
  Real mark = from;
  Index since = 0;
  const Index bound = gives_up_early_ ? little_patience : patience;
  bool falls = mark > share * goal_, first = true;
  while (falls && iterations_ < max_iterations_) {
    falls = inner_.step(hierarchy_, faces_, springs_, x_, b_C_);
    count(first ? StepLabel::newton : StepLabel::conjugate);
    first = false;
    const Real violation = faces_.violation(x_, b_C_);
    const Real aim = std::max(Gamma_ * violation, share * goal_);
    if (inner_.norm() <= aim) break;
    ++since;
    if (inner_.norm() <= tenfold * mark) {
      mark = inner_.norm();
      since = 0;
    }
    gave_up_ = costs_too_much(from, iterations_ - begin, violation);
    falls = falls && since < bound && !gave_up_;
  }
  b_ = inner_.residual();
  return falls || inner_.norm() <= share * goal_;
}

/// Whether tol takes more cycles than are affordable, at the rate at which this many of them have
/// reduced the residual from what it was. With friction, faces that are not settled yet take as
/// many again, and half as many; where they do not settle in time, the rate says nothing.
bool InexactNewton::costs_too_much(Real from, Index cycles, Real violation) const {
  if (!std::isfinite(affordable_)) return false;
  const bool unsettled = problem_.increment.law != Law::frictionless &&
                         !(std::isfinite(first_) && violation <= settled * first_);
  if (unsettled && iterations_ > in_time * affordable_) return true;
  if (cycles < least_cycles) return false;
  const Real rate = std::log(from / inner_.norm()) / cycles;
  const Real left = std::log(inner_.norm() / (share * goal_));
  return !(iterations_ * rate + (unsettled ? of_unsettled : 1) * left <= affordable_ * rate);
}

void InexactNewton::count(StepLabel label) {
  ++iterations_;
  steps_.add(label);
  if (observer_) observer_->iterate(iterations_, label, x_);
}

/// What the springs do to equilibrium, in norm_D.
Real InexactNewton::spring_force() const {
  const auto D = system_.weight.tail(springs_.size()).array();
  const auto stretch = (x_ - rest_).tail(springs_.size()).array();
  return std::sqrt(system_.sum((springs_.array() * stretch).square().cwiseQuotient(D).sum()));
}

void InexactNewton::set_springs(Real over_D) {
  spring_ = over_D;
  springs_ = over_D * system_.D.tail(springs_.size());
  rest_ = x_;
  faces_at_rest_ = faces_.all();
  recompute_forces();
  first_ = best_ = drop_from_ = std::numeric_limits<Real>::infinity();
  without_progress_ = without_drop_ = 0;
}

/// A step of the proximal point iteration is done: the springs are at rest where the body is now,
/// and weaker. False where it goes on for ever: nothing holds the body.
bool InexactNewton::release_springs() {
  const Real force = spring_force();
  drifts_ = spring_ <= least_spring_ && force > lasting * last_force_ ? drifts_ + 1 : 0;
  last_force_ = force;
  const Real softer = (retreats_ > 0 ? little_weaker : weaker) * spring_;
  set_springs(std::max(softer, std::min(spring_, least_spring_)));
  return drifts_ < most_drifts;
}

/// Where faces leave a motion of the body free, or keep changing, springs on the contact dofs
/// hold it: first from stick at x = 0, then from where the last of them were at rest, stiffer.
/// False where that was tried often enough.
bool InexactNewton::retreat(bool solved) {
  if (++retreats_ > most_retreats || (gives_up_early_ && !solved)) return false;
  if (!solved) least_spring_ = std::max(least_spring_, firmer * spring_);
  faces_.lag(false);
  Gamma_ = Gamma_of_springs;
  if (spring_ == 0) {
    x_.setZero();
    faces_.start_from_stick();
    set_springs(first_spring);
    retreats_ = 0;
  } else {
    x_ = rest_;
    faces_.start_from(faces_at_rest_);
    set_springs(stiffer * spring_);
  }
  return true;
}

/// Gamma after an update; false where the violation does not fall any more, or grows out of bounds.
bool InexactNewton::progress(bool solved, Real violation) {
  if (!solved) return false;
  if (!std::isfinite(first_)) first_ = violation;
  if (!(violation <= out_of_bounds * first_)) return false;
  gave_up_ =
      gives_up_early_ && spring_ == 0 && updates_ >= settling && violation > runaway * first_;
  if (gave_up_) return false;
  if (violation < better * best_) {
    best_ = violation;
    without_progress_ = 0;
  } else if (++without_progress_ >= stuck_after) {
    return false;
  }
  if (violation <= drop * drop_from_) {
    drop_from_ = violation;
    without_drop_ = 0;
    Gamma_ = std::min(2 * Gamma_, most_Gamma);
  } else if (++without_drop_ >= dull_after) {
    Gamma_ = std::max(less_Gamma * Gamma_, least_Gamma);
    without_drop_ = 0;
    drop_from_ = violation;
  }
  return true;
}

}  // namespace frictioncg
