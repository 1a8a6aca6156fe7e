#include "core/assembly/obstacles.h"

#include <gtest/gtest.h>

#include "core/linear_algebra.h"
#include "core/multigrid/faces.h"
#include "core/multigrid/hierarchy.h"
#include "core/solver.h"
#include "unit/sparse_scene.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// Two obstacles below a block, side by side.
struct Moving {
  Scene scene;
  RigidObstacles obstacles;
  std::unique_ptr<LocalSystem> local;

  explicit Moving(int d, std::vector<char> free, Real unit = 1) {
    BlockOptions o;
    o.d = d;
    o.cells = d == 2 ? 14 : 4;
    o.angle = 0.4;
    if (d == 3) o.axis = {1, 2, 3};
    scene = block(o);
    for (ContactPoint& p : scene.points) p.friction = true;
    for (Index i = scene.n - 3 * d; i < scene.n; ++i) {  // the body stands on springs, too
      scene.i.push_back(i);
      scene.j.push_back(i);
      scene.a.push_back(1000);
    }
    obstacles.free = std::move(free);
    for (std::size_t k = 0; k < scene.points.size(); ++k) {
      obstacles.of_point.push_back(2 * k < scene.points.size() ? 0 : 1);
      const Real row = Real(d == 2 ? o.cells : 1 + o.cells), t = std::floor(Real(k) / row);
      obstacles.arm.push_back(
          unit * Eigen::Vector3d((Real(k) - t * row) / row, t / row + 0.2, d == 3 ? 0.3 : 0));
    }
    pose();
  }
  void pose() {
    const Eigen::MatrixXd modes = scene.modes;
    BodyShape shape;
    shape.rigid_modes = [modes] { return modes; };
    shape.body_modes = [modes] { return Matrix(modes.sparseView()); };
    std::vector<Index> node(scene.n);
    for (Index i = 0; i < scene.n; ++i) node[i] = i / scene.d;
    local = std::make_unique<LocalSystem>(scene.triplets(), scene.d, scene.points, node, shape,
                                          nullptr, obstacles);
  }
  Index each() const { return rigid_components(scene.d); }
  /// Of obstacle o at a point, by the cross product.
  Eigen::Vector3d displacement(std::size_t point, const Vector& q) const {
    const Index o = obstacles.of_point[point];
    Eigen::Vector3d a = Eigen::Vector3d::Zero(), w = Eigen::Vector3d::Zero();
    a.head(scene.d) = q.segment(o * each(), scene.d);
    if (scene.d == 2)
      w[2] = q[o * each() + 2];
    else
      w = q.segment(o * each() + 3, 3);
    return a + w.cross(obstacles.arm[point]);
  }
};

std::vector<char> all_free(int d) { return std::vector<char>(2 * rigid_components(d), 1); }

}  // namespace

TEST(Obstacles, LawsHoldInWhatANodeMovesRelativeToItsObstacle) {
  for (int d : {2, 3}) {
    const Moving s(d, all_free(d));
    const Basis& basis = s.local->basis();
    const Index n = s.scene.n, n_q = s.obstacles.dofs();
    const Vector u = Vector::Random(n + n_q);
    const Vector w = s.local->to_local(u);
    EXPECT_NEAR((s.local->to_global(w) - u).norm(), 0, 1e-12);
    for (Index k = 0; k < s.local->nodes(); ++k) {
      const Index point = s.local->node(k).point;
      const ContactPoint& p = s.scene.points[point];
      const Eigen::Vector3d moved = s.displacement(point, u.tail(n_q));
      Real along = 0, size = 0;
      for (int c = 0; c < d; ++c) {
        along += p.normal[c] * (u[p.dof[c]] - moved[c]);
        size += std::pow(u[p.dof[c]] - moved[c], 2);
      }
      EXPECT_NEAR(w[basis.first[k]], along, 1e-12);
      EXPECT_NEAR(w.segment(basis.first[k], d).squaredNorm(), size, 1e-11);
    }
  }
}

TEST(Obstacles, AnObstacleAloneMovesAtNoCost) {
  for (int d : {2, 3}) {
    std::vector<char> free = all_free(d);
    free[1] = 0;
    const Moving s(d, free);
    const System& system = *s.local->system();
    const DenseMatrix border(system.border);
    ASSERT_EQ(border.cols(), 2 * s.each() - 1);
    EXPECT_LT((system.entries() * border).norm(), 1e-12 * system.entries().norm() * border.norm());
    for (Index k = 0; k < border.cols(); ++k) {
      const Vector u = s.local->to_global(border.col(k));
      EXPECT_LT(u.head(s.scene.n).norm(), 1e-12 * u.norm());
      EXPECT_EQ(border(system.interior() - border.cols() + k, k), 1);
    }
    EXPECT_EQ(system.body_modes().cols(), s.each() + s.obstacles.dofs());
  }
}

TEST(Obstacles, ForcesOnThemAreThoseOfTheContactPointsAndTheirMoments) {
  const Moving s(3, all_free(3));
  const System& system = *s.local->system();
  const Vector r = Vector::Random(system.dofs());
  const Vector force = s.local->force_to_global(r);
  Vector sum = Vector::Zero(s.obstacles.dofs());
  for (std::size_t k = 0; k < s.scene.points.size(); ++k) {
    Eigen::Vector3d f;
    for (int c = 0; c < 3; ++c) f[c] = force[s.scene.points[k].dof[c]];
    const Index o = 6 * s.obstacles.of_point[k];
    sum.segment(o, 3) -= f;
    sum.segment(o + 3, 3) -= s.obstacles.arm[k].cross(f);
  }
  EXPECT_NEAR((force.tail(sum.size()) - sum).norm(), 0, 1e-12 * sum.norm());
}

TEST(Obstacles, GivenMotionsAreDirichletData) {
  std::vector<char> free(6, 0);
  const Moving s(2, free);
  EXPECT_EQ(s.local->system()->border.cols(), 0);
  Vector b = Vector::Zero(s.scene.n + 6);
  b.tail(6) << 1, 2, 3, 4, 5, 6;
  const LocalLoad load = s.local->load_from(b, {});
  EXPECT_NEAR(
      (s.local->to_global(Vector::Zero(s.local->system()->dofs()), s.local->basis().T * load.start)
           .tail(6) -
       b.tail(6))
          .norm(),
      0, 1e-14);
}

TEST(Obstacles, RotationsAreMeasuredByTheExtentOfTheContact) {
  const Moving metres(2, all_free(2)), millimetres(2, all_free(2), 1000);
  const System &a = *metres.local->system(), &b = *millimetres.local->system();
  EXPECT_LT((a.D - b.D).norm(), 1e-10 * a.D.norm());
}

TEST(Obstacles, AFreeComponentThatMovesNothingIsRefused) {
  Moving s(2, all_free(2));
  for (Index& o : s.obstacles.of_point) o = 0;
  try {
    s.pose();
    FAIL();
  } catch (const UselessComponent& e) {
    EXPECT_EQ(e.component, 3);
  }
}

TEST(Obstacles, TheBorderedHierarchyIsSymmetricDefiniteAndZeroOnWhatIsFixed) {
  for (int d : {2, 3}) {
    const Moving s(d, all_free(d));
    const System& system = *s.local->system();
    HierarchyOptions options;
    options.dense = system.dofs() - 1;  // as few as are left without the border
    options.coarsest = 20;
    const auto hierarchy = make_hierarchy(system, options);
    Vector product;
    ASSERT_FALSE(hierarchy->multiply(system.D, product));  // others keep A
    ASSERT_EQ(hierarchy->levels(), 3);                     // two cycles on the one between
    const Index n = system.dofs(), interior = system.interior();
    for (int round = 0; round < 3; ++round) {
      std::vector<char> fixed(system.contact_dofs(), 0);
      for (Index k = 0; k < system.nodes(); ++k)
        for (Index i = system.first[k]; i < system.first[k + 1]; ++i)
          fixed[i - interior] = (k + round) % 3 != 0;
      std::vector<TangentialStiffness> W;
      const Index slides = system.first[round] + 1;  // a tangent that is not fixed
      fixed[slides - interior] = fixed[slides - interior + d - 2] = 0;
      const Real stiffness = system.D[slides];
      if (d == 3) W.push_back({slides, stiffness * Eigen::Matrix2d::Identity()});
      std::vector<char> others = fixed;  // what was fixed before leaves no trace
      for (std::size_t c = 0; c < others.size(); c += 6) others[c] = !others[c];
      Vector springs;
      if (round == 2) springs = 0.3 * system.D.tail(system.contact_dofs());
      hierarchy->truncate(others, W);
      hierarchy->truncate(fixed, W, springs);
      DenseMatrix M(n, n);
      Vector z;
      for (Index i = 0; i < n; ++i) {
        hierarchy->apply(Vector::Unit(n, i), z);
        M.col(i) = z;
      }
      std::vector<Index> free_dofs;
      for (Index i = 0; i < n; ++i)
        if (i < interior || !fixed[i - interior])
          free_dofs.push_back(i);
        else
          EXPECT_EQ(M.row(i).norm(), 0);
      DenseMatrix on_free(free_dofs.size(), free_dofs.size()), A = on_free;
      for (std::size_t p = 0; p < free_dofs.size(); ++p)
        for (std::size_t q = 0; q < free_dofs.size(); ++q) {
          on_free(p, q) = M(free_dofs[p], free_dofs[q]);
          A(p, q) = system.entries().coeff(free_dofs[p], free_dofs[q]);
        }
      if (d == 3)
        for (std::size_t p = 0; p < free_dofs.size(); ++p)
          if (d == 3 && (free_dofs[p] == slides || free_dofs[p] == slides + 1))
            A(p, p) += stiffness;
      if (springs.size() > 0)
        for (std::size_t p = 0; p < free_dofs.size(); ++p)
          if (free_dofs[p] >= interior) A(p, p) += springs[free_dofs[p] - interior];
      const DenseMatrix scaled =
          A.diagonal().cwiseSqrt().asDiagonal() * on_free * A.diagonal().cwiseSqrt().asDiagonal();
      EXPECT_LT((scaled - scaled.transpose()).norm(), 1e-4 * scaled.norm());
      // M A = 1 about, along the border, too
      const Eigen::LLT<DenseMatrix> factor(A);
      ASSERT_EQ(factor.info(), Eigen::Success);
      const DenseMatrix L = factor.matrixL();
      const Vector values =
          eigenpairs(L.transpose() * (on_free + on_free.transpose()) / 2 * L).values;
      EXPECT_LT(values[values.size() - 1], 1.5) << d << " " << round;
      EXPECT_GT(values[0], 0.2) << d << " " << round;
    }
  }
}

TEST(Obstacles, MultigridStartsFromTheNodesThatTheirLoadsReachIfTheseCanHoldThem) {
  for (int d : {2, 3}) {
    const Moving s(d, all_free(d));
    ContactProblem problem;
    problem.system = s.local->system();
    const System& system = *problem.system;
    const Index k = static_cast<Index>(system.border.cols());
    const DenseMatrix C(system.border);
    Increment& increment = problem.increment;
    increment.law = Law::coulomb;
    increment.mu = Vector::Constant(system.nodes(), 0.3);
    increment.gap = Vector::Constant(system.nodes(), 1000);
    Index tip = -1;  // of the first obstacle, whose other nodes are far away; the second is idle
    const auto obstacle = [&](Index i) { return s.obstacles.of_point[s.local->node(i).point]; };
    for (Index i = 0; i < system.nodes() && tip < 0; ++i)
      if (obstacle(i) == 0) tip = i;
    increment.gap[tip] = 0.1;
    const auto closed = [&](const Vector& load) {
      increment.F = Vector::Zero(system.dofs());
      increment.F.segment(system.interior() - k, k) = load;
      Index count = 0;
      for (const Branch& face : reached(problem)) count += face.closed;
      return count;
    };
    Index idle = 0;
    for (Index i = 0; i < system.nodes(); ++i) idle += obstacle(i) == 1;
    ASSERT_GT(system.nodes(), idle + 1);
    const Vector push = C.row(system.first[tip]).transpose();
    EXPECT_EQ(closed(push), idle + 1);
    EXPECT_TRUE(reached(problem)[tip].stick);
    EXPECT_EQ(closed(-push), system.nodes());
    Vector turns = push;
    turns[s.each() - 1] += 10 * push.norm();
    EXPECT_EQ(closed(turns), system.nodes());
    // what is pressed in its middle reaches all of its nodes, gaps being equal
    increment.gap.setConstant(0.1);
    Vector middle = Vector::Zero(k);
    for (Index i = 0; i < system.nodes(); ++i)
      if (obstacle(i) == 0) middle += C.row(system.first[i]).transpose();
    EXPECT_EQ(closed(middle), system.nodes());
  }
}
