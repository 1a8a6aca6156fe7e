#include "condensed/sparse_factor.h"

#if __has_include(<sys/mman.h>)
#include <sys/mman.h>
#endif

#include "threads.h"

namespace frictioncg {

namespace {

/// A factor is touched all at once: a fault for each small page would take a fifth of the
/// factorization where the system gives large ones to who asks alone.
void in_large_pages(void* begin, std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr std::size_t page = 4096;
  const std::size_t skip = -reinterpret_cast<std::size_t>(begin) % page;
  if (bytes > page) madvise(static_cast<char*>(begin) + skip, bytes - skip, MADV_HUGEPAGE);
#endif
}

}  // namespace

UpperTriangle::UpperTriangle(const System& s, const std::vector<char>& chained,
                             const std::vector<Index>& roots) {
  const Index n = s.dofs();
  const auto [begin, col, a] = arrays_of(s.entries());
  column.reserve(n + 1);
  row.reserve(s.entries().nonZeros() / 2 + n);
  value.reserve(s.entries().nonZeros() / 2 + n);
  column.push_back(0);
  for (Index j = 0; j < n; ++j) {
    for (Index k = begin[j]; k < begin[j + 1] && col[k] < j; ++k) {
      row.push_back(col[k]);
      value.push_back(a[k]);
    }
    if (j == s.interior())
      for (const Index r : roots) {  // the column stays sorted
        const auto at = std::lower_bound(row.begin() + column.back(), row.end(), r);
        if (at != row.end() && *at == r) continue;
        value.insert(value.begin() + (at - row.begin()), 0);
        row.insert(at, r);
      }
    if (chained[j] && (row.size() == std::size_t(column[j]) || row.back() != j - 1)) {
      row.push_back(j - 1);
      value.push_back(0);
    }
    row.push_back(j);
    value.push_back(s.D[j]);
    column.push_back(static_cast<Index>(row.size()));
  }
  view = symmetric_view(n, column, row, value.data());
}

SparseFactor::SparseFactor(int supernodal) {
  cholmod_start(&common_);
  common_.print = 0;
  common_.try_catch = 1;
  common_.supernodal = supernodal;
  common_.final_ll = 1;
  common_.nmethods = 1;
  common_.method[0].ordering = CHOLMOD_GIVEN;
}

SparseFactor::~SparseFactor() {
  release();
  cholmod_finish(&common_);
}

void SparseFactor::release() {
  cholmod_free_factor(&L_, &common_);
  for (cholmod_dense** workspace : {&X_, &Y_, &E_}) cholmod_free_dense(workspace, &common_);
}

bool SparseFactor::lay_out(cholmod_sparse& view, const std::vector<Index>& order) {
  cholmod_free_factor(&L_, &common_);
  if (order.size() < view.ncol) return false;  // the ordering has been too large
  L_ = cholmod_analyze_p(&view, const_cast<Index*>(order.data()), nullptr, 0, &common_);
  if (common_.status == CHOLMOD_TOO_LARGE) return false;
  check(L_ != nullptr, common_);
  return true;
}

bool SparseFactor::factorize(cholmod_sparse& view) {
  if (L_->is_super && L_->xtype == CHOLMOD_PATTERN) {
    check(cholmod_change_factor(CHOLMOD_REAL, 1, 1, 1, 1, L_, &common_), common_);
    in_large_pages(L_->x, sizeof(Real) * L_->xsize);
  }
  const Threads threads(threads_pay());
  const bool done = cholmod_factorize(&view, L_, &common_);
  if (common_.status == CHOLMOD_NOT_POSDEF) return false;
  check(done, common_);
  return true;
}

/// By flops over entries. On two cores threads take 0.8 of the time from 900 on, as in 3D, and 0.9
/// to 1.2 of it below 600, as in 2D, for twice the CPU time.
bool SparseFactor::threads_pay() const { return common_.fl > 800 * common_.lnz; }

Vector SparseFactor::solve(int triangle, const Vector& rhs) {
  const std::size_t n = rhs.size();
  cholmod_dense b{n, 1, n, n, const_cast<Real*>(rhs.data()), nullptr, CHOLMOD_REAL, CHOLMOD_DOUBLE};
  // cholmod_solve2 would make its own, but goes on without where there is no memory
  const auto ensure = [this](cholmod_dense*& workspace, std::size_t rows) {
    check(cholmod_ensure_dense(&workspace, rows, 1, rows, CHOLMOD_REAL, &common_), common_);
  };
  ensure(X_, n);
  ensure(Y_, n);
  ensure(E_, L_->maxesize);
  check(cholmod_solve2(triangle, L_, &b, nullptr, &X_, nullptr, &Y_, &E_, &common_), common_);
  return Eigen::Map<const Vector>(static_cast<Real*>(X_->x), rhs.size());
}

}  // namespace frictioncg
