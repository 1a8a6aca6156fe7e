#pragma once
#include "model/system.h"

namespace frictioncg {

/// Takes off a load F what works on motions that no normal resists, where that is no more than
/// `told` of what the load could work on them at most. Where the mesh tells the normals, it tells
/// the axis of such motions up to their errors, and a load straight along the axis of a seat turns
/// about the one that is told. Of motions that some process owns.
///
///   F <- F - D Z (Z'DZ)^{-1} Z'F,   Z of W (n x k) with Z_N = 0,   |Z'F| <= told |F|_1 max |Z|
///
/// Returns |Z'F| over what it could be, and 0 where nothing is taken off.
Real leave_out_uncertain_work(const System& system, const DenseMatrix& W, Real told, Vector& F);

}  // namespace frictioncg
