#include "assembly/dirichlet.h"

namespace frictioncg {

namespace {

/// A row is a Dirichlet condition where its diagonal is so many times its other entries. Contrasts
/// of stiffness stay below it; FreeFEM's smallest customary tgv, 1e10 times the coefficients, is
/// above.
constexpr Real huge_ratio = 1e10;
/// ... unless it may touch, and its diagonal is less than so many times what is usual in A: a
/// spring, or a mass, beside which couplings are small.
constexpr Real unusual = 1e4;

/// What the triplets say of each row.
struct Rows {
  std::vector<Real> diagonal, row_max, column_max;
  std::vector<char> emptied;  ///< the row has stored off-diagonal zeros
  Real identity;              ///< what rows of the identity have on the diagonal

  explicit Rows(const Triplets& A)
      : diagonal(A.n, 0), row_max(A.n, 0), column_max(A.n, 0), emptied(A.n, 0) {
    for (std::size_t k = 0; k < A.size; ++k) {
      const Index i = A.row(k), j = A.col(k);
      const Real a = std::abs(A.a[k]);
      if (!(a <= std::numeric_limits<Real>::max()))
        refuse("A(", i, ",", j, ") = ", A.a[k], "; the entries of A must be finite");
      if (i == j) {
        diagonal[i] += A.a[k];
      } else {
        if (a > row_max[i]) row_max[i] = a;
        if (a > column_max[j]) column_max[j] = a;
        if (a == 0) emptied[i] = 1;
      }
    }
    for (Index i = 0; i < A.n; ++i)
      if (!(diagonal[i] > 0))
        refuse("A(", i, ",", i, ") = ", diagonal[i],
               "; every diagonal entry must be > 0 (assemble with tgv=1e30 or tgv=-1, and with an "
               "elasticity term on every element)");
    identity = A.half ? 1 : common_diagonal();
  }

  Real others(Index i) const { return std::max(row_max[i], column_max[i]); }
  bool unit(Index i) const { return diagonal[i] == identity; }

  /// Of emptied rows that nothing couples: what all of them have, where A has been scaled, or 1.
  /// Lumped springs differ. Half-stored rows do not tell what couples them.
  Real common_diagonal() const {
    std::set<Real> values;
    for (std::size_t i = 0; i < diagonal.size() && values.size() < 2; ++i)
      if (emptied[i] && others(Index(i)) == 0) values.insert(diagonal[i]);
    return values.size() == 1 ? *values.begin() : 1;
  }
};

}  // namespace

NodeDofs dofs_of(const std::vector<ContactPoint>& points) {
  NodeDofs dofs;
  for (const ContactPoint& p : points) dofs.push_back(p.dof);
  return dofs;
}

Dirichlet::Dirichlet(const Triplets& A, const NodeDofs& may_touch)
    : number_(A.n, -1), half_(A.half) {
  const Rows rows(A);
  std::vector<char> touches(A.n, 0);
  for (const auto& node : may_touch)
    for (Index dof : node)
      if (dof >= 0) touches[dof] = 1;
  // A half-stored row of the identity shows only its half: believe it where some row shows the
  // zeros that the elimination stores.
  bool emptied_unit_rows = false;
  if (A.half)
    for (Index i = 0; i < A.n; ++i)
      emptied_unit_rows |= rows.emptied[i] && rows.row_max[i] == 0 && rows.unit(i);

  Real usual = 0;  // the largest of other entries, or, where there are none, the least diagonal
  if (A.n > 0)
    usual = std::max(*std::max_element(rows.row_max.begin(), rows.row_max.end()),
                     *std::min_element(rows.diagonal.begin(), rows.diagonal.end()));
  for (Index i = 0; i < A.n; ++i) {
    const Real others = rows.others(i);
    const bool alone = others == 0;
    const bool spring = touches[i] && !(rows.emptied[i] && rows.unit(i)) &&
                        rows.diagonal[i] < (alone ? huge_ratio : unusual) * usual;
    const bool huge = !alone && !spring && rows.diagonal[i] >= huge_ratio * others;
    const bool unit = A.half ? emptied_unit_rows && rows.row_max[i] == 0 && rows.unit(i)
                             : rows.row_max[i] == 0 && rows.column_max[i] > 0;
    const bool uncoupled = alone && !spring;
    if (!huge && !unit && !uncoupled) continue;
    number_[i] = size();
    const bool without = rows.unit(i) && (uncoupled || A.half) && A.is_owned(i);
    held_.push_back({i, rows.diagonal[i], without, false});
    unit_rows_ |= unit && !A.half;
  }
  find_lost(A);
}

Dirichlet Dirichlet::with_more(const std::vector<char>& held, const Vector& diagonal) const {
  Dirichlet all = *this;
  for (Index i = static_cast<Index>(number_.size()); i < static_cast<Index>(held.size()); ++i) {
    all.number_.push_back(held[i] ? all.size() : -1);
    if (held[i]) all.held_.push_back({i, diagonal[i], false, false});
  }
  return all;
}

/// A zero that is stored beside a free dof stands for a coupling that the assembly has taken out.
void Dirichlet::find_lost(const Triplets& A) {
  if (std::none_of(held_.begin(), held_.end(), [](const Held& h) { return h.uncoupled; })) return;
  for (std::size_t k = 0; k < A.size; ++k) {
    const Index i = A.row(k), j = A.col(k);
    if (A.a[k] != 0 || i == j || holds(i) == holds(j)) continue;
    Held& h = held_[holds(i) ? number_[i] : number_[j]];
    h.lost = h.uncoupled;
  }
}

Vector Dirichlet::data(const Vector& b) const {
  Vector data(size());
  for (Index k = 0; k < size(); ++k) {
    const Held& h = held_[k];
    data[k] = b[h.dof] / h.diagonal;
    if (data[k] != 0 && (h.lost || (h.uncoupled && !unit_rows_))) {
      refuse("b[", h.dof, "] = ", b[h.dof],
             " is the data of a Dirichlet dof whose couplings are not in A (",
             (half_ ? "half-stored with tgv=-1); assemble without sym=1 or with tgv=1e30"
                    : "tgv=-2); assemble with tgv=1e30 or tgv=-1"));
    }
  }
  return data;
}

}  // namespace frictioncg
