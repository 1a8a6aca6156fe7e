#include <gtest/gtest.h>

#include <Eigen/LU>

#include "core/gradient/preconditioner.h"
#include "../scene.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

struct Case {
  ContactProblem p;
  ContactPart part;
  Vector r;  // zero where held
  Eigen::MatrixXd A_free;
  Case() {
    BlockOptions o;
    o.cells = 4;
    o.angle = 0.2;
    o.distortion = 0.2;
    p = block(o).system().problem();
    part.free.assign(p.contact_dofs(), 1);
    part.free[0] = part.free[3] = part.free[4] = 0;
    part.hessian = Vector::Random(p.contact_dofs()).cwiseAbs() * 1e4;
    r = Vector::Random(p.dofs());
    A_free = p.system->entries();
    for (Index c = 0; c < p.contact_dofs(); ++c)
      if (!part.free[c]) {
        const Index i = p.interior() + c;
        r[i] = 0;
        A_free.row(i).setZero();
        A_free.col(i).setZero();
        A_free(i, i) = 1;
      }
  }
  Vector r_C() const { return r.tail(p.contact_dofs()); }
  /// C of (16) on the free subspace
  Eigen::MatrixXd C(Precon kind, Real omega) const {
    Eigen::MatrixXd D = A_free.diagonal().asDiagonal();
    if (kind == Precon::none) return Eigen::MatrixXd::Identity(p.dofs(), p.dofs());
    if (kind == Precon::hessian_diagonal || kind == Precon::hessian_ssor)
      for (Index c = 0; c < p.contact_dofs(); ++c)
        if (part.free[c]) D(p.interior() + c, p.interior() + c) += part.hessian[c];
    if (kind == Precon::diagonal || kind == Precon::hessian_diagonal) return D;
    const Eigen::MatrixXd E = A_free.triangularView<Eigen::StrictlyLower>();
    return (D + omega * E) * D.inverse() * (D + omega * E).transpose() / (omega * (2 - omega));
  }
};

const Precon all_precons[] = {Precon::none, Precon::diagonal, Precon::ssor,
                              Precon::hessian_diagonal, Precon::hessian_ssor};

}  // namespace

TEST(Preconditioner, DirectionIsTheSolutionOfEquation15OnTheFreeSubspace) {
  const Case c;
  for (Precon kind : all_precons)
    for (Real omega : {1.0, 1.4}) {
      const auto P = make_preconditioner(*c.p.system, kind, omega);
      P->start(c.r);
      P->set_contact(c.r_C(), c.part);
      Vector v = Vector::Zero(c.p.dofs());
      P->direction(0, v);
      const Vector z = c.C(kind, omega).lu().solve(c.r);
      EXPECT_LT((v - z).norm(), 1e-11 * z.norm()) << int(kind);
      EXPECT_NEAR(P->r_z(), c.r.dot(z), 1e-10 * c.r.dot(z));
      EXPECT_NEAR(P->r_v(v), c.r.dot(v), 1e-10 * c.r.dot(v));
      EXPECT_NEAR(P->free_norm(), norm_D(*c.p.system, c.r), 1e-10);
      const Curvature k = P->curvature(v);
      EXPECT_NEAR(k.A, v.dot(c.p.system->entries() * v), 1e-8 * k.D);
      EXPECT_NEAR(k.D, (c.p.system->D.array() * v.array().square()).sum(), 1e-10 * k.D);
    }
}

TEST(Preconditioner, AnIterationKeepsResidualsAndProductsExactWhileTheHessianChanges) {
  const Case c;
  for (Precon kind : all_precons) {
    const auto P = make_preconditioner(*c.p.system, kind, 1.2);
    P->start(c.r);
    P->set_contact(c.r_C(), c.part);
    Vector v = Vector::Zero(c.p.dofs()), r = c.r;
    ContactPart part = c.part;
    Case now = c;
    for (Real rho : {0.3, 0.7, 0.2}) {
      const Vector v_before = v;
      P->direction(0.5, v);
      const Vector expected = now.C(kind, 1.2).lu().solve(r) + 0.5 * v_before;
      EXPECT_LT((v - expected).norm(), 1e-10 * expected.norm()) << int(kind);
      EXPECT_NEAR(P->r_v(v), r.dot(v), 1e-9 * r.norm() * v.norm());
      EXPECT_NEAR(P->curvature(v).A, v.dot(c.p.system->entries() * v), 1e-9 * P->curvature(v).D);
      Vector x = c.r;
      P->advance(rho, v, x);
      EXPECT_LT((x - c.r - rho * v).norm(), 1e-14 * c.r.norm());
      const Vector r_before = r;
      r -= rho * (c.p.system->entries() * v);
      part.hessian *= 1.5;
      now.part = part;
      for (Index k = 0; k < c.p.contact_dofs(); ++k) {
        Real& r_k = r[c.p.interior() + k];
        r_k = part.free[k] ? r_k + 0.01 * k : 0;  // what friction would change
      }
      P->set_contact(r.tail(c.p.contact_dofs()), part);
      const Vector z = now.C(kind, 1.2).lu().solve(r);
      EXPECT_NEAR(P->r_z(), r.dot(z), 1e-9 * r.dot(z));
      EXPECT_NEAR(P->dr_z(), (r - r_before).dot(z), 1e-9 * r.dot(z));
    }
  }
}

TEST(Preconditioner, AMoveOfContactDofsReachesTheInteriorResidual) {
  const Case c;
  for (Precon kind : all_precons) {
    const auto P = make_preconditioner(*c.p.system, kind, 1.3);
    P->start(c.r);
    P->set_contact(c.r_C(), c.part);
    Vector v = Vector::Zero(c.p.dofs());
    P->direction(0, v);
    P->curvature(v);
    const Index interior = c.p.interior();
    const Vector dx_C = 1e-3 * Vector::Random(c.p.contact_dofs());
    Vector dx = Vector::Zero(c.p.dofs()), r = c.r;
    dx.tail(c.p.contact_dofs()) = dx_C;
    P->move_contact(dx_C);
    r.head(interior) -= (c.p.system->entries() * dx).head(interior);
    P->set_contact(c.r_C(), c.part);
    P->direction(0, v);
    const Vector z = c.C(kind, 1.3).lu().solve(r);
    EXPECT_LT((v - z).norm(), 1e-11 * z.norm()) << int(kind);
    EXPECT_NEAR(P->r_z(), r.dot(z), 1e-10 * r.dot(z));
    EXPECT_NEAR(P->free_norm(), norm_D(*c.p.system, r), 1e-10 * P->free_norm());
  }
}
