#include <gtest/gtest.h>

#include "core/statics/nearest_motion.h"

using namespace frictioncg;

namespace {

/// The nodes of a box, and the displacement a + w x x there.
struct Body {
  int d;
  std::vector<NodePlace> nodes;
  Vector u;

  Body(int dimension, const Eigen::Vector3d& a, const Eigen::Vector3d& w) : d(dimension) {
    Index dof = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 4; ++j)
        for (int k = 0; k < (d == 3 ? 2 : 1); ++k) {
          NodePlace n;
          n.x = {2.0 + i, 0.5 * j, 1.0 * k};
          for (int c = 0; c < d; ++c) n.dof[c] = dof++;
          nodes.push_back(n);
        }
    u.resize(dof);
    for (const NodePlace& n : nodes) {
      const Eigen::Vector3d v = a + w.cross(Eigen::Vector3d(n.x[0], n.x[1], n.x[2]));
      for (int c = 0; c < d; ++c) u[n.dof[c]] = v[c];
    }
  }
  std::string text() const { return describe_motion(nodes, d, u); }
};

}  // namespace

TEST(RigidMotion, IsFoundFromTheDisplacementsThatItGives) {
  const Eigen::Vector3d a(0.3, -1, 2), w(0.5, 0.1, -0.7);
  const Body body(3, a, w);
  const RigidMotion m = nearest_rigid_motion(body.nodes, 3, body.u);
  EXPECT_LT((m.w - w).norm(), 1e-13);
  EXPECT_LT((m.a - a - w.cross(m.c)).norm(), 1e-13);
  EXPECT_LT(m.misfit, 1e-13);
}

TEST(RigidMotion, ATranslationIsNamedByItsDirection) {
  EXPECT_EQ(Body(2, {3, 4, 0}, {0, 0, 0}).text(), "a translation along (0.6, 0.8)");
  EXPECT_EQ(Body(3, {0, 0, -7}, {0, 0, 0}).text(), "a translation along (0, 0, -1)");
}

TEST(RigidMotion, ARotationIsNamedByItsCentreOrAxis) {
  const Eigen::Vector3d centre(1, 2, 0), w(0, 0, -0.1);
  EXPECT_EQ(Body(2, -w.cross(centre), w).text(), "a rotation, clockwise, about (1, 2)");
  EXPECT_EQ(Body(2, w.cross(centre), -w).text(), "a rotation, counter-clockwise, about (1, 2)");
  EXPECT_EQ(
      Body(3, -w.cross(centre) + Eigen::Vector3d(0, 0, 1), w).text(),
      "a rotation about the axis (0, 0, -1) through (1, 2, 0.5), with a translation along it");
}

TEST(RigidMotion, ARotationAboutACentreThousandsOfSizesAwayIsATranslation) {
  const Eigen::Vector3d far(0, 3e4, 0), near(0, 1e3, 0), w(0, 0, 1e-4);
  EXPECT_EQ(Body(2, -w.cross(far), w).text(), "a translation along (1, 0)");
  EXPECT_EQ(Body(3, -w.cross(far), w).text(), "a translation along (1, 0, 0)");
  EXPECT_EQ(Body(2, -w.cross(near), w).text(), "a rotation, counter-clockwise, about (0, 1000)");
}

TEST(RigidMotion, AMotionOfAPartIsNamedByTheNodeThatMovesMost) {
  Body body(2, {0, 0, 0}, {0, 0, 0});
  body.u[body.nodes[5].dof[1]] = -2;
  EXPECT_EQ(body.text(), "a motion of a part of the body, most at (3, 0.5), along (0, -1)");
}

TEST(RigidMotion, OfSeveralBodiesThoseThatMoveAreNamedByTheirPlace) {
  Body two(2, {0.5, 0, 0}, {0, 0, 0});
  const std::size_t half = two.nodes.size();
  for (std::size_t k = 0; k < half; ++k) {
    NodePlace n = two.nodes[k];
    n.body = 1;
    n.x[1] += 10;
    for (int c = 0; c < 2; ++c) n.dof[c] += 2 * static_cast<Index>(half);
    two.nodes.push_back(n);
  }
  const Vector first = two.u;
  two.u.resize(2 * first.size());
  two.u << first, first;
  EXPECT_EQ(two.text(), "a translation along (1, 0)");  // as one
  two.u.head(first.size()).setZero();
  EXPECT_EQ(two.text(), "a translation along (1, 0) of the body around (3, 10.75)");
  two.u.head(first.size()) = -first;
  EXPECT_EQ(two.text(),
            "a translation along (-1, 0) of the body around (3, 0.75), with a translation along "
            "(1, 0) of the body around (3, 10.75)");
}

TEST(RigidMotion, OfManyBodiesTheThreeThatMoveMostAreNamed) {
  const Body one(2, {1, 0, 0}, {0, 0, 0});
  const Index dofs = static_cast<Index>(one.u.size());
  std::vector<NodePlace> nodes;
  Vector u(5 * dofs);
  for (Index b = 0; b < 5; ++b) {
    for (NodePlace n : one.nodes) {
      n.body = b;
      n.x[1] += 10 * b;
      for (int c = 0; c < 2; ++c) n.dof[c] += b * dofs;
      nodes.push_back(n);
    }
    u.segment(b * dofs, dofs) = (b % 2 ? -1 : 1) * (b + 1) * one.u;
  }
  EXPECT_EQ(describe_motion(nodes, 2, u),
            "a translation along (1, 0) of the body around (3, 40.75), with a translation along "
            "(-1, 0) of the body around (3, 30.75), with a translation along (1, 0) of the body "
            "around (3, 20.75), and 2 more");
  u.head(2 * dofs).setZero();
  EXPECT_EQ(describe_motion(nodes, 2, u).find("more"), std::string::npos);
}

TEST(RigidMotion, NoNodesAndNoMotionAreNoMotion) {
  EXPECT_EQ(describe_motion({}, 2, Vector()), "no motion");
  EXPECT_EQ(Body(2, {0, 0, 0}, {0, 0, 0}).text(), "no motion");
}

TEST(RigidMotion, NodesOnALineInSpaceDoNotTurnAboutIt) {
  std::vector<NodePlace> nodes(2);
  nodes[0].dof = {0, 1, 2};
  nodes[1].dof = {3, 4, 5};
  nodes[1].x = {1, 0, 0};
  Vector u = Vector::Zero(6);
  u[4] = 1;  // turns about z at the first node
  EXPECT_EQ(describe_motion(nodes, 3, u), "a rotation about the axis (0, 0, 1) through (0, 0, 0)");
}

TEST(RigidMotion, ItsModesSpanAllRigidMotions) {
  const Body turning(3, {0.3, -1, 2}, {0.5, 0.1, -0.7}), flat(2, {1, 2, 0}, {0, 0, 0.4});
  for (const Body* body : {&turning, &flat}) {
    const Eigen::MatrixXd modes =
        rigid_modes(body->nodes, body->d, static_cast<Index>(body->u.size()));
    ASSERT_EQ(modes.cols(), body->d == 2 ? 3 : 6);
    EXPECT_LE(modes.cwiseAbs().maxCoeff(), 1 + 1e-12);
    const Vector c = modes.colPivHouseholderQr().solve(body->u);
    EXPECT_LT((modes * c - body->u).norm(), 1e-13 * body->u.norm());
  }
}
