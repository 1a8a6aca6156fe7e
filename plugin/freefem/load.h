#pragma once
#include "freefem.h"

#include <sys/mman.h>

#include <cstdlib>
#include <new>

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

/// OpenBLAS takes a buffer at its first product of matrices, keeps it, and where memory is refused
/// asks for it for ever: it takes it here, before a solve waits for it. False where it is not to be
/// had.
inline bool take_buffer_of_blas() {
  constexpr std::size_t size =
      (std::size_t(1) << 27) + (1 << 16);  // of OpenBLAS 0.3 and a bit more
  void* room = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (room == MAP_FAILED) return false;
  munmap(room, size);
  constexpr int n = 16;
  const Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd C = A;
  const double one = 1;
  dsyrk_("L", "N", &n, &n, &one, A.data(), &n, &one, C.data(), &n);
  return true;
}

}  // namespace frictioncg

// FreeFEM's own operator new is malloc, which gives null where memory has run out: what the
// standard library builds on it would write there. Of the plugin's own code, which is linked with
// -Bsymbolic-functions, it throws; what either has allotted the other may free. This file is
// included once in each plugin.

void* operator new(std::size_t size) {
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) { return operator new(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
