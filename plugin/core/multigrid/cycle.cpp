#include "linear_algebra.h"
#include "multigrid/hierarchy_of.h"
#include "multigrid/smoother.h"

namespace frictioncg {

template <int D, int K>
void HierarchyOf<D, K>::solve_coarsest(Coarse& level) {
  LevelBorder<K>& q = level.border;
  if (coarsest_.factored()) {
    const Eigen::Index rows = level.A.rows();
    const auto slots = [&](std::vector<float>& v) {
      return Eigen::Map<Eigen::MatrixXf, 0, Eigen::OuterStride<stride<K>>>(v.data(), K, rows);
    };
    x_.head(rows * K).reshaped(K, rows) = slots(level.r).template cast<Real>();
    x_.tail(q.r.size()) = q.r;
    coarsest_.solve(x_);
    slots(level.z) = x_.head(rows * K).reshaped(K, rows).template cast<float>();
    q.z = x_.tail(q.z.size());
    return;
  }
  level.work = level.r;
  sweep_forward(level.A, level.work.data(), level.z.data());
  level.work = level.r;
  if (S_.size() > 0) {
    q.subtract_transposed(level.z.data(), q.r);
    q.z = solve(S_, q.r);
    q.subtract(q.z, level.work.data());
  }
  sweep_backward(level.A, level.work.data(), level.z.data());
}

/// coarse.z from coarse.r: exact on the coarsest level, elsewhere by two cycles.
template <int D, int K>
void HierarchyOf<D, K>::correct(std::size_t next) {
  Coarse& coarse = coarse_[next];
  if (next + 1 == coarse_.size()) {
    solve_coarsest(coarse);
    return;
  }
  LevelBorder<K>& q = coarse.border;
  cycle(coarse, next + 1);
  coarse.r.swap(coarse.first_r);
  coarse.z.swap(coarse.first_z);
  q.r.swap(q.first_r);
  q.z.swap(q.first_z);
  subtract_product(coarse.A, coarse.first_r.data(), coarse.first_z.data(), coarse.r.data());
  q.subtract(q.first_z, coarse.r.data());
  q.r = q.first_r - S_.lazyProduct(q.first_z);
  q.subtract_transposed(coarse.first_z.data(), q.r);
  cycle(coarse, next + 1);
  q.z += q.first_z;
  for (std::size_t k = 0; k < coarse.z.size(); ++k) coarse.z[k] += coarse.first_z[k];
}

/// level.z from level.r: two sweeps, correction from the level next, two sweeps.
template <int D, int K>
template <int B>
void HierarchyOf<D, K>::cycle(Level<B, K>& level, std::size_t next) {
  level.residual = level.r;
  sweep_forward(level.A, level.residual.data(), level.z.data());
  sweep_forward(level.A, level.residual.data(), level.work.data());
  for (std::size_t k = 0; k < level.z.size(); ++k) level.z[k] += level.work[k];
  restrict_to(level.P, level.residual.data(), coarse_[next].r);
  coarse_[next].border.r = level.border.r;
  level.border.subtract_transposed(level.z.data(), coarse_[next].border.r);
  correct(next);
  prolong(level.P, coarse_[next].z.data(), level.z.data());
  level.border.z = coarse_[next].border.z;
  for (int sweep = 0; sweep < 2; ++sweep) {
    level.work = level.r;
    level.border.subtract(level.border.z, level.work.data());
    sweep_backward(level.A, level.work.data(), level.z.data());
  }
}

template <int D, int K>
void HierarchyOf<D, K>::apply(const Vector& r, Vector& z) {
  const Real size = r.lpNorm<Eigen::Infinity>();
  z.resize(r.size());
  if (!(size > 0)) {
    z.setZero();
    return;
  }
  // to order 1 and back: single precision keeps its range
  const Eigen::Index k = S_.cols();
  const auto at = [this](Index p) {
    const std::size_t slot = blocks_.slot[p];
    return slot / D * stride<D> + slot % D;
  };
  for (Index p = 0; p < blocks_.dofs(); ++p) fine_.r[at(p)] = static_cast<float>(r[p] / size);
  fine_.border.r = r.tail(k) / size;
  cycle(fine_, 0);
  for (Index p = 0; p < blocks_.dofs(); ++p) z[p] = size * scale_ * fine_.z[at(p)];
  z.tail(k) = size * scale_ * fine_.border.z;
}

template void HierarchyOf<2, 3>::apply(const Vector&, Vector&);
template void HierarchyOf<3, 6>::apply(const Vector&, Vector&);

}  // namespace frictioncg
