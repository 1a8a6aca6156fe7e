#pragma once
// Random blocks in three dimensions for the tests of the iterative methods: pressed and sheared by
// loads, or driven by their top, on a plane or on a slightly curved obstacle; and load histories.
#include "../scene.h"

namespace frictioncg::test {

/// What a random block is made from; each has a solution by construction (moderate shear).
struct Block3d {
  BlockOptions block;
  bool driven = false;             ///< the top is moved, in place of pressure and shear
  Eigen::Vector3d drive{0, 0, 0};  ///< displacement of the top [length]
  Real curvature = 0;              ///< gap = curvature (x^2 + y^2), from the block's axis
};

inline Block3d random_block3d(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](Real a, Real b) {
    return std::uniform_real_distribution<Real>(a, b)(random);
  };
  Block3d b;
  BlockOptions& o = b.block;
  o.d = 3;
  o.seed = seed;
  o.cells = 2 + int(5 * uniform(0, 1));
  o.nu = uniform(0, 0.45);
  o.mu = uniform(0.05, 1.5);
  o.distortion = uniform(0, 1) < 0.5 ? 0.25 * uniform(0, 1) : 0;
  o.pressure = uniform(1, 20);
  b.driven = uniform(0, 1) < 0.4;
  o.clamp_side = !b.driven && uniform(0, 1) < 0.5;
  // a free block tilts beyond pressure/2 and slides beyond mu pressure
  const Real limit = o.clamp_side ? 2 : 0.9 * std::min(o.mu, 0.4);
  o.shear = o.pressure * limit * uniform(-1, 1);
  b.drive << 0.03 * uniform(-1, 1), 0.03 * uniform(-1, 1), -0.02 * uniform(0.2, 1);
  b.curvature = b.driven && uniform(0, 1) < 0.6 ? 0.02 * uniform(0, 1) : 0;
  return b;
}

/// Moves the top of a driven block to `drive`: its Dirichlet data.
inline void drive_top(const Block3d& b, const Eigen::Vector3d& drive, Scene& s) {
  const int m = b.block.cells + 1;
  for (Index p = s.n / 3 - m * m; p < s.n / 3; ++p)
    for (int c = 0; c < 3; ++c) s.b[3 * p + c] = 1e30 * drive[c];
}

inline Scene make_scene(const Block3d& b) {
  Scene s = block(b.block);
  const int m = b.block.cells + 1;
  if (b.driven) {
    s.b.setZero();
    const Index first = s.n - 3 * m * m;
    for (std::size_t k = 0; k < s.a.size(); ++k)
      if (s.i[k] == s.j[k] && s.i[k] >= first) s.a[k] = 1e30;
    drive_top(b, b.drive, s);
  }
  for (Index k = 0; k < s.gap.size(); ++k) {
    const Index node = s.points[k].dof[0] / 3;
    const Real x = Real(node % m) / (m - 1) - 0.5, y = Real(node / m % m) / (m - 1) - 0.5;
    s.gap[k] = b.curvature * (x * x + y * y);
  }
  return s;
}

}  // namespace frictioncg::test
