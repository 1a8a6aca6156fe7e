#pragma once
#include "types.h"

namespace frictioncg {

/// Of the dofs of one node: its normal, then its tangents.
using NodeVector = Eigen::Matrix<Real, Eigen::Dynamic, 1, 0, 3, 1>;
using NodeBlock = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;

/// What the laws of a step add to the matrix of a central path, in its units.
struct PathLaws {
  std::vector<NodeBlock> blocks;  ///< m
  bool symmetric = true;          ///< all of them are diagonal
};

/// The matrix K of a central path, and M = K + laws. The contact dofs are its last rows.
class PathMatrix {
 public:
  virtual ~PathMatrix() = default;
  virtual Vector multiply(const Vector& y) const = 0;  ///< K y
  virtual bool factor(const PathLaws& laws) = 0;       ///< false where M has no factor
  virtual Vector solve(const Vector& b) = 0;           ///< M^{-1} b
};

}  // namespace frictioncg
