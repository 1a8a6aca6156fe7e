#pragma once
#include <chrono>

#include "../core/clock.h"
#include "../core/model/certificate.h"
#include "scene.h"

namespace frictioncg {

/// One line of the report.
std::ostream& line();

const char* name_of(Law law);
void warn_of_displacements(Real most, const char* of_what, Real size);

/// A warning for a field that moves a node further than its body is large: the laws hold on the
/// undeformed geometry, and what balances such a load there hardly holds it.
void warn_of_large_displacements(const Scene& scene, const Vector& u);
/// Where facets of a pair have slipped past those they faced. moved: as LocalSystem::to_global.
void warn_of_far_slips(const Scene& scene, const Solution& solution, const Vector& moved);

/// The contrast of A from which on a thousandth of the answer and more is lost to rounding.
constexpr Real felt_contrast = 1e10;

/// What b has beside the data of tgv = 1e30, 0 being nothing.
void report_leftover(Real most, long verb);
void report_left_out(Real share, long verb);

/// Where data move closed contact nodes along the contact. u0: the data; u_old: or empty
void report_held_friction(const Scene& scene, const ContactProblem& problem,
                          const Solution& solution, const Vector& u0, const Vector& u_old);
/// What of the normal forces acts where friction does not.
void report_corners(const Scene& scene, const ContactProblem& problem, const Solution& solution);
/// Why a call by method auto has no factor: no factor of its scene fits in memory.
void report_memory(double needed, const Settings& s);

/// Phases and counters, for verb 3.
void report_phases(const Scene& scene, const Solution& solution);

/// The motion that nothing holds, or that costs negative energy; or empty.
inline const Vector& motion_to_blame(const Solution& solution) {
  return solution.status == Status::not_positive_definite ? solution.negative
                                                          : solution.unheld_motion;
}

/// How a call ended, and which layer answered: a fallback shows here. motion: in words, what a call
/// blames that has not converged: what nothing holds, what has turned too far, or what costs
/// negative energy; or empty.
void report_end(const Solution& solution, const std::string& motion);

/// The error of such a call whose script does not ask for the status.
[[noreturn]] void refuse_unconverged(const Solution& solution, const Settings& s,
                                     const std::string& motion);

/// Hears of the iterations: keeps the history, and shows that a long run lives.
///   verb 1: a line every five seconds; from 2 on the first iteration, then a line every second;
///   likewise before work that takes as long and cannot be interrupted
/// Its own cost is not counted.
class Progress final : public Observer {
 public:
  Progress(const ContactProblem& problem, long verb, bool keep_history);
  void iterate(Index iteration, StepLabel label, const Vector& x) override;
  void step(Work work, Real residual) override;
  bool listens() override { return verb_ > 0 && since(spoken_) >= interval(); }
  void begin(Work work, double seconds) override;
  /// Rows (CPU seconds, iteration, certificate, label of the step).
  void write_history(KNM<double>* out) const { write(rows_, out); }

 private:
  using Clock = std::chrono::steady_clock;
  static double since(Clock::time_point t);
  double interval() const { return verb_ == 1 ? 5 : 1; }
  std::ostream& speak();

  const ContactProblem& problem_;
  long verb_;
  bool keep_history_, first_ = true;
  double start_ = cpu_seconds();
  Clock::time_point begun_ = Clock::now(), spoken_ = begun_;
  std::vector<std::array<double, 4>> rows_;
  std::array<int, works> steps_{};  ///< so far
};

/// The largest coefficient of Coulomb friction; 0 where there is none.
Real largest_friction(const ContactProblem& problem);

/// One answer is certain where friction is small alone.
void report_large_friction(Real mu);

/// All pairs in one line, and from verb 3 on each in one of its own.
void report_pairs(const Scene& scene, long verb);

/// What the scene needs, and what it does not; then all that its script should know of it.
void report_plan(Stack stack, const Arguments& args, const Scene& scene,
                 const ContactProblem& problem, const Settings& s, long verb);

}  // namespace frictioncg
