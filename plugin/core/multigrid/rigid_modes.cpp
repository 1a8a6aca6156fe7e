#include "multigrid/rigid_modes.h"

namespace frictioncg {

Eigen::MatrixXd rigid_modes(const Eigen::MatrixXd& position, const Eigen::MatrixXd& direction) {
  const Eigen::Index n = position.rows(), d = position.cols();
  const Eigen::MatrixXd dual = [&] {
    // component c of the dof that follows u: the frames are orthogonal, so divide by the length
    // squared
    const Vector length2 = direction.rowwise().squaredNorm();
    return Eigen::MatrixXd(length2.cwiseInverse().asDiagonal() * direction);
  }();
  const Eigen::RowVectorXd centre = position.colwise().mean();
  const Eigen::MatrixXd arm = position.rowwise() - centre;
  const Real size = n > 0 ? arm.cwiseAbs().maxCoeff() : 1;

  Eigen::MatrixXd modes(n, d == 2 ? 3 : 6);
  modes.leftCols(d) = dual;
  // rotation in the plane of axes a and b: u_a = -x_b, u_b = x_a
  Eigen::Index column = d;
  for (Eigen::Index a = 0; a < d; ++a)
    for (Eigen::Index b = a + 1; b < d; ++b)
      modes.col(column++) =
          (dual.col(b).cwiseProduct(arm.col(a)) - dual.col(a).cwiseProduct(arm.col(b))) /
          (size > 0 ? size : 1);
  return modes;
}

}  // namespace frictioncg
