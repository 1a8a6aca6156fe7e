#include "sparse/factored_matrix.h"

#include "condensed/serial.h"

namespace frictioncg {

namespace {
/// Over D, what makes a matrix definite that is none: a motion is free. What takes more is no
/// rounding.
constexpr Real least_shift = 1e-14, most_shift = 1e-8, stiffer = 100;
}  // namespace

/// In 2D factors of strips take half as long without supernodes, as CHOLMOD chooses. On plates of
/// 3650, 25 000 and 73 000 dofs nested dissection saves at most 6 % of the flops, and takes three
/// times as long; CHOLMOD's own choice of an order, by dofs, 0.8 to 1.9 times the flops and up to
/// 20 times as long.
FactoredMatrix::FactoredMatrix(SystemPtr system) : SparseFactor(CHOLMOD_AUTO) {
  renew(std::move(system));
  lay_out(view_, by_nodes(*system_, common_));
}

void FactoredMatrix::renew(SystemPtr system) {
  system_ = std::move(system);
  for (std::vector<Index>* v : {&column_, &row_}) v->clear();
  value_.clear();
  copy_upper_triangle();
  now_ = value_;
  view_ = symmetric_view(system_->dofs(), column_, row_, now_.data());
}

/// Rows of A up to the diagonal.
void FactoredMatrix::copy_upper_triangle() {
  const System& s = *system_;
  std::vector<char> second(s.dofs(), 0);  // tangents of a node
  for (Index i = 0; i < s.nodes(); ++i)
    if (s.tangents(i) == 2) second[s.first[i] + 2] = 1;
  column_.push_back(0);
  for (Index j = 0; j < s.dofs(); ++j) {
    for (Matrix::InnerIterator a(s.entries(), j); a && a.col() < j; ++a) {
      row_.push_back(static_cast<Index>(a.col()));
      value_.push_back(a.value());
    }
    if (second[j] && (Index(row_.size()) == column_[j] || row_.back() != j - 1)) {
      row_.push_back(j - 1);
      value_.push_back(0);
    }
    row_.push_back(j);
    value_.push_back(s.D[j]);
    column_.push_back(static_cast<Index>(row_.size()));
  }
}

void FactoredMatrix::truncate(const std::vector<char>& fixed,
                              const std::vector<TangentialStiffness>& W, const Vector& springs) {
  const Index n = system_->dofs(), interior = system_->interior();
  fixed_ = fixed;
  now_ = value_;
  for (const TangentialStiffness& w : W) {
    diagonal(w.first) += w.M(0, 0);
    diagonal(w.first + 1) += w.M(1, 1);
    now_[column_[w.first + 2] - 2] += w.M(0, 1);
  }
  for (Index c = 0; c < springs.size(); ++c) diagonal(interior + c) += springs[c];
  for (Index j = interior; j < n; ++j)
    for (Index k = column_[j]; k < column_[j + 1] - 1; ++k)
      if (fixed[j - interior] || (row_[k] >= interior && fixed[row_[k] - interior])) now_[k] = 0;
  const Serial serial;
  for (Real shift = 0, next = least_shift; shift <= most_shift; next *= stiffer) {
    check(cholmod_factorize(&view_, L_, &common_), common_);
    definite_ = common_.status != CHOLMOD_NOT_POSDEF;
    if (definite_) return;
    for (Index j = 0; j < n; ++j) diagonal(j) += (next - shift) * system_->D[j];
    shift = next;
  }
}

void FactoredMatrix::apply(const Vector& r, Vector& z) {
  z.setZero(r.size());
  if (!definite_) return;
  z = solve(CHOLMOD_A, r);
  drop_fixed(fixed_, z);
}

/// Supernodes keep zeros, what is without them the row of each entry.
double FactoredMatrix::bytes() const {
  if (!laid_out()) return 0;
  return L_->is_super ? sizeof(Real) * double(L_->xsize)
                      : (sizeof(Real) + sizeof(Index)) * common_.lnz;
}

Real FactoredMatrix::operator_complexity() const {
  return laid_out() ? 2 * common_.lnz / Real(system_->entries().nonZeros()) : 0;
}

}  // namespace frictioncg
