#pragma once
// Contact problems on the contact dofs alone, written down by hand: S is the whole matrix.
#include "core/condensed/condensed_problem.h"

namespace frictioncg::test {

/// m nodes of d dofs each, the normal first; S: m d square, f: m d. No gap; mu = 0 until it is set.
class ByHand {
 public:
  ByHand(int d, const DenseMatrix& S, const Vector& f) : S_(S), f_(f) {
    auto system = std::make_shared<AssembledSystem>();
    const Index n = static_cast<Index>(f.size());
    system->dimension = d;
    system->A = S.sparseView();
    system->D = S.diagonal().cwiseMax(1e-3 * S.diagonal().maxCoeff());
    for (Index first = 0; first <= n; first += d) system->first.push_back(first);
    system->weight = node_weights(*system);
    problem.system = system;
    problem.increment.F = f;
    problem.increment.gap = Vector::Zero(n / d);
    problem.increment.law = Law::coulomb;
    problem.increment.mu = Vector::Zero(n / d);
    problem.increment.load_norm = problem.increment.force_scale = norm_D(*system, f);
  }
  ByHand& mu(Real value) {
    problem.increment.mu.setConstant(value);
    return *this;
  }
  ByHand& given(Real g) {
    problem.increment.law = Law::tresca;
    problem.increment.g = Vector::Constant(problem.nodes(), g);
    return *this;
  }
  ByHand& gap(Real value) {
    problem.increment.gap.setConstant(value);
    return *this;
  }
  ByHand& bilateral() {
    problem.increment.bilateral = true;
    return *this;
  }
  CondensedProblem condensed(Real springs = 0) const {
    return {S_, f_, problem.system->weight, problem, springs};
  }

  ContactProblem problem;

 private:
  DenseMatrix S_;
  Vector f_;
};

/// A vector from its entries.
inline Vector vec(std::initializer_list<Real> entries) {
  Vector v(static_cast<Index>(entries.size()));
  std::copy(entries.begin(), entries.end(), v.data());
  return v;
}

inline DenseMatrix diag(std::initializer_list<Real> entries) { return vec(entries).asDiagonal(); }

}  // namespace frictioncg::test
