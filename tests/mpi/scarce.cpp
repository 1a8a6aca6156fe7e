// Preloaded into one process of several: memory runs out there, at a call of malloc that the
// environment names.
//   SCARCE_FROM   the first call that fails, counted from the script's exec(""); 0: none, and their
//   number is printed SCARCE_SIZE   calls for fewer bytes are granted, and not counted SCARCE_ONCE
//   calls after that are granted
// glibc's own functions are called by their inner names: looking them up would need memory.
#include <cerrno>
#include <cstdio>
#include <cstdlib>

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* p, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace {

bool begun = false;
long calls = 0;

long number(const char* name) {
  const char* text = std::getenv(name);
  return text ? std::atol(text) : 0;
}

bool refused(std::size_t size) {
  static const long from = number("SCARCE_FROM"), least = number("SCARCE_SIZE");
  static const bool once = number("SCARCE_ONCE") > 0;
  if (!begun || size < static_cast<std::size_t>(least)) return false;
  const long call = __atomic_add_fetch(&calls, 1, __ATOMIC_RELAXED);
  const bool fails = from > 0 && (once ? call == from : call >= from);
  if (fails) errno = ENOMEM;
  return fails;
}

struct Count {
  ~Count() {
    if (begun && number("SCARCE_FROM") == 0) std::fprintf(stderr, "calls: %ld\n", calls);
  }
} at_the_end;

}  // namespace

extern "C" {
/// FreeFEM's exec: marks where counting begins.
int system(const char*) {
  begun = true;
  return 0;
}
void* malloc(std::size_t size) { return refused(size) ? nullptr : __libc_malloc(size); }
void* calloc(std::size_t count, std::size_t size) {
  return refused(count * size) ? nullptr : __libc_calloc(count, size);
}
void* realloc(void* p, std::size_t size) {
  return size > 0 && refused(size) ? nullptr : __libc_realloc(p, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  return refused(size) ? nullptr : __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** p, std::size_t alignment, std::size_t size) {
  void* memory = memalign(alignment, size);
  if (!memory) return ENOMEM;
  *p = memory;
  return 0;
}
}
