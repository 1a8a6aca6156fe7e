#pragma once
#include <cstdlib>
#include <new>

// FreeFEM's own operator new is malloc, which gives null where memory has run out: what the
// standard library builds on it would write there. Of the plugin's own code, which is linked with
// -Bsymbolic-functions, it throws; what either has allotted the other may free. Included once.

void* operator new(std::size_t size) {
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) { return operator new(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
