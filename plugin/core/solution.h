#pragma once
#include "model/certificate.h"
#include "settings.h"

namespace frictioncg {

/// How a legal run ended. Illegal input is an exception.
enum class Status {
  converged = 0,
  max_iterations = 1,
  stagnated = 2,
  no_equilibrium = 3,
  not_positive_definite = 4,
  fixed_point_diverged = 5,
  regularized = 6,  ///< the regularized problem is solved; regeps keeps the certificate above tol
  /// The laws hold, and a body has turned by more than small rotations can mean, though neither
  /// supports nor friction hold it. Said by whoever knows where the nodes are: not by this core.
  runaway = 7
};

/// In words, in their order.
inline constexpr const char* status_names[] = {"converged",
                                               "max_iterations",
                                               "stagnated",
                                               "no_equilibrium",
                                               "not_positive_definite",
                                               "fixed_point_diverged",
                                               "regularized",
                                               "runaway"};

static_assert(sizeof(status_names) / sizeof(*status_names) ==
              static_cast<int>(Status::runaway) + 1);

constexpr const char* name_of(Status status) { return status_names[static_cast<int>(status)]; }

enum class Route {
  iterative,  ///< a method of the paper on A
  condensed,  ///< one factorization, then the laws on the contact dofs
  multigrid,  ///< Newton steps on A, preconditioned by multigrid
  sparse      ///< Newton steps on A, or a central path, by a sparse factor for each
};

/// Which layer answered: a fallback that did shows here.
enum class Layer {
  none,            ///< nothing had to be solved
  linear,          ///< no node can touch: a linear solve
  newton,          ///< semismooth Newton on S
  interior_point,  ///< semismooth Newton on S, from the end of the central path
  proximal,        ///< semismooth Newton on S with springs that vanish
  limits,          ///< the fixed point, at each limit semismooth Newton on S
  fixed_point,     ///< the regularized conjugate gradient on S, without Newton after it
  gcx,             ///< stick as a face, on A
  gc,              ///< GC1, GC2 or GC3, on A
  sorp,
  multigrid,             ///< inexact Newton steps on A, preconditioned by multigrid
  sparse_newton,         ///< Newton steps on A, each with its own factor
  sparse_interior_point  ///< the same, from the end of the central path on A
};

/// The levels of a multigrid preconditioner; none where there is no such preconditioner.
struct Levels {
  Index count = 0;
  Real complexity = 0;  ///< entries of all levels over those of the finest
  double bytes = 0;     ///< kept in memory
};

/// CPU seconds of the phases; zero where there is no such phase. The set-up of a hierarchy counts
/// as factor.
struct Times {
  double order = 0, factor = 0, condense = 0;  ///< 0 where the factor was kept from before
  double contact = 0, back_substitution = 0, certificate = 0;

  Times& operator+=(const Times& other) {
    for (double Times::*phase : {&Times::order, &Times::factor, &Times::condense, &Times::contact,
                                 &Times::back_substitution, &Times::certificate})
      this->*phase += other.*phase;
    return *this;
  }
};

struct Solution {
  Status status = Status::converged;
  Route route = Route::iterative;
  Layer layer = Layer::none;
  Vector x;                      ///< n, the increment in local frames [length]
  Certificate certificate;       ///< of x
  std::vector<NodeState> state;  ///< m
  Index iterations = 0;          ///< of all minimizations
  StepCounts steps;              ///< what the iterations of the gradient methods were
  Index passes = 0;              ///< of the fixed point; 0 where there is none
  Real eps = 0;                  ///< the regularization used [length]; 0: none
  Times times;
  Levels levels;
  Vector unheld_motion;  ///< no_equilibrium: n, the rigid motion that nothing holds (local frames)
  Vector negative;       ///< not_positive_definite: n, p with p'Ap < 0 beyond rounding
  /// n x k: rigid motions that neither contact nor friction nor a support determines. x is the
  /// solution with the least of them, in the product of diag(A).
  Eigen::MatrixXd undetermined;
};

/// Converged, or shown to have no equilibrium.
inline bool decided(const Solution& s) {
  return s.status == Status::converged || s.status == Status::no_equilibrium;
}

/// A certificate below this is as good as the matrix allows: no other method is tried.
constexpr Real at_rounding = 1e-10;

/// Rounding that leaves more than this belongs to a field that has run away, and says nothing of
/// another: 0.05 to 4 in degenerate scenes, up to 1e-4 on slender, nearly incompressible beams.
constexpr Real runaway_rounding = 1e-3;

/// Whether no method comes nearer to the laws.
inline bool is_rounding(const Certificate& c) {
  const bool known = c.attainable < runaway_rounding;
  return c.residual <= std::max(at_rounding, known ? c.attainable : 0);
}

/// Bound on the iterations of a call, all layers together.   Collective.
inline Index bound_of(const ContactProblem& problem, const Settings& settings) {
  if (settings.nbiter > 0) return settings.nbiter;
  Real size[] = {Real(problem.nodes()), Real(problem.dofs())};
  problem.system->sum(size, 2);
  return 10000 + static_cast<Index>(20 * (size[0] + std::sqrt(size[1])));
}

/// With the iterations that an answer to the problem has left; none: nbiter <= 0.
inline Settings what_remains(const ContactProblem& problem, Settings settings, const Solution& s) {
  settings.nbiter = bound_of(problem, settings) - s.iterations;
  return settings;
}

/// What a route is asked.
struct Request {
  const ContactProblem& problem;
  Settings settings;
  Vector x0;  ///< n, where to start, or empty
  Observer* observer;

  Index bound() const { return bound_of(problem, settings); }
};

/// What is left to ask after an answer that does not do, from the scene on.
inline Request what_remains(const Request& request, const Solution& s) {
  return {
      request.problem, what_remains(request.problem, request.settings, s), {}, request.observer};
}

/// An answer, with what one before it took.
inline Solution after(const Solution& before, Solution s) {
  s.iterations += before.iterations;
  s.steps += before.steps;
  s.times += before.times;
  return s;
}

}  // namespace frictioncg
