#include "multigrid/inexact_newton.h"

namespace frictioncg {

namespace {

// The control, all of it. Each value was halved and doubled, with all others as they are, on 186
// calls of the tests, examples and benches and on 1937 small random ones, beside 15 further
// constants that no call needed and that have gone since. Behind each sentence stands what that
// does to the cycles of the former and of the latter, and to the answers; where nothing stands,
// less than 1 % and no answer changes. Near nu = 0.5 two calls come and go with any change; they
// are not counted.

/// A linear system is solved until its residual is below this share of the violation of its faces.
/// Half: +16, +6 %, 2 answers lost; twice: -9, +4 %.
constexpr Real Gamma = 0.3;
/// ... and no further than to this share of what is to be reached in the end: the violation of the
/// laws has the rest. Half: +2, +1 %; twice: -1, -1 %.
constexpr Real share = 0.5;
/// A linear system is given up where its residual does not fall tenfold within so many cycles.
/// Half: +8 %; twice: failures come later.
constexpr Index patience = 40;
/// The goal shrinks to this share where it was met, and the certificate, or the direction of
/// friction, is not yet as it should be.
constexpr Real sharper = 0.2;

/// An update of the faces is progress where the violation falls below this share of the least one
/// so far. Half: +5, -1 %; where any fall counts 22 random answers are lost.
constexpr Real better = 0.9;
/// The faces keep changing, and springs are tried, after so many updates without progress. Half:
/// +5, -4 %; twice: 0, +12 %.
constexpr int stuck_after = 12;
/// Springs are tried, or made stiffer, as soon as the violation is so many times what it was after
/// the first update with the present ones. Half: 0, -2 %; without it 3 answers are lost, and +9 %.
constexpr Real out_of_bounds = 1e3;

/// Proximal springs over D (model/proximal_springs.h). The first: half 0, +3 %, twice 0, +1 %.
constexpr Real first_spring = 1e-2, least_spring = 1e-8;
/// A proximal point is found, and the springs are released, where residual and violation are below
/// this share of the force of the springs. Half: 0, +1 %; twice: 0, -1 %.
constexpr Real spring_share = 0.1;
/// Nothing holds a body that still moves after so many releases of the softest springs in a row.
/// Loads that nothing holds are told 7 % sooner at half of it, 16 % later at twice.
constexpr int most_soft_releases = 4;
/// After the first springs, so many stiffer ones are tried. Failures cost 6 % less at half, 9 %
/// more at twice, where 2 more random calls find an answer.
constexpr int most_retreats = 10;

// Where the caller has another method, which costs as much as so many cycles:
/// The rate of a linear system is asked for what is left from this cycle on. Half: 3 calls give up
/// that would have arrived in time.
constexpr Index least_cycles = 8;

}  // namespace

InexactNewton::InexactNewton(const ContactProblem& problem, Hierarchy& hierarchy,
                             Observer* observer, Real affordable, Real most_violation,
                             Solution& answer)
    : problem_(problem),
      system_(*problem.system),
      hierarchy_(hierarchy),
      observer_(observer),
      affordable_(affordable),
      most_violation_(most_violation),
      faces_(problem),
      inner_(system_),
      answer_(answer),
      proximal_(first_spring, least_spring),
      springs_(Vector::Zero(system_.contact_dofs())) {}

Status InexactNewton::solve(Real tol, Index max_iterations, const Vector& x0, const Vector& b0,
                            const Branches& start) {
  const Real driving = driving_norm(system_, problem_.increment);
  goal_ = tol * driving;
  load_ = std::max(driving, closing_norm(system_, problem_.increment));
  max_iterations_ = max_iterations;
  answer_.x = x0.size() > 0 ? x0 : Vector(Vector::Zero(system_.dofs()));
  rest_ = answer_.x;
  b_ = x0.size() > 0 ? b0 : problem_.increment.F;
  b_C_ = b_.tail(springs_.size());
  if (!start.empty())
    faces_.start_from(start);
  else if (x0.size() > 0)
    faces_.start_from(answer_.x, b_C_);
  else
    faces_.start_from(reached(problem_));
  while (answer_.iterations < max_iterations_) {
    move_onto_faces();
    const bool solved = solve_faces();
    if (inner_.indefinite()) {
      answer_.negative = inner_.last();
      return Status::not_positive_definite;
    }
    if (gave_up_) return ended(Status::stagnated);
    const Real violation = faces_.violation(answer_.x, b_C_);
    if (std::hypot(inner_.norm(), violation) <= std::max(goal_, spring_share * spring_force())) {
      const bool held = spring_force() > goal_;
      Certificate certificate = certify(problem_, answer_.x);
      b_ = certificate.r;
      const bool goes_on = release_springs();
      if (accept(std::move(certificate), tol, held)) return Status::converged;
      if (!goes_on) return ended(Status::stagnated);
    } else if (!solved || !violation_falls(violation)) {
      if (accepted_.size() > 0 || gave_up_ || !retreat(solved)) return ended(Status::stagnated);
      continue;
    }
    faces_.lag(!solved);
    faces_.choose(answer_.x, b_C_);
  }
  return ended(Status::max_iterations);
}

/// Whether the laws hold at x by its certificate, friction along the slip included; else what to
/// aim for next. held: springs took a part of the load.
bool InexactNewton::accept(Certificate certificate, Real tol, bool held) {
  const Real goal = tol * certificate.scale;
  if (certificate.residual <= tol) {
    answer_.certificate = std::move(certificate);
    if (faces_.misdirection(answer_.x, b_C_) <= goal) return true;
    accepted_ = answer_.x;
  }
  // the scale is known now; where it was already, and did not do, rounding is near
  goal_ = goal_ <= goal && !held ? sharper * goal_ : goal;
  return false;
}

/// What was accepted once counts, whatever came after it.
Status InexactNewton::ended(Status otherwise) {
  if (accepted_.size() == 0) return otherwise;
  answer_.x = accepted_;
  return Status::converged;
}

/// x onto the faces, and b with it.
void InexactNewton::move_onto_faces() {
  const Vector before = answer_.x.tail(springs_.size());
  faces_.place(answer_.x);
  const Vector moved = answer_.x.tail(springs_.size()) - before;
  b_.tail(springs_.size()) = b_C_ - springs_.cwiseProduct(moved);
  system_.move_contact(moved, b_);
  b_C_ = b_.tail(springs_.size());
}

/// The linear system of the present faces, to Gamma times what they violate. False where the
/// residual does not fall.
bool InexactNewton::solve_faces() {
  s_ = b_;
  faces_.residual(answer_.x, b_C_, s_.tail(springs_.size()));
  inner_.start(s_);
  const Real from = inner_.norm();
  const Index begin = answer_.iterations;
  Real mark = from;
  Index since = 0;
  bool falls = mark > share * goal_;
  if (falls) hierarchy_.truncate(faces_.fixed(), faces_.stiffness(), springs_);
  while (falls && answer_.iterations < max_iterations_) {
    falls = inner_.step(hierarchy_, faces_, springs_, answer_.x, b_C_);
    const StepLabel label = answer_.iterations == begin ? StepLabel::newton : StepLabel::conjugate;
    ++answer_.iterations;
    answer_.steps.add(label);
    if (observer_) observer_->iterate(answer_.iterations, label, answer_.x);
    const Real violation = faces_.violation(answer_.x, b_C_);
    const Real aim = std::max(Gamma * violation, share * goal_);
    if (inner_.norm() <= aim) break;
    ++since;
    if (inner_.norm() <= mark / 10) {
      mark = inner_.norm();
      since = 0;
    }
    gave_up_ = costs_too_much(from, answer_.iterations - begin);
    falls = falls && since < patience && !gave_up_;
  }
  b_ = inner_.residual();
  return falls || inner_.norm() <= share * goal_;
}

/// Whether tol takes more cycles than are affordable, at the rate at which this many of them have
/// reduced the residual from what it was.
bool InexactNewton::costs_too_much(Real from, Index cycles) const {
  if (!std::isfinite(affordable_) || cycles < least_cycles) return false;
  const Real rate = std::log(from / inner_.norm()) / cycles;
  const Real left = std::log(inner_.norm() / (share * goal_));
  return !(answer_.iterations * rate + left <= affordable_ * rate);
}

/// What the springs do to equilibrium, in norm_D.
Real InexactNewton::spring_force() const {
  const auto D = system_.weight.tail(springs_.size()).array();
  const auto stretch = (answer_.x - rest_).tail(springs_.size()).array();
  return std::sqrt(system_.sum((springs_.array() * stretch).square().cwiseQuotient(D).sum()));
}

/// The springs, if there are any, at rest where the body is, b = F - Ax: another problem from here
/// on.
void InexactNewton::attach_springs() {
  if (sprung_) springs_ = proximal_.eps() * system_.D.tail(springs_.size());
  rest_ = answer_.x;
  faces_at_rest_ = faces_.all();
  b_C_ = b_.tail(springs_.size());
  first_violation_ = least_violation_ = infinity;
  updates_since_least_ = 0;
}

/// A proximal point is found: the springs are at rest where the body is now, and softer. False
/// where it goes on for ever at the softest springs: nothing holds the body.
bool InexactNewton::release_springs() {
  if (sprung_) {
    soft_releases_ = proximal_.softest() ? soft_releases_ + 1 : 0;
    proximal_.found();
  }
  attach_springs();
  return soft_releases_ < most_soft_releases;
}

/// Where faces leave a motion of the body free, or keep changing, springs on the contact dofs
/// hold it: first from stick at x = 0, then from where the last of them were at rest, stiffer.
/// False where that was tried often enough.
bool InexactNewton::retreat(bool solved) {
  if (retreats_++ > most_retreats || (std::isfinite(affordable_) && !solved)) return false;
  faces_.lag(false);
  if (!sprung_) {
    answer_.x.setZero();
    faces_.start_from(all_stick(problem_.increment));
    sprung_ = true;
  } else {
    answer_.x = rest_;
    faces_.start_from(faces_at_rest_);
    proximal_.missed();
  }
  system_.multiply(answer_.x, b_);
  b_ = problem_.increment.F - b_;
  attach_springs();
  return true;
}

/// False where the violation does not fall any more, grows out of bounds, or is more at the start
/// than the method is to try.
bool InexactNewton::violation_falls(Real violation) {
  if (!std::isfinite(first_violation_)) first_violation_ = violation;
  gave_up_ = !std::exchange(judged_, true) && violation > most_violation_ * load_;
  if (gave_up_ || !(violation <= out_of_bounds * first_violation_)) return false;
  if (violation < better * least_violation_) {
    least_violation_ = violation;
    updates_since_least_ = 0;
  } else {
    ++updates_since_least_;
  }
  return updates_since_least_ < stuck_after;
}

}  // namespace frictioncg
