// Preloaded into a process of FreeFEM: memory runs out there, at a call of malloc that the
// environment names.
//   SCARCE_FROM  the first call that fails, counted from the script's exec(""); 0: none, and their
//                number is printed
//   SCARCE_SIZE  calls for fewer bytes are granted, and not counted
//   SCARCE_ONCE  calls after that are granted
// What Open MPI and GCC's OpenMP ask for is granted: the one crashes without, the other ends the
// process itself. So is what the C library asks for, which copies names for Open MPI, and small
// blocks of PETSc's, whose tables of names do not look at what they got.
// glibc's own functions are called by their inner names: looking them up would need memory.
#include <dlfcn.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

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

constexpr std::size_t of_tables = 4096;  // bytes

bool is_granted(const void* caller, std::size_t size) {
  Dl_info object;
  if (!dladdr(caller, &object) || !object.dli_fname) return false;
  if (size < of_tables && std::strstr(object.dli_fname, "libpetsc")) return true;
  for (const char* name :
       {"libc.so", "openmpi", "libmpi", "libopen-", "libpmix", "libevent", "libgomp"})
    if (std::strstr(object.dli_fname, name)) return true;
  return false;
}

bool refused(std::size_t size, const void* caller) {
  static const long from = number("SCARCE_FROM"), least = number("SCARCE_SIZE");
  static const bool once = number("SCARCE_ONCE") > 0;
  if (!begun || size < static_cast<std::size_t>(least) || is_granted(caller, size)) return false;
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
void* malloc(std::size_t size) {
  return refused(size, __builtin_return_address(0)) ? nullptr : __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  return refused(count * size, __builtin_return_address(0)) ? nullptr : __libc_calloc(count, size);
}
void* realloc(void* p, std::size_t size) {
  if (size > 0 && refused(size, __builtin_return_address(0))) return nullptr;
  return __libc_realloc(p, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  return refused(size, __builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return refused(size, __builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, size);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t size) {
  if (refused(size, __builtin_return_address(0))) return ENOMEM;
  *p = __libc_memalign(alignment, size);
  return *p ? 0 : ENOMEM;
}
}
