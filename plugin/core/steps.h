#pragma once
#include <array>

#include "types.h"

namespace frictioncg {

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
  Index total() const {
    Index sum = 0;
    for (Index n : count) sum += n;
    return sum;
  }
  StepCounts& operator+=(const StepCounts& other) {
    for (int k = 0; k < step_labels; ++k) count[k] += other.count[k];
    return *this;
  }
};

}  // namespace frictioncg
