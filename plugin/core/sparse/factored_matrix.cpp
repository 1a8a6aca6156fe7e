#include "sparse/factored_matrix.h"

namespace frictioncg {

namespace {
/// Over D, what makes a matrix definite that is none: a motion is free. What takes more is no
/// rounding.
constexpr Real least_shift = 1e-14, most_shift = 1e-8, stiffer = 100;
/// Of the residual of a step along the central path: the next one starts from what this one leaves.
/// At 1e-8 slender bodies take up to 1.5 times the cycles, at 1e-3 a third less, but up to five
/// steps more.
constexpr Real enough = 1e-5;
constexpr int most_directions = 40;
}  // namespace

/// In 2D factors of strips take half as long without supernodes, as CHOLMOD chooses. On plates of
/// 3650, 25 000 and 73 000 dofs nested dissection saves at most 6 % of the flops, and takes three
/// times as long; CHOLMOD's own choice of an order, by dofs, 0.8 to 1.9 times the flops and up to
/// 20 times as long.
FactoredMatrix::FactoredMatrix(SystemPtr system) : SparseFactor(CHOLMOD_AUTO) {
  renew(std::move(system));
  lay_out(now_->view, by_nodes(*system_, common_));
}

void FactoredMatrix::renew(SystemPtr system) {
  system_ = std::move(system);
  fixed_.clear();
  std::vector<char> second(system_->dofs(), 0);  // tangents of a node
  for (Index i = 0; i < system_->nodes(); ++i)
    if (system_->tangents(i) == 2) second[system_->first[i] + 2] = 1;
  now_.emplace(*system_, second);
  value_ = now_->value;
}

void FactoredMatrix::truncate(const std::vector<char>& fixed,
                              const std::vector<TangentialStiffness>& W, const Vector& springs) {
  const Index n = system_->dofs(), interior = system_->interior();
  fixed_ = fixed;
  springs_ = !springs.isZero(0);
  UpperTriangle& A = *now_;
  A.value = value_;
  for (const TangentialStiffness& w : W) {
    A.diagonal(w.first) += w.M(0, 0);
    A.diagonal(w.first + 1) += w.M(1, 1);
    A.value[A.column[w.first + 2] - 2] += w.M(0, 1);
  }
  for (Index c = 0; c < springs.size(); ++c) A.diagonal(interior + c) += springs[c];
  for (Index j = interior; j < n; ++j)
    for (Index k = A.column[j]; k < A.column[j + 1] - 1; ++k)
      if (fixed[j - interior] || (A.row[k] >= interior && fixed[A.row[k] - interior]))
        A.value[k] = 0;
  for (Real shift = 0, next = least_shift; shift <= most_shift; next *= stiffer) {
    definite_ = factorize(A.view);
    if (definite_) return;
    for (Index j = 0; j < n; ++j) A.diagonal(j) += (next - shift) * system_->D[j];
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

Vector SparsePathMatrix::multiply(const Vector& y) const {
  return (system_.entries() * y.cwiseQuotient(unit_)).cwiseQuotient(unit_);
}

bool SparsePathMatrix::factor(const PathLaws& laws) {
  laws_ = laws;
  const Index interior = system_.interior();
  Vector springs(system_.contact_dofs());
  std::vector<TangentialStiffness> W;
  for (Index i = 0; i < system_.nodes(); ++i) {
    const Index N = system_.first[i], size = system_.tangents(i) + 1;
    const NodeBlock block = system_.weight.segment(N, size).asDiagonal() * laws.blocks[i];
    springs.segment(N - interior, size) = block.diagonal();
    if (size < 3 || laws.symmetric) continue;
    springs.segment<2>(N + 1 - interior).setZero();
    const Eigen::Matrix2d B = block.bottomRightCorner<2, 2>();
    W.push_back({N + 1, (B + B.transpose()) / 2});
  }
  factor_.truncate(std::vector<char>(system_.contact_dofs(), 0), W, springs);
  return factor_.definite();
}

/// By generalized conjugate residuals: one step where M is symmetric.
Vector SparsePathMatrix::solve(const Vector& b) {
  Vector y = Vector::Zero(b.size()), r = b, z;
  std::vector<std::pair<Vector, Vector>> directions;  // and M times them, orthonormal
  const Real goal = enough * b.norm();
  while (r.norm() > goal && directions.size() < most_directions) {
    factor_.apply(unit_.cwiseProduct(r), z);
    z = unit_.cwiseProduct(z);
    Vector Mz = multiply(z);
    for (Index i = 0; i < system_.nodes(); ++i) {
      const Index N = system_.first[i], size = system_.tangents(i) + 1;
      Mz.segment(N, size) += laws_.blocks[i] * z.segment(N, size);
    }
    for (const auto& [before, image] : directions) {
      const Real along = Mz.dot(image);
      z -= along * before;
      Mz -= along * image;
    }
    const Real size = Mz.norm();
    if (!(size > 0)) break;
    directions.emplace_back(z / size, Mz / size);
    const Real along = r.dot(directions.back().second);
    y += along * directions.back().first;
    r -= along * directions.back().second;
  }
  return y;
}

}  // namespace frictioncg
