#pragma once
#include "freefem.h"

#include <cmath>
#include <cstdlib>
#include <sstream>

namespace frictioncg {

/// The layout of FreeFEM's matrices changes between its versions.
inline void check_version() {
  const double compiled = std::strtod(FREEFEM_VERSION, nullptr);
  if (std::abs(VersionNumber() - compiled) <= 1e-6) return;
  std::ostringstream m;
  m << "frictionCG was built for FreeFEM " << FREEFEM_VERSION << " but runs in " << VersionNumber()
    << "; rebuild it with `make`";
  throw ErrorLoad(m.str().c_str(), 1);
}

/// Whether this plugin or the one of several processes is loaded already: types have one name each.
inline bool is_loaded() {
  aType type;
  int token;
  return zzzfff->InMotClef("contactproblem", type, token);
}

}  // namespace frictioncg
