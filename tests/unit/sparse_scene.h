#pragma once
// Scenes too large for scene.h's dense assembly: P1 elasticity on a block of simplices in 2D or 3D,
// graded, with contrast, unstructured, flat or with a curved bottom.
#include <array>
#include <cmath>

#include "scene.h"

namespace frictioncg::test {

struct SparseOptions {
  int d = 3;
  std::array<int, 3> cells{{8, 8, 8}};
  std::array<Real, 3> size{{1, 1, 1}};
  Real nu = 0.3;
  Real aspect = 1;      // largest over smallest height of a layer: layers shrink towards the bottom
  Real contrast = 1;    // of E between octants of the block, in turn
  Real distortion = 0;  // random displacement of interior mesh nodes, in cells
  bool clamp_side = true;  // u = 0 on the face x = 0
  bool push_top = false;   // in place of a pressure: the top moves down by `depth`
  Real depth = 0.01;
  Real pressure = 10, shear = 2;
  Real curvature = 0;  // of the gap under the bottom: gap = curvature |x - centre|^2 / 2
  Real tilt = 0;       // normals turn with x by up to this angle
  Real mu = 0.3;
  Real mu_ratio = 1;  // orthotropic: the second coefficient over the first
  Law law = Law::coulomb;
  bool contact = true;
  unsigned seed = 1;
};

/// As many cells along each edge.
inline SparseOptions cube_of(int cells, int d = 3) {
  SparseOptions o;
  o.d = d;
  o.cells = {cells, cells, cells};
  return o;
}

struct SparseScene : Scene {
  Eigen::MatrixXd position;        // mesh nodes x d
  std::vector<Index> node_of_dof;  // of the script's dofs: d * node + component
};

SparseScene sparse_block(const SparseOptions& o);

}  // namespace frictioncg::test
