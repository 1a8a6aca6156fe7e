#pragma once
#include "freefem.h"

#include <iostream>
#include <iterator>

#include "options.h"
#include "progress.h"
#include "scene.h"

namespace frictioncg {

/// One line of the report.
inline std::ostream& line() { return std::cout << " -- " << operator_name << ": "; }

/// "1 iteration", "2 iterations".
inline std::string counted(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

/// Words of enumerators, in their order.
constexpr const char* status_names[] = {"converged",
                                        "max_iterations",
                                        "stagnated",
                                        "no_equilibrium",
                                        "not_positive_definite",
                                        "fixed_point_diverged",
                                        "regularized",
                                        "runaway"};
constexpr const char* law_names[] = {"no friction", "given sliding limit", "Coulomb friction"};
constexpr const char* layer_names[] = {
    "none",
    "a linear solve",
    "Newton on the condensed laws",
    "an interior point on the condensed laws, with Newton after it",
    "Newton on the condensed laws, with springs that vanish",
    "the regularized conjugate gradient on the condensed system",
    "GCX on A",
    "the regularized conjugate gradient on A",
    "SORP on A",
    "Newton on A, preconditioned by multigrid",
    "Newton on A, by sparse factors",
    "an interior point on A, by sparse factors, with Newton after it"};
static_assert(std::size(status_names) == static_cast<int>(Status::runaway) + 1);
static_assert(std::size(law_names) == static_cast<int>(Law::coulomb) + 1);
static_assert(std::size(layer_names) == static_cast<int>(Layer::sparse_interior_point) + 1);
inline const char* name_of(Status status) { return status_names[static_cast<int>(status)]; }
inline const char* name_of(Law law) { return law_names[static_cast<int>(law)]; }
inline const char* name_of(Layer layer) { return layer_names[static_cast<int>(layer)]; }

/// What to do about a call that did not converge. Only no_equilibrium and runaway blame the load.
inline std::string remedy(const Solution& solution, const Settings& s) {
  const Status status = solution.status;
  const Certificate& c = solution.certificate;
  const bool of_method = status != Status::no_equilibrium && status != Status::runaway;
  if (smooths_friction(s) && s.step != Step::exact && of_method)
    return std::string("step=\"") + name_of(s.step, steps) +
           "\" may be what keeps it from converging; leave step out, or raise nbiter";
  switch (status) {
    case Status::converged:
      break;
    case Status::max_iterations:
      if (smooths_friction(s)) return "raise nbiter, or try omega=1.5";
      return s.nbiter > 0 ? "raise nbiter"
                          : "no answer was found, which proves nothing: near its limit a load may "
                            "have none; apply it in increments, give start= a field near the "
                            "answer, such as that without friction, or raise nbiter";
    case Status::stagnated:
      if (c.residual <= 10 * c.attainable) {
        std::ostringstream m;
        m << "rounding leaves about " << c.attainable << " of it in any case; raise tol";
        return m.str();
      }
      return takes_newton_steps(s)
                 ? "no answer was found, which proves nothing: near its limit a load may have "
                   "none; apply it in increments, or give start= a field near the answer, such as "
                   "that without friction"
                 : "the method came to a standstill above tol; raise tol, or name another method";
    case Status::no_equilibrium:
      return "contact, friction and supports cannot hold this load";
    case Status::not_positive_definite:
      return "A must be positive semi-definite; check its coefficients";
    case Status::fixed_point_diverged:
      return condenses(s) ? "mu is large for this scene; apply the load in increments"
                          : "mu is large for this method; leave method out, or apply the "
                            "load in increments";
    case Status::regularized:
      return "regeps limits the accuracy; lower it, leave it out, or raise tol";
    case Status::runaway:
      return "hold the rotation by a support, lower the load, give the exact normal, or move the "
             "faces of a crack together by movemesh";
  }
  return "";
}

/// Diagonal of the box around the contact nodes.
inline Real contact_extent(const Scene& scene) {
  if (scene.nodes.empty()) return 0;
  Fem2D::R3 least = scene.nodes.front().x, most = least;
  for (const BoundaryNode& n : scene.nodes) {
    least = Minc(least, n.x);
    most = Maxc(most, n.x);
  }
  return Norme2(most - least);
}

inline void warn_of_displacements(Real most, const char* of_what, Real size) {
  line() << "warning: displacements of up to " << most << " in a " << of_what << " of size " << size
         << "; the laws are those of small displacements, and hold on the undeformed geometry"
         << std::endl;
}

/// A warning for a field that moves a node further than its body is large: the laws hold on the
/// undeformed geometry, and what balances such a load there hardly holds it.
inline void warn_of_large_displacements(const Scene& scene, const Vector& u) {
  const bool one_body = !scene.pairing;  // then the contact is no larger than it
  if (scene.at) return;                  // the geometry follows
  if (u.size() == 0 || (one_body && u.cwiseAbs().maxCoeff() <= contact_extent(scene))) return;
  for (const auto& [number, body] : by_body(scene.places())) {
    const Real size = 2 * nearest_rigid_motion(body, scene.d, u).extent;
    const Real most = largest_displacement(body, scene.d, u);
    if (most > size) return warn_of_displacements(most, "body", size);
  }
}

/// A note where the rounding of A is felt, which the certificate does not see: rigid motions of a
/// stiff part cost the energy that its entries are rounded to, beside what a soft part resists.
inline void note_contrast(const System& system) {
  constexpr Real felt = 1e10;    // from which on a thousandth and more is lost
  constexpr Real error = 1e-13;  // of the answer, over the contrast, where parts are the largest
  const Real times = contrast(system);
  if (times < felt) return;
  std::ostringstream m;
  m.precision(1);
  m << "note: A is " << times
    << " times as stiff at one node as at another; its rounding may change "
    << "the answer by " << std::min<Real>(1, error * times) << " of it. 1e6 is as good as rigid";
  line() << m.str() << std::endl;
}

/// What b has beside the data of tgv = 1e30, 0 being nothing.
inline void report_leftover(Real most, long verb) {
  if (verb <= 0 || most == 0) return;
  line() << "b has up to " << most
         << " in Dirichlet rows of A, which is no data of tgv = 1e30: taken for what b = A*U + r "
            "leaves there, and the displacement for 0"
         << std::endl;
}

/// What stands behind a status: a proof, the layer that answered, or nothing to move.
inline std::string reason_of(const Solution& solution) {
  if (solution.status == Status::no_equilibrium) return " by a proof of statics";
  if (solution.layer != Layer::none) return std::string(" by ") + name_of(solution.layer);
  return solution.status == Status::converged ? " at rest" : "";
}

/// How a call ended, and which layer answered: a fallback shows here.
inline void report_end(const Solution& solution) {
  line() << name_of(solution.status) << reason_of(solution) << ", residual "
         << solution.certificate.residual << ", " << counted(solution.iterations, "iteration");
  if (solution.levels.count > 1)
    std::cout << " on " << solution.levels.count << " levels of complexity "
              << solution.levels.complexity;
  if (solution.passes > 0)
    std::cout << " in " << solution.passes << (solution.passes == 1 ? " pass" : " passes")
              << " of the fixed point";
  if (solution.eps > 0) std::cout << ", regeps " << solution.eps;
  std::cout << std::endl;
}

/// Why a call by method auto has no factor: no factor of its scene fits in memory.
inline void report_memory(double needed, const Settings& s) {
  if (s.method != Method::automatic || needed <= s.memory) return;
  line() << "memory = " << s.memory / 1e9 << " GB, and a factorization takes ";
  if (std::isfinite(needed))
    std::cout << "at least " << needed / 1e9
              << " GB: auto went on without one; raise memory to have it";
  else
    std::cout << "more entries than CHOLMOD can index: auto went on without one";
  std::cout << std::endl;
}

/// The memory of a matrix in its present format [bytes].
inline double storage(const Matrix& A) {
  return (sizeof(Real) + sizeof(Index)) * double(A.nonZeros()) + sizeof(Index) * (A.rows() + 1.0);
}

/// Phases and counters, for verb 3.
inline void report_phases(const Scene& scene, const Solution& solution) {
  const Times& t = solution.times;
  line() << "CPU seconds: copy " << scene.copy_seconds << ", order " << t.order << ", factor "
         << t.factor << ", condense " << t.condense << ", contact " << t.contact
         << ", back-substitution " << t.back_substitution << ", certificate " << t.certificate
         << std::endl;
  if (solution.levels.count > 0)
    line() << "multigrid hierarchy: " << solution.levels.bytes / 1e6 << " MB, "
           << solution.levels.bytes / storage(scene.system->system()->entries())
           << " times the storage of A" << std::endl;
  if (solution.steps.total() > 0) {
    line() << "steps:";
    for (int k = 0; k < step_labels; ++k)
      if (solution.steps.count[k] > 0)
        std::cout << " " << solution.steps.count[k] << " " << step_names[k];
    std::cout << std::endl;
  }
  Index count[4] = {0, 0, 0, 0};
  for (NodeState s : solution.state) ++count[static_cast<Index>(s)];
  const Certificate& c = solution.certificate;
  line() << count[1] << " nodes separated, " << count[2] << " in slip, " << count[3]
         << " in stick; residual of equilibrium " << c.equilibrium << ", of contact " << c.normal
         << ", of friction " << c.friction << std::endl;
}

/// The error of a call that did not converge and whose script does not ask for the status; motion:
/// in words, what nothing holds, or what has turned too far.
[[noreturn]] inline void refuse_unconverged(const Solution& solution, const Settings& s,
                                            const std::string& motion) {
  const bool turned = solution.status == Status::runaway;
  std::ostringstream m;
  m << "not converged (" << name_of(solution.status) << ") after "
    << counted(solution.iterations, "iteration") << ": residual " << solution.certificate.residual
    << ", tol " << s.tol << "; ";
  if (turned) m << motion << "; ";
  m << remedy(solution, s);
  if (!turned && !motion.empty()) m << ", which nothing holds against " << motion;
  m << "; pass status=... to get the field all the same";
  throw IllegalInput(m.str());
}

}  // namespace frictioncg
