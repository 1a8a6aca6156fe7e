#pragma once
#include <exception>

#include "types.h"

// OpenMP's own, without which there is one thread, and OpenBLAS's, where that is the BLAS.
extern "C" {
int omp_get_max_active_levels() __attribute__((weak));
int omp_get_max_threads() __attribute__((weak));
int omp_in_parallel() __attribute__((weak));
void omp_set_num_threads(int threads) __attribute__((weak));
void omp_set_max_active_levels(int levels) __attribute__((weak));
int openblas_get_parallel() __attribute__((weak));  // 2: its threads are OpenMP's
int openblas_get_num_threads() __attribute__((weak));
void openblas_set_num_threads(int threads) __attribute__((weak));
}

namespace frictioncg {

/// As long as it lives, OpenMP's parallel regions, but for with_threads(), run on the thread that
/// meets them, and the BLAS has one thread. CHOLMOD 3 opens a region of four threads for every
/// supernode, whatever OMP_NUM_THREADS says: on two cores that takes three times as long as the
/// factorization itself. The second thread of OpenBLAS spins between small products: twice the CPU
/// time, and no less time.
class Threads {
 public:
  /// Of a call: own of them for what is done side by side, below; 0: as many as OpenMP has.
  explicit Threads(Index own) : Threads() { own_ = own > 0 ? own : std::max(1, omp_threads_); }
  /// of_blas: as many as where the outermost of these began. Where they are OpenMP's there is one
  /// all the same: parts of a product that wait for each other would run on one thread, for ever.
  explicit Threads(bool of_blas = false) {
    if (omp_get_max_active_levels && omp_set_max_active_levels) {
      levels_ = omp_get_max_active_levels();
      omp_threads_ = omp_get_max_threads();
      omp_set_max_active_levels(0);
      omp_set_num_threads(1);
    }
    if (openblas_get_num_threads && openblas_set_num_threads) {
      blas_threads_ = openblas_get_num_threads();
      if (depth_ == 0) given_ = blas_threads_;
      const bool own = !openblas_get_parallel || openblas_get_parallel() != 2;
      openblas_set_num_threads(of_blas && own ? given_ : 1);
    }
    ++depth_;
  }
  ~Threads() {
    if (--depth_ == 0) own_ = 1;
    if (blas_threads_ >= 0) openblas_set_num_threads(blas_threads_);
    if (levels_ >= 0) {
      omp_set_num_threads(omp_threads_);
      omp_set_max_active_levels(levels_);
    }
  }
  static Index own() { return own_; }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

 private:
  inline static int depth_ = 0, given_ = 1, own_ = 1;
  int levels_ = -1, omp_threads_ = -1, blas_threads_ = -1;  ///< of before; -1: not changed
};

/// work(), whose tasks side by side the threads of the call share. While it has none they wait, and
/// it never waits for one that the system does not run.
template <class Work>
void with_threads(const Work& work) {
  if (Threads::own() < 2 || !omp_in_parallel || omp_in_parallel()) return work();
  std::exception_ptr thrown;
  const int levels = omp_get_max_active_levels();
  omp_set_max_active_levels(1);
#pragma omp parallel num_threads(Threads::own())
#pragma omp master
  try {
    work();
  } catch (...) {
    thrown = std::current_exception();
  }
  omp_set_max_active_levels(levels);
  if (thrown) std::rethrow_exception(thrown);
}

/// task(k) for k = 0 .. count-1, within with_threads() on several of them. What one of them throws
/// is thrown here.
template <class Task>
void side_by_side(Index count, const Task& task) {
  if (count < 2 || !omp_in_parallel || !omp_in_parallel()) {
    for (Index k = 0; k < count; ++k) task(k);
    return;
  }
  std::exception_ptr thrown;
#pragma omp taskloop grainsize(1) shared(task, thrown)
  for (Index k = 0; k < count; ++k) {
    try {
      task(k);
    } catch (...) {
#pragma omp critical
      thrown = std::current_exception();
    }
  }
  if (thrown) std::rethrow_exception(thrown);
}

/// Below so many rows of a vector threads take longer to meet than to work.
constexpr Index least_range = 4096;

/// The same where the work is that on so many rows of vectors, and threads are worth it: one that
/// waits spins, and takes a time that small scenes do not have.
template <class Work>
void with_threads(Index rows, const Work& work) {
  rows < 2 * least_range ? work() : with_threads(work);
}

/// Where range k of `count` of 0 .. n-1 begins
inline Index range_begin(Index n, Index k, Index count) {
  return static_cast<Index>(std::int64_t(n) * k / count);
}

/// work(k, first, end) for each of so many ranges of 0 .. n-1
template <class Work>
void in_ranges_of(Index n, Index count, const Work& work) {
  side_by_side(count,
               [&](Index k) { work(k, range_begin(n, k, count), range_begin(n, k + 1, count)); });
}

/// So many ranges, at most, are worth it: those of any number of threads.
inline Index fixed_ranges(Index n, Index most) { return std::clamp(n / least_range, 1, most); }

/// work(first, end) on ranges of 0 .. n-1, as many as the work is worth, which is that on `rows`
/// rows of a vector.
template <class Work>
void in_ranges(Index n, Index rows, const Work& work) {
  const Index count = std::clamp(std::min(n, rows / least_range), 1, 4 * Threads::own());
  in_ranges_of(n, count, [&](Index, Index first, Index end) { work(first, end); });
}
template <class Work>
void in_ranges(Index n, const Work& work) {
  in_ranges(n, n, work);
}

/// The sum of part(first, end) over fixed_ranges.
template <class Part>
auto sum_of_ranges(Index n, const Part& part) {
  std::array<decltype(part(0, n)), 16> of_range;
  const Index count = fixed_ranges(n, of_range.size());
  in_ranges_of(n, count, [&](Index k, Index first, Index end) { of_range[k] = part(first, end); });
  for (Index k = 1; k < count; ++k) of_range[0] += of_range[k];
  return of_range[0];
}

}  // namespace frictioncg
