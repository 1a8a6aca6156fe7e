// The rigid motions alone: from S, and from A without a factor.
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "../random_scene.h"
#include "bodies.h"
#include "core/condensed/elimination.h"
#include "core/statics/rigid_motions.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// Expects `count` columns that cost no energy and are orthonormal in the product of D.
void expect_rigid(const DenseMatrix& W, const DenseMatrix& A, const Vector& D, Index count) {
  ASSERT_EQ(W.cols(), count);
  const DenseMatrix gram = W.transpose() * D.asDiagonal() * W;
  EXPECT_LT((gram - DenseMatrix::Identity(count, count)).norm(), 1e-9);
  EXPECT_LT((W.transpose() * A * W).norm(), 1e-12);
}

DenseMatrix schur_complement(const ContactProblem& p) {
  Elimination elimination;
  EXPECT_EQ(elimination.factor(*p.system, 1e9), Elimination::Outcome::done);
  return elimination.S();
}

}  // namespace

TEST(RigidMotions, AFreeBodyHasThreeOrSixASupportedOneNone) {
  for (int d : {2, 3})
    for (bool supported : {false, true}) {
      BlockOptions o;
      o.d = d;
      o.cells = 3;
      o.clamp_side = supported;
      const ContactProblem p = problem_of(o);
      // u_x held at one face leaves the other translations, and in 3D the turn about x
      const Index in_A = supported ? (d == 2 ? 1 : 3) : (d == 2 ? 3 : 6);
      const DenseMatrix A = p.system->entries();
      expect_rigid(rigid_motions(A, p.system->D), p.system->entries(), p.system->D, in_A);
      const Vector D = p.system->weight.tail(p.contact_dofs());
      const DenseMatrix S = schur_complement(p);
      expect_rigid(rigid_motions(S, D), S, D, in_A);
    }
}

TEST(RigidMotions, SeveralBodiesHaveTheSumOfTheirs) {
  for (int d : {2, 3}) {
    BlockOptions o;
    o.d = d;
    o.cells = 2;
    const ContactProblem p = beside(problem_of(o), 3);
    const Vector D = p.system->weight.tail(p.contact_dofs());
    const DenseMatrix S = schur_complement(p);
    expect_rigid(rigid_motions(S, D), S, D, d == 2 ? 9 : 18);
  }
}

TEST(RigidMotions, ASoftDeformationIsNone) {
  // a chain of two masses whose spring is 1e-8 of the springs to the ground, or there is none
  for (Real spring : {1e-8, 0.0}) {
    DenseMatrix S(3, 3);
    S << 1, 0, 0, 0, 1 + spring, -1, 0, -1, 1;
    EXPECT_EQ(rigid_motions(S, Vector::Ones(3)).cols(), spring > 0 ? 0 : 1);
  }
}

TEST(RigidMotions, ABodyOnOneNodeAndNoBodyAtAll) {
  EXPECT_EQ(rigid_motions(DenseMatrix::Zero(3, 3), Vector::Ones(3)).cols(), 3);
  EXPECT_EQ(rigid_motions(DenseMatrix(0, 0), Vector(0)).cols(), 0);
}

TEST(RigidMotions, RankDeficitsOfRandomMatricesAreFound) {
  for (int deficit : {0, 1, 2, 5, 8}) {
    Recipe r;
    r.seed = 3 + deficit;
    r.algebraic = true;
    r.nodes = 20;
    r.rank_deficit = deficit;
    r.contrast = 100;
    const Posed posed = make_scene(r).system();
    const System& s = *posed.problem().system;
    expect_rigid(rigid_motions(DenseMatrix(s.entries()), s.D), s.entries(), s.D, deficit);
  }
}

TEST(RigidMotions, TellThePlacesOfNodesByWhateverDofsTheseHave) {
  // three along turned axes, two of three, and one that cannot tell where along itself it lies
  const Eigen::Matrix3d axes = Eigen::Quaterniond(0.8, 0.3, -0.2, 0.4).normalized().matrix();
  const Vec3 a(1, 2, 3), b(-2, 0.5, 1), c(0.3, -4, 2);
  const std::vector<Index> node = {0, 0, 0, 1, 1, 2};
  DenseMatrix modes(6, 6);
  const auto set = [&](Index dof, const Vec3& t, const Vec3& x) {
    modes.row(dof) << t.transpose(), x.cross(t).transpose();
  };
  for (Index k = 0; k < 3; ++k) set(k, axes.col(k), a);
  set(3, Vec3::UnitX(), b);
  set(4, Vec3::UnitY(), b);
  set(5, Vec3::UnitZ(), c);
  const DenseMatrix place = places_of(node, 3, modes);
  EXPECT_LT((place.row(0).transpose() - a).norm(), 1e-14);
  EXPECT_LT((place.row(1).transpose() - b).norm(), 1e-14);
  EXPECT_LT((place.row(2).transpose() - Vec3(c[0], c[1], 0)).norm(), 1e-14);
}
