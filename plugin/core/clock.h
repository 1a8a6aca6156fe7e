#pragma once
#include <ctime>

namespace frictioncg {

/// CPU seconds of the process: what its phases cost, whatever else the machine does.
inline double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Adds the time it lives to one of the phases.
struct Stopwatch {
  explicit Stopwatch(double& phase) : seconds(phase), start(cpu_seconds()) {}
  ~Stopwatch() { seconds += cpu_seconds() - start; }
  double& seconds;
  const double start;
};

}  // namespace frictioncg
