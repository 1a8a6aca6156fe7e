#pragma once
#include "linear_algebra.h"

namespace frictioncg {

/// Anderson acceleration of a fixed point g = G(g): the next g is the combination of the last
/// images G(g_k) whose residuals G(g_k) - g_k cancel best. On a linear G of rank k <= depth it is
/// exact after k + 1 images.
class Anderson {
 public:
  /// The g after the image G(g), of the same size as g.
  Vector next(const Vector& g, const Vector& image) {
    const Vector f = image - g;
    if (last_f_.size() == f.size()) remember(f, image);
    last_f_ = f;
    last_image_ = image;
    const Index used = std::min(count_, depth);
    if (used == 0) return image;
    const Vector theta = least_squares(df_.leftCols(used), f);
    return image - dimage_.leftCols(used) * theta;
  }

  void forget() { *this = Anderson(); }

  static constexpr Index depth = 5;  ///< 3 to 8 take the same passes on the dovetail at mu = 1

 private:
  void remember(const Vector& f, const Vector& image) {
    if (df_.cols() == 0) {
      df_.setZero(f.size(), depth);
      dimage_.setZero(f.size(), depth);
    }
    const Index column = count_++ % depth;
    df_.col(column) = f - last_f_;
    dimage_.col(column) = image - last_image_;
  }

  Index count_ = 0;
  Vector last_f_, last_image_;
  DenseMatrix df_, dimage_;  ///< differences of residuals and of images, one column a pass
};

}  // namespace frictioncg
