#pragma once
#include <Eigen/QR>
#include <algorithm>

#include "types.h"

namespace frictioncg {

/// Anderson acceleration of a fixed point g = G(g), depth 5: the next g is the combination of the
/// last images G(g_k) whose residuals G(g_k) - g_k cancel best.
class Anderson {
 public:
  Vector next(const Vector& g, const Vector& image) {
    const Vector f = image - g;
    if (last_f_.size() == f.size()) {
      const Index column = count_++ % depth;
      if (df_.cols() == 0) {
        df_.setZero(f.size(), depth);
        dimage_.setZero(f.size(), depth);
      }
      df_.col(column) = f - last_f_;
      dimage_.col(column) = image - last_image_;
    }
    last_f_ = f;
    last_image_ = image;
    const Index used = std::min(count_, depth);
    if (used == 0) return image;
    const Vector theta = df_.leftCols(used).completeOrthogonalDecomposition().solve(f);
    return image - dimage_.leftCols(used) * theta;
  }

 private:
  static constexpr Index depth = 5;
  Index count_ = 0;
  Vector last_f_, last_image_;
  Eigen::MatrixXd df_, dimage_;
};

}  // namespace frictioncg
