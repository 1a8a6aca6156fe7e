#pragma once
#include "levels.h"

namespace frictioncg {

/// What is to be done once matrices are truncated. Where several processes correct what they share
/// more than once, their sum may overshoot, and the smoother diverges: damps it on the levels where
/// it would. Shows the cycle where PETSc's options ask for it.   Collective.
void settle(PC cycle, const std::vector<Level>& levels);

/// A V-cycle on the truncated matrices of the levels, or what PETSc's options make of it.
PCHandle make_cycle(const std::vector<Level>& levels, Index dimension);

}  // namespace frictioncg
