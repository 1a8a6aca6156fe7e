// What happens when memory runs out, at every single allocation; and that nothing leaks. The unit
// tests are linked with --wrap=malloc and so on, operator new is replaced here, and so are the four
// functions by which CHOLMOD allocates (the library calls those of the program first, and they are
// the same in every version of SuiteSparse), so that all are ours to count and to refuse.
#include <gtest/gtest.h>

#include <malloc.h>

#include <algorithm>
#include <cstdlib>
#include <new>

#include "core/solver.h"
#include "core/sparse/factored_matrix.h"
#include "scene.h"
#include "sparse_scene.h"

namespace {
long live = 0;           ///< allocations not freed yet
long until_failure = 0;  ///< 0: never
long bytes = 0, peak = 0;

void* counted(void* p) {
  bytes += p ? long(malloc_usable_size(p)) : 0;
  peak = std::max(peak, bytes);
  return p;
}
}  // namespace

extern "C" {
void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t count, std::size_t size);
void* __real_realloc(void* p, std::size_t size);
void __real_free(void* p);

static bool refused() { return until_failure > 0 && --until_failure == 0; }

void* __wrap_malloc(std::size_t size) {
  if (refused()) return nullptr;
  void* p = counted(__real_malloc(size));
  live += p != nullptr;
  return p;
}
void* __wrap_calloc(std::size_t count, std::size_t size) {
  if (refused()) return nullptr;
  void* p = counted(__real_calloc(count, size));
  live += p != nullptr;
  return p;
}
void* __wrap_realloc(void* old, std::size_t size) {
  if (refused()) return nullptr;
  const long before = old ? long(malloc_usable_size(old)) : 0;
  void* p = __real_realloc(old, size);
  if (p != nullptr || size == 0) bytes -= before, counted(p);
  live += old == nullptr && p != nullptr;
  return p;
}
void __wrap_free(void* p) {
  live -= p != nullptr;
  bytes -= p ? long(malloc_usable_size(p)) : 0;
  __real_free(p);
}

void* SuiteSparse_malloc(std::size_t count, std::size_t size) {
  return __wrap_malloc(std::max<std::size_t>(count * size, 1));
}
void* SuiteSparse_calloc(std::size_t count, std::size_t size) {
  return __wrap_calloc(std::max<std::size_t>(count * size, 1), 1);
}
/// On failure p stays as it is; that is no failure where the block only shrinks.
void* SuiteSparse_realloc(std::size_t count, std::size_t old_count, std::size_t size, void* p,
                          int* ok) {
  void* moved = __wrap_realloc(p, std::max<std::size_t>(count * size, 1));
  *ok = moved != nullptr || (p != nullptr && count <= old_count);
  return moved != nullptr ? moved : p;
}
void* SuiteSparse_free(void* p) {
  __wrap_free(p);
  return nullptr;
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

class Faults : public testing::Test {
 protected:
  void TearDown() override { until_failure = 0; }
};

namespace {

Vector field(const Scene& s, Method method) {
  Settings settings{method};
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

TEST_F(Faults, SparseFactorsThatAreNotLaidOutLeakNothing) {
  BlockOptions o;
  o.cells = 2;
  const Posed posed = block(o).system();
  const SystemPtr system = posed.problem().system;
  long failures = 0;
  for (bool done = false; !done; ++failures) {
    const long at_start = live;
    until_failure = failures + 1;
    try {
      const FactoredMatrix factor(system);
      done = until_failure > 0;
    } catch (const std::bad_alloc&) {
    }
    until_failure = 0;
    ASSERT_EQ(live, at_start) << "allocation " << failures;
  }
  EXPECT_GT(failures, 20);
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

/// Of all that a call allocates, the copies of A and of the scene that it was made from apart.
TEST_F(Faults, MultigridTakesLessThanTwelveTimesTheStorageOfTheMatrix) {
  const SparseScene scene = sparse_block(cube_of(14));
  const Posed posed = scene.system(scene.node_of_dof);
  const Matrix& A = posed.problem().system->entries();
  const double storage = 12.0 * double(A.nonZeros());
  Settings settings{Method::multigrid};
  const long before = bytes;
  peak = bytes;
  EXPECT_EQ(solve(posed.problem(), settings).layer, Layer::multigrid);
  EXPECT_GT(double(peak - before), storage / 2);   // it is counted
  EXPECT_LE(double(peak - before), 11 * storage);  // the twelfth is A
  RecordProperty("copies", std::to_string(double(peak - before) / storage));
}
