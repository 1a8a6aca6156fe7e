// What happens when memory runs out, at every single allocation; and that nothing leaks. The unit
// tests are linked with --wrap=malloc and so on, and operator new is replaced here, so that both
// are ours to count and to refuse.
#include <SuiteSparse_config.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "core/solver.h"
#include "scene.h"

namespace {
long live = 0;           ///< allocations not freed yet
long until_failure = 0;  ///< 0: never
}  // namespace

extern "C" {
void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t count, std::size_t size);
void* __real_realloc(void* p, std::size_t size);
void __real_free(void* p);

static bool refused() { return until_failure > 0 && --until_failure == 0; }

void* __wrap_malloc(std::size_t size) {
  if (refused()) return nullptr;
  void* p = __real_malloc(size);
  live += p != nullptr;
  return p;
}
void* __wrap_calloc(std::size_t count, std::size_t size) {
  if (refused()) return nullptr;
  void* p = __real_calloc(count, size);
  live += p != nullptr;
  return p;
}
void* __wrap_realloc(void* old, std::size_t size) {
  if (refused()) return nullptr;
  void* p = __real_realloc(old, size);
  live += old == nullptr && p != nullptr;
  return p;
}
void __wrap_free(void* p) {
  live -= p != nullptr;
  __real_free(p);
}
}

void* operator new(std::size_t size) {
  if (void* p = __wrap_malloc(size)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept { __wrap_free(p); }
void operator delete(void* p, std::size_t) noexcept { __wrap_free(p); }

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// Counts and refuses the allocations of CHOLMOD, too, while it lives.
class Faults : public testing::Test {
 protected:
  void SetUp() override {
    SuiteSparse_config.malloc_func = __wrap_malloc;
    SuiteSparse_config.calloc_func = __wrap_calloc;
    SuiteSparse_config.realloc_func = __wrap_realloc;
    SuiteSparse_config.free_func = __wrap_free;
  }
  void TearDown() override {
    until_failure = 0;
    SuiteSparse_config.malloc_func = __real_malloc;
    SuiteSparse_config.calloc_func = __real_calloc;
    SuiteSparse_config.realloc_func = __real_realloc;
    SuiteSparse_config.free_func = __real_free;
  }
};

Vector field(const Scene& s, Method method) {
  Settings settings;
  settings.method = method;
  settings.tol = 1e-6;
  const Posed system = s.system();
  return system.to_global(solve(system.problem(), settings).x);
}

}  // namespace

TEST_F(Faults, EveryAllocationThatFailsIsBadAllocAndLeaksNothing) {
  for (Method method : {Method::automatic, Method::gc3, Method::gcx, Method::sorp}) {
    BlockOptions o;
    o.cells = 2;
    const Scene scene = block(o);
    const Scene before = scene;
    const Vector u = field(scene, method);
    long failures = 0;
    for (bool done = false; !done; ++failures) {
      ASSERT_LT(failures, 100000);
      const long at_start = live;
      until_failure = failures + 1;
      try {
        const Vector again = field(scene, method);
        done = until_failure > 0;  // came to its end without meeting the fault
        until_failure = 0;
        // CHOLMOD can do without some of its workspace; then the answer must be right all the same
        EXPECT_LT((again - u).norm(), 1e-9 * u.norm()) << "allocation " << failures;
      } catch (const std::bad_alloc&) {
      }
      until_failure = 0;
      ASSERT_EQ(live, at_start) << "allocation " << failures << " of method " << int(method);
    }
    EXPECT_GT(failures, 20);
    EXPECT_EQ(scene.a, before.a);
    EXPECT_EQ((scene.b - before.b).norm(), 0);
    EXPECT_EQ((field(scene, method) - u).norm(), 0);
  }
}

TEST_F(Faults, AThousandCallsLeakNothing) {
  BlockOptions o;
  o.cells = 2;
  const Scene s = block(o);
  for (Method method : {Method::automatic, Method::gc3, Method::sorp}) {
    field(s, method);
    const long at_start = live;
    for (int k = 0; k < 1000; ++k) field(s, method);
    EXPECT_EQ(live, at_start);
  }
}
