// The preconditioner precon="multigrid" of the paper's methods.
#include <gtest/gtest.h>

#include "../refusal.h"
#include "core/gradient/preconditioner.h"
#include "core/model/validate.h"
#include "core/solver.h"
#include "../multigrid/scene_in_blocks.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

Solution by(Method method, Precon precon, const Posed& posed) {
  Settings settings{method};
  settings.precon = precon;
  return solve(posed.problem(), settings);
}

/// Held: a normal, a stuck node; beside them slip with a Hessian, one of it far stiffer than A.
struct OnAFace {
  SceneInBlocks scene;
  const System& system;
  ContactPart part;
  Vector r;
  explicit OnAFace(int cells) : scene(cube_of(cells)), system(*scene.system) {
    const Index m = system.contact_dofs();
    part.free.assign(m, 1);
    for (Index c : {0, 3, 4, 5}) part.free[c] = 0;
    part.hessian = Vector::Zero(m);
    part.hessian.segment(7, 2).setConstant(3 * system.D[system.interior() + 7]);
    part.hessian.segment(10, 2).setConstant(1e6 * system.D[system.interior() + 10]);
    r = Vector::Random(system.dofs());
    for (Index c = 0; c < m; ++c)
      if (!part.free[c]) r[system.interior() + c] = 0;
  }
  Vector r_C() const { return r.tail(system.contact_dofs()); }
  /// What P approximates: A on the free dofs, and J'' on their tangents
  Eigen::MatrixXd J() const {
    Eigen::MatrixXd J = system.entries();
    J.diagonal().tail(part.hessian.size()) += part.hessian;
    for (Index c = 0; c < part.hessian.size(); ++c) {
      if (part.free[c]) continue;
      const Index i = system.interior() + c;
      J.row(i).setZero();
      J.col(i).setZero();
      J(i, i) = system.D[i];
    }
    return J;
  }
};

std::unique_ptr<Preconditioner> multigrid(const System& system) {
  return make_preconditioner(system, Precon::multigrid, 1);
}

}  // namespace

TEST(MultigridPreconditioner, IsCloseToTheInverseOnTheFreeFaceAndZeroWhereHeld) {
  for (int cells : {3, 7}) {  // one level, and several
    const OnAFace f(cells);
    const auto P = multigrid(f.system);
    P->start(f.r);
    P->set_contact(f.r_C(), f.part);
    Vector z = Vector::Zero(f.system.dofs());
    P->direction(0, z);
    for (Index c = 0; c < f.system.contact_dofs(); ++c)
      EXPECT_TRUE(f.part.free[c] || z[f.system.interior() + c] == 0) << c;
    const Vector exact = f.J().ldlt().solve(f.r), away = z - exact;
    EXPECT_LT(std::sqrt(away.dot(f.J() * away) / exact.dot(f.r)), 0.5) << cells;
    EXPECT_NEAR(P->r_z(), f.r.dot(z), 1e-12 * P->r_z());
    EXPECT_NEAR(P->r_v(z), f.r.dot(z), 1e-12 * P->r_z());
    EXPECT_NEAR(P->free_norm(), norm_D(f.system, f.r), 1e-12 * P->free_norm());
    const Curvature k = P->curvature(z);
    EXPECT_NEAR(k.A, z.dot(f.system.entries() * z), 1e-9 * k.D);
    EXPECT_NEAR(k.D, z.dot(f.system.D.cwiseProduct(z)), 1e-12 * k.D);
  }
}

TEST(MultigridPreconditioner, KeepsResidualsAndProductsWhileXAndFacesChange) {
  OnAFace f(7);
  const auto P = multigrid(f.system);
  P->start(f.r);
  P->set_contact(f.r_C(), f.part);
  const Index interior = f.system.interior(), m = f.system.contact_dofs();
  Vector v = Vector::Zero(f.system.dofs()), x = v, r = f.r;
  for (int step = 0; step < 3; ++step) {
    const Vector before = v;
    P->direction(0.5, v);
    P->curvature(v);
    const Real r_z = P->r_z();
    P->advance(0.1, v, x);
    EXPECT_EQ(P->r_z(), r_z);  // of the last set_contact
    const Vector r_before = r;
    r -= 0.1 * (f.system.entries() * v);
    if (step == 1) {
      Vector dx = Vector::Zero(f.system.dofs());
      dx[interior + 13] = 1e-3;
      P->move_contact(dx.tail(m));
      r -= f.system.entries() * dx;
      f.part.free[14] = 0;
    }
    for (Index c = 0; c < m; ++c)
      if (!f.part.free[c]) r[interior + c] = 0;
    P->set_contact(r.tail(m), f.part);
    // what is made anew from r is the same
    const auto fresh = multigrid(f.system);
    fresh->start(r);
    fresh->set_contact(r.tail(m), f.part);
    Vector z = Vector::Zero(r.size()), same = z;
    fresh->direction(0, z);
    P->direction(0, same);
    EXPECT_LT((same - z).norm(), 1e-5 * z.norm()) << step;
    EXPECT_NEAR(P->r_z(), r.dot(same), 1e-9 * P->r_z());
    if (step != 1) {
      EXPECT_NEAR(P->dr_z(), (r - r_before).dot(same), 1e-9 * r.norm() * same.norm());
    }
    EXPECT_NEAR(P->free_norm(), norm_D(f.system, r), 1e-9 * P->free_norm());
  }
}

TEST(MultigridPreconditioner, GivesTheSameAnswerInFarFewerIterationsThanSsor) {
  const SparseScene scene = sparse_block(cube_of(20));
  const Posed posed = scene.system(scene.node_of_dof);
  for (const auto& [method, share] : {std::pair{Method::gcx, 0.25}, {Method::gc3, 0.5}}) {
    const Solution ssor = by(method, Precon::hessian_ssor, posed);
    const Solution multigrid = by(method, Precon::multigrid, posed);
    EXPECT_EQ(multigrid.status, Status::converged) << int(method);
    EXPECT_EQ(multigrid.layer, method == Method::gcx ? Layer::gcx : Layer::gc);
    EXPECT_LT((multigrid.x - ssor.x).norm(), 1e-6 * ssor.x.norm());
    EXPECT_LT(multigrid.iterations, share * ssor.iterations) << int(method);
  }
}

TEST(MultigridPreconditioner, IsRefusedByNameWhereNoHierarchyCanBeMade) {
  const SparseScene scene = sparse_block(cube_of(3));
  const Posed unknown = scene.system();
  EXPECT_TRUE(names(refusal([&] { by(Method::gcx, Precon::multigrid, unknown); }),
                    "precon=\"multigrid\" needs"));
  Settings settings;
  settings.newton = false;
  settings.precon = Precon::multigrid;
  EXPECT_THROW(validate(settings), IllegalInput);
}
