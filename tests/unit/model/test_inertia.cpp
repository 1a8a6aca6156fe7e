// What of a load carries bodies on as a whole is no measure of contact forces.
#include <gtest/gtest.h>

#include "../statics/bodies.h"
#include "core/model/inertia.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// Two blocks that share nothing, with a mass at each dof.
std::shared_ptr<AssembledSystem> two_blocks(Real mass, bool supported = false) {
  BlockOptions o;
  o.cells = 4;
  o.d = 3;
  const auto system = std::make_shared<AssembledSystem>(assembled(beside(problem_of(o), 2).system));
  for (Index i = 0; i < system->dofs(); ++i) system->A.coeffRef(i, i) += mass * system->D[i];
  for (Index i = 0; i < system->dofs() / 3 && supported; ++i)
    system->A.coeffRef(i, i) += system->D[i];
  system->D = system->A.diagonal();
  system->weight = node_weights(*system);
  return system;
}

}  // namespace

TEST(Inertia, SupportsAreNone) {
  EXPECT_EQ(inertia_of(*two_blocks(0)).cols(), 0);
  EXPECT_EQ(inertia_of(*two_blocks(0, true)).cols(), 0);
  EXPECT_EQ(inertia_of(*two_blocks(1e-9)).cols(), 12);
  auto unknown = two_blocks(1e-3);
  unknown->rigid_modes = {};
  EXPECT_EQ(inertia_of(*unknown).cols(), 0);
}

TEST(Inertia, ALoadCountsBesideWhatCarriesEachBodyOn) {
  const auto system = two_blocks(1e-3);
  const Vector b = Vector::Random(system->dofs());
  EXPECT_EQ(load_beside_inertia(*system, b), norm_D(*system, b));
  system->inertia = inertia_of(*system);
  const DenseMatrix W = system->rigid_modes();
  const Bodies bodies = system->bodies();
  Vector carried = Vector::Zero(system->dofs());
  for (Index i = 0; i < system->dofs(); ++i)
    carried[i] = bodies.of[i] == 0 ? 3 * W(i, 0) - 2 * W(i, 4) : W(i, 1) + 5 * W(i, 5);
  Vector inertia;
  system->multiply(carried, inertia);
  const Real alone = load_beside_inertia(*system, b);
  EXPECT_GT(alone, 0.9 * norm_D(*system, b));
  EXPECT_LE(alone, norm_D(*system, b));
  EXPECT_LT(load_beside_inertia(*system, inertia), 1e-12 * norm_D(*system, inertia));
  EXPECT_NEAR(load_beside_inertia(*system, b + 1e4 * inertia), alone, 1e-7 * alone);
}
