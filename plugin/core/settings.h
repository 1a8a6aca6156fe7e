#pragma once
#include "types.h"

namespace frictioncg {

enum class Method {
  automatic,  ///< condensed, or where its factor costs more or does not fit multigrid, on slender
              ///< bodies sparse factors first, else gcx
  condensed,  ///< the interior eliminated by one factorization
  multigrid,  ///< Newton steps on A, preconditioned by multigrid with the contact faces cut out
  gc1,        ///< release tensile nodes at each iteration and restart (Jeusette-Sonzogni)
  gc2,        ///< release tensile nodes at each iteration, keep conjugating (Dilintas)
  gc3,        ///< release tensile nodes after partial convergence (Raous-Barbarin)
  gcx,        ///< gc3 with stick as a face, held and released like contact: not regularized
  sorp        ///< successive over-relaxation with projection, unregularized
};

enum class Precon { none, diagonal, ssor, hessian_diagonal, hessian_ssor, multigrid };

/// phi_eps of section 4.1, REG1, REG2 and REG3.
enum class Regularization { square_root, log_cosh, polynomial };

enum class Step {
  exact,          ///< root of (13): finite walk for REG3 in 2D, else bracketed Newton to rounding
  newton,         ///< (14), one Newton step
  false_position  ///< (13) by false position to 1e-4
};

struct Settings {
  Method method = Method::automatic;
  bool newton = true;   ///< condensed: semismooth Newton on the unregularized laws
  double memory = 8e9;  ///< [bytes] that a factor and the dense matrices may take
  Index threads = 0;    ///< of multigrid; 0: as many as OpenMP has
  /// Where A has negative energy at a field, look for an answer downhill of it. Not of a Newton
  /// step's tangent, which tells that a path leads past the point where bodies buckle.
  bool buckles = true;
  Regularization reg = Regularization::polynomial;
  Real regeps = 0;  ///< [length]; 0: from the scene, 1e-8 max|x| and less if tol asks for it
  Precon precon = Precon::hessian_ssor;
  Real omega = 0;  ///< relaxation, in (0, 2); 0: 1 as in the paper, gcx 1.5, sorp 1.8
  Step step = Step::exact;
  Real tol = 1e-8;     ///< on the certificate, dimensionless
  Index nbiter = 0;    ///< bound on all iterations of a call; 0: 20 sqrt(n) + 20 m + 10000
  Real partial = 100;  ///< eps_1/eps_0 of section 3: GC3 tests for release at `partial` times tol
  /// Only to repeat the paper's tables: stop at |dx| <= stop_on_step |x|. Proves nothing; 0: off.
  Real stop_on_step = 0;
};

/// Contact and friction on the condensed system, as far as its factor fits.
inline bool condenses(const Settings& s) {
  return s.method == Method::automatic || s.method == Method::condensed;
}

/// A factorization may be made, be it because another method does not arrive.
inline bool may_factor(const Settings& s) { return condenses(s) || s.method == Method::multigrid; }

/// The laws themselves by Newton steps: none of the options of the paper's methods has an effect.
inline bool takes_newton_steps(const Settings& s) {
  return s.method == Method::multigrid || (condenses(s) && s.newton);
}

/// Friction by a conjugate gradient, regularized: GC1 to GC3, or on the condensed system.
inline bool smooths_friction(const Settings& s) {
  if (may_factor(s)) return !takes_newton_steps(s);
  return s.method != Method::gcx && s.method != Method::sorp;
}

/// What an iteration was: each has one label. Where several fit, release counts first, then
/// expansion, contact hit and stick frozen. The numbers are those of the script's history.
enum class StepLabel {
  conjugate,     ///< along v = P r + gamma v, eq. (12)
  restart,       ///< along v = P r
  stick_frozen,  ///< nodes that came to rest are held at x_T = 0 from here on
  contact_hit,   ///< nodes that reached their gap are held there from here on
  release,       ///< held nodes are let go
  sweep,         ///< SORP: every dof once
  newton,        ///< semismooth Newton on the contact dofs
  expansion      ///< contact hit, and further along the direction bent there
};
constexpr int step_labels = 8;

/// How many iterations carried which label.
struct StepCounts {
  std::array<Index, step_labels> count{};

  Index operator[](StepLabel label) const { return count[static_cast<int>(label)]; }
  void add(StepLabel label) { ++count[static_cast<int>(label)]; }
  Index total() const { return std::accumulate(count.begin(), count.end(), Index(0)); }
  StepCounts& operator+=(const StepCounts& other) {
    for (int k = 0; k < step_labels; ++k) count[k] += other.count[k];
    return *this;
  }
};

/// What a layer is at that has no field to show.
enum class Work { factorization, hierarchy, newton, interior_point, proximal, gradient };
constexpr int works = 6;

/// Hears of the iterations; the core never prints.
class Observer {
 public:
  virtual ~Observer() = default;
  virtual void iterate(Index iteration, StepLabel label, const Vector& x) = 0;
  /// A step of a layer on the contact dofs, and the residual of the laws there; of an interior
  /// point how much of its products is left.
  virtual void step(Work, Real /*residual*/) {}
  /// Whether a step would be heard now: where its residual costs something.
  virtual bool listens() { return false; }
  /// Before work of about so many seconds, in which nothing else is said.
  virtual void begin(Work, double /*seconds*/) {}
};

}  // namespace frictioncg
