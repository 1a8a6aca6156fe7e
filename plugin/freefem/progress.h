#pragma once
#include "freefem.h"

#include <chrono>
#include <iostream>

#include "../core/clock.h"
#include "../core/model/certificate.h"
#include "parameters.h"

namespace frictioncg {

constexpr const char* step_names[step_labels] = {"conjugate",   "restart",  "stick frozen",
                                                 "contact hit", "release",  "sweep",
                                                 "Newton",      "expansion"};

constexpr const char* work_names[works] = {
    "the factorization",
    "the multigrid hierarchy",
    "Newton on the condensed laws",
    "the interior point",
    "Newton on the condensed laws, with springs that vanish",
    "the regularized conjugate gradient on the condensed system"};

/// Hears of the iterations: keeps the history, and shows that a long run lives.
///   verb 1: a line every five seconds; from 2 on the first iteration, then a line every second;
///   likewise before work that takes as long and cannot be interrupted
/// Its own cost is not counted.
class Progress final : public Observer {
 public:
  Progress(const ContactProblem& problem, long verb, bool keep_history)
      : problem_(problem), verb_(verb), keep_history_(keep_history) {}

  void iterate(Index iteration, StepLabel label, const Vector& x) override {
    const double now = cpu_seconds();
    // certify is a matter of all processes
    const bool speaks = problem_.system->largest(is_time_to_speak()) > 0;
    if (keep_history_ || speaks) {
      const double residual = certify(problem_, x).residual;
      if (keep_history_)
        rows_.push_back({now - start_, double(iteration), residual, double(label)});
      if (verb_ > 0 && speaks) say(iteration, label, residual);
    }
    start_ += cpu_seconds() - now;
  }

  void step(Work work, Real residual) override {
    const int count = ++steps_[static_cast<int>(work)];
    if (!listens()) return;
    speak() << "step " << count << " of " << work_names[static_cast<int>(work)] << ", residual "
            << residual << ", " << since(begun_) << " s" << std::endl;
  }
  bool listens() override { return verb_ > 0 && since(spoken_) >= interval(); }

  void begin(Work work, double seconds) override {
    if (verb_ < 1 || seconds < interval()) return;
    speak() << work_names[static_cast<int>(work)] << " of " << problem_.dofs()
            << " dofs begins: about " << std::round(seconds) << " s without a word" << std::endl;
  }

  /// Rows (CPU seconds, iteration, certificate, label of the step).
  void write_history(KNM<double>* out) const {
    out->resize(static_cast<long>(rows_.size()), 4);
    for (std::size_t k = 0; k < rows_.size(); ++k)
      for (int c = 0; c < 4; ++c) (*out)(static_cast<int>(k), c) = rows_[k][c];
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double since(Clock::time_point t) {
    return std::chrono::duration<double>(Clock::now() - t).count();
  }
  double interval() const { return verb_ == 1 ? 5 : 1; }
  bool is_time_to_speak() const {
    return verb_ > 0 && ((first_ && verb_ > 1) || since(spoken_) >= interval());
  }
  std::ostream& speak() {
    spoken_ = Clock::now();
    return std::cout << " -- " << operator_name << ": ";
  }
  void say(Index iteration, StepLabel label, double residual) {
    first_ = false;
    speak() << "iteration " << iteration << " (" << step_names[static_cast<int>(label)]
            << "), certificate " << residual << ", " << since(begun_) << " s" << std::endl;
  }

  const ContactProblem& problem_;
  long verb_;
  bool keep_history_, first_ = true;
  double start_ = cpu_seconds();
  Clock::time_point begun_ = Clock::now(), spoken_ = begun_;
  std::vector<std::array<double, 4>> rows_;
  std::array<int, works> steps_{};  ///< so far
};

}  // namespace frictioncg
