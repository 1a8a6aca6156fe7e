#include "sparse/sparse_path.h"

namespace frictioncg {

namespace {

/// Of the residual: the next step starts from what this one leaves. At 1e-8 slender bodies take up
/// to 1.5 times the cycles, at 1e-3 a third less, but up to five steps more.
constexpr Real enough = 1e-5;
constexpr int most_directions = 40;

}  // namespace

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
