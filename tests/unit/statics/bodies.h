#pragma once
// Blocks as contact problems, one or several side by side that share nothing; scenes on their
// contact dofs.
#include <gtest/gtest.h>

#include "../scene.h"
#include "core/condensed/elimination.h"
#include "core/condensed/condensed_problem.h"
#include "core/model/certificate.h"

namespace frictioncg::test {

inline ContactProblem problem_of(const BlockOptions& o) { return block(o).system().problem(); }

/// `bodies` copies of a problem with the same laws: their interiors first, then their contact
/// nodes.
inline ContactProblem beside(const ContactProblem& one, int bodies) {
  const Index n = one.dofs(), I = one.interior(), C = one.contact_dofs();
  const auto place = [I, C, bodies](Index i, int body) {
    return i < I ? i + body * I : bodies * I + (i - I) + body * C;
  };
  const auto system = std::make_shared<AssembledSystem>();
  system->dimension = one.system->dimension;
  std::vector<Eigen::Triplet<Real>> t;
  for (int body = 0; body < bodies; ++body) {
    for (Index i = 0; i < n; ++i)
      for (Matrix::InnerIterator e(one.system->entries(), i); e; ++e)
        t.emplace_back(place(i, body), place(Index(e.col()), body), e.value());
    for (Index k = 0; k < one.nodes(); ++k)
      system->first.push_back(place(one.system->first[k], body));
  }
  system->first.push_back(bodies * n);
  system->A.resize(bodies * n, bodies * n);
  system->A.setFromTriplets(t.begin(), t.end());
  system->D = system->A.diagonal();
  system->weight = node_weights(*system);
  if (one.system->rigid_modes)
    system->rigid_modes = [=] {
      const Eigen::MatrixXd M = one.system->rigid_modes();
      Eigen::MatrixXd modes(bodies * n, M.cols());
      for (int body = 0; body < bodies; ++body)
        for (Index i = 0; i < n; ++i) modes.row(place(i, body)) = M.row(i);
      return modes;
    };
  ContactProblem all{system, one.increment};
  Increment& increment = all.increment;
  increment.F.resize(bodies * n);
  for (int body = 0; body < bodies; ++body)
    for (Index i = 0; i < n; ++i) increment.F[place(i, body)] = one.increment.F[i];
  increment.gap = one.increment.gap.replicate(bodies, 1);
  increment.mu = one.increment.mu.replicate(bodies, 1);
  increment.g = one.increment.g.replicate(bodies, 1);
  increment.load_norm *= std::sqrt(bodies);
  increment.force_scale *= std::sqrt(bodies);
  return all;
}

/// A scene on its contact dofs, with all that the condensed problem refers to.
struct OnContact {
  explicit OnContact(const Scene& s) : posed(s.system()) {
    EXPECT_EQ(elimination.factor(*posed.problem().system, 1e9), Elimination::Outcome::done);
  }
  CondensedProblem problem() {
    const ContactProblem& p = posed.problem();
    return {elimination.S(), elimination.condense(p.increment.F),
            p.system->weight.tail(p.contact_dofs()), p};
  }
  Real residual(const Vector& x_C) {
    return certify(posed.problem(), elimination.recover(x_C)).residual;
  }
  Posed posed;
  Elimination elimination;
};

}  // namespace frictioncg::test
