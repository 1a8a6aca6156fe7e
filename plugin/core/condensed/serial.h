#pragma once

// OpenMP's own, where CHOLMOD brings it along.
extern "C" {
int omp_get_max_active_levels() __attribute__((weak));
void omp_set_max_active_levels(int levels) __attribute__((weak));
}

namespace frictioncg {

/// As long as it lives, parallel regions run on the thread that meets them. CHOLMOD 3 opens one of
/// four threads for every supernode, whatever OMP_NUM_THREADS says: on two cores that takes three
/// times as long as the factorization itself. Threads of the BLAS are not concerned.
class Serial {
 public:
  Serial() {
    if (!omp_get_max_active_levels || !omp_set_max_active_levels) return;
    before_ = omp_get_max_active_levels();
    omp_set_max_active_levels(0);
  }
  ~Serial() {
    if (before_ >= 0) omp_set_max_active_levels(before_);
  }
  Serial(const Serial&) = delete;
  Serial& operator=(const Serial&) = delete;

 private:
  int before_ = -1;
};

}  // namespace frictioncg
