#pragma once
#include "types.h"

namespace frictioncg {

/// How many blocks, slots or couplings of blocks there are, as what indexes them. Throws
/// IllegalInput beyond 2^31 - 1. Entries are counted by 64 bits: a block has up to 36 of them.
inline Index to_block_index(std::size_t count) {
  if (count > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
    refuse("a level of the multigrid hierarchy has ", count,
           " blocks, more than 2^31 - 1; this build indexes them by 32 bits: take "
           "method=\"GCX\" with precon=\"ssor\"");
  return static_cast<Index>(count);
}

}  // namespace frictioncg
