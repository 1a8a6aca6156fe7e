#include "assembly/mortar/moments.h"

#include "linear_algebra.h"

namespace frictioncg::mortar {

namespace {

/// A mean point lies on the normal where it misses by less than this share of what its row sums up.
constexpr Real rounding = 1e-14;

/// One row of P: its nodes on the master, seen along the normal.
class Row {
 public:
  Row(const Matrix& P, Index i, const Vec3& n, const std::vector<Vec3>& X) : P_(P), i_(i), X_(X) {
    along_ -= n * n.transpose();
    Real sum = 0;
    for (Matrix::InnerIterator it(P, i); it; ++it) {
      sum += std::abs(it.value());
      mean_ += std::abs(it.value()) * X[it.col()];
    }
    if (sum > 0) mean_ /= sum;
  }
  /// b of the formula above; less where weights would change too much.
  Vec3 change(const Vec3& e) const {
    Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
    for (Matrix::InnerIterator it(P_, i_); it; ++it)
      M += std::abs(it.value()) * place(it.col()) * place(it.col()).transpose();
    const Vec3 b = least_squares(M, e, singular);
    Real largest = 0;
    for (Matrix::InnerIterator it(P_, i_); it; ++it)
      largest = std::max(largest, std::abs(b.dot(place(it.col()))));
    return std::min(1., most_change / largest) * b;
  }
  Vec3 place(Index l) const { return along_ * (X_[l] - mean_); }
  Vec3 along(const Vec3& x) const { return along_ * x; }

 private:
  const Matrix& P_;
  Index i_;
  const std::vector<Vec3>& X_;
  Eigen::Matrix3d along_ = Eigen::Matrix3d::Identity();
  Vec3 mean_ = Vec3::Zero();
};

}  // namespace

Matrix balanced(const Matrix& P, const Matrix& G, const std::vector<ContactNode>& nodes,
                const std::vector<Vec3>& X) {
  Matrix result = P;
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Index i = nodes[k].node;
    Vec3 arm = Vec3::Zero();
    Real size = 0;
    for (Matrix::InnerIterator it(G, static_cast<Index>(k)); it; ++it) {
      arm += it.value() * (X[it.col()] - X[i]);
      size += std::abs(it.value()) * (X[it.col()] - X[i]).norm();
    }
    const Row row(P, i, nodes[k].normal, X);
    const Vec3 e = row.along(arm);
    if (e.norm() <= rounding * size) continue;
    const Vec3 b = row.change(e);
    for (Matrix::InnerIterator it(result, i); it; ++it)
      it.valueRef() += std::abs(it.value()) * b.dot(row.place(it.col()));
  }
  return result;
}

}  // namespace frictioncg::mortar
