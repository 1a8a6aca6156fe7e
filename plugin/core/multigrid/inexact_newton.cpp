#include "multigrid/inexact_newton.h"

#include <cmath>
#include <limits>

#include "model/certificate.h"

namespace frictioncg {

namespace {

constexpr std::size_t most_directions = 20;
constexpr Index patience = 60;  ///< inner iterations in which the residual must fall tenfold
constexpr Real share = 0.5;     ///< of tol that the linear residual may take
constexpr int most_restarts = 2;
constexpr Real least_Gamma = 1e-3, most_Gamma = 0.3;

}  // namespace

// ---------------------------------------------------------------------------- inner iteration

ConjugateResiduals::ConjugateResiduals(const System& system)
    : system_(system), inverse_D_(system.D.cwiseInverse()) {}

/// In the norm of D^{-1/2}.
Real ConjugateResiduals::dot(const Vector& a, const Vector& b) const {
  return (a.array() * inverse_D_.array() * b.array()).sum();
}

void ConjugateResiduals::start(const Vector& s) {
  s_ = s;
  norm_ = std::sqrt(dot(s_, s_));
  used_ = next_ = 0;
}

bool ConjugateResiduals::step(Hierarchy& hierarchy, const Faces& faces, Vector& x, Vector& b_C) {
  if (kept_.size() < most_directions && next_ == kept_.size()) kept_.emplace_back();
  Direction& now = kept_[next_];
  hierarchy.apply(s_, now.z);
  now.Jz.noalias() = system_.A * now.z;
  now.Az_C = now.Jz.tail(system_.contact_dofs());
  faces.jacobian(now.z, now.Az_C, now.Jz.tail(system_.contact_dofs()));
  const Real before = dot(now.Jz, now.Jz);
  for (std::size_t k = 0; k < used_; ++k) {
    const Direction& old = kept_[k];
    if (&old == &now) continue;
    const Real along = dot(now.Jz, old.Jz) / old.size;
    now.z -= along * old.z;
    now.Jz -= along * old.Jz;
    now.Az_C -= along * old.Az_C;
  }
  now.size = dot(now.Jz, now.Jz);
  if (!(now.size > 1e-20 * before)) return false;
  const Real alpha = dot(s_, now.Jz) / now.size;
  x += alpha * now.z;
  s_ -= alpha * now.Jz;
  b_C -= alpha * now.Az_C;
  norm_ = std::sqrt(dot(s_, s_));
  used_ = std::max(used_, next_ + 1);
  next_ = (next_ + 1) % most_directions;
  return alpha != 0;
}

// ---------------------------------------------------------------------------- outer iteration

InexactNewton::InexactNewton(const ContactProblem& problem, Hierarchy& hierarchy)
    : problem_(problem),
      system_(*problem.system),
      hierarchy_(hierarchy),
      faces_(problem),
      inner_(system_) {}

Status InexactNewton::solve(Real tol, Index max_iterations, const Vector& x0,
                            const std::vector<Face>& start) {
  const Real goal = tol * problem_.increment.force_scale;
  x_ = x0.size() > 0 ? x0 : Vector(Vector::Zero(system_.dofs()));
  recompute_forces();
  if (x0.size() > 0)
    faces_.start_from(x_, b_C_);
  else if (!start.empty())
    faces_.start_from(start);
  else
    faces_.start_from_stick();
  best_ = drop_from_ = std::numeric_limits<Real>::infinity();
  while (iterations_ < max_iterations) {
    move_onto_faces();
    hierarchy_.truncate(faces_.fixed(), faces_.stiffness());
    const Inner inner = solve_faces(goal, max_iterations);
    ++updates_;
    const Real violation = faces_.violation(x_, b_C_);
    if (std::hypot(inner_.norm(), violation) <= goal) {
      recompute_forces();
      if (certify(problem_, x_).residual <= tol) return Status::converged;
    }
    faces_.lag(inner == Inner::failed);
    switch (tighten(violation)) {
      case Next::choose:
        faces_.choose(x_, b_C_);
        break;
      case Next::restart:
        faces_.start_from_stick();
        break;
      case Next::stop:
        return Status::stagnated;
    }
  }
  return Status::max_iterations;
}

void InexactNewton::recompute_forces() {
  b_ = problem_.increment.F;
  b_.noalias() -= system_.A * x_;
  b_C_ = b_.tail(system_.contact_dofs());
}

/// x onto the faces, and b with it: by the columns of the dofs that moved, which are rows of A.
void InexactNewton::move_onto_faces() {
  const Vector before = x_.tail(system_.contact_dofs());
  faces_.place(x_);
  b_.tail(system_.contact_dofs()) = b_C_;
  for (Index c = 0; c < system_.contact_dofs(); ++c) {
    const Index p = system_.interior() + c;
    const Real moved = x_[p] - before[c];
    if (moved == 0) continue;
    for (Matrix::InnerIterator a(system_.A, p); a; ++a) b_[a.col()] -= a.value() * moved;
  }
  b_C_ = b_.tail(system_.contact_dofs());
}

/// The linear system of the present faces, to Gamma times what they violate.
InexactNewton::Inner InexactNewton::solve_faces(Real goal, Index max_iterations) {
  s_ = b_;
  faces_.residual(x_, b_C_, s_.tail(system_.contact_dofs()));
  inner_.start(s_);
  Inner end = Inner::reached;
  Real mark = inner_.norm();
  Index since = 0;
  const auto reached = [&] {
    return inner_.norm() <= std::max(Gamma_ * faces_.violation(x_, b_C_), share * goal);
  };
  for (bool first = true; iterations_ < max_iterations; first = false) {
    if (first ? inner_.norm() <= share * goal : reached()) break;
    if (!inner_.step(hierarchy_, faces_, x_, b_C_)) {
      end = Inner::failed;
      break;
    }
    ++iterations_;
    if (inner_.norm() <= 0.1 * mark) {
      mark = inner_.norm();
      since = 0;
    } else if (++since == patience) {
      end = Inner::failed;
      break;
    }
  }
  b_ = inner_.residual();
  return end;
}

/// Gamma after an update, and what to do with the faces.
InexactNewton::Next InexactNewton::tighten(Real violation) {
  if (violation < 0.9 * best_) {
    best_ = violation;
    without_progress_ = 0;
  } else if (++without_progress_ >= 12) {
    if (restarts_++ == most_restarts) return Next::stop;
    Gamma_ = std::max(Gamma_ / 10, least_Gamma);
    without_progress_ = without_drop_ = 0;
    best_ = drop_from_ = std::numeric_limits<Real>::infinity();
    return Next::restart;
  }
  if (violation <= 0.7 * drop_from_) {
    drop_from_ = violation;
    without_drop_ = 0;
    Gamma_ = std::min(2 * Gamma_, most_Gamma);
  } else if (++without_drop_ >= 3) {
    Gamma_ = std::max(0.3 * Gamma_, least_Gamma);
    without_drop_ = 0;
    drop_from_ = violation;
  }
  return Next::choose;
}

}  // namespace frictioncg
