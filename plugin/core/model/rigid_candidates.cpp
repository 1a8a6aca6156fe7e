#include "model/rigid_candidates.h"

#include "linear_algebra.h"

namespace frictioncg {

Matrix rigid_candidates(const System& system) {
  Matrix made(system.dofs(), 0);  // returned in place: Eigen leaks a copy where memory runs out
  if (!(system.body_modes || system.rigid_modes) || system.largest(system.dofs()) == 0) return made;
  if (system.body_modes)
    made = system.body_modes();
  else
    made = system.rigid_modes().sparseView();
  const bool of_use = made.rows() == system.dofs() && made.coeffs().allFinite();
  if (system.largest(of_use ? 0 : 1) > 0) made.resize(system.dofs(), 0);  // on all processes alike
  return made;
}

RigidCandidates::RigidCandidates(const System& of_system)
    : M(rigid_candidates(of_system)), system_(of_system) {
  if (count() == 0) return;
  bodies = system_.bodies();
  std::vector<Real> pairs;  // body k + candidate
  std::vector<Index> last(count(), -1);
  for (Index i = 0; i < M.rows(); ++i)
    for (Matrix::InnerIterator m(M, i); m; ++m)
      if (std::exchange(last[m.col()], bodies.of[i]) != bodies.of[i])
        pairs.push_back(Real(bodies.of[i]) * count() + m.col());
  const Vector all = system_.gathered(Eigen::Map<const Vector>(pairs.data(), Index(pairs.size())));
  pairs.assign(all.begin(), all.end());
  sort_once(pairs);
  of_body.resize(bodies.count);
  for (Real pair : pairs) of_body[Index(pair / count())].push_back(Index(std::fmod(pair, count())));
}

void RigidCandidates::sum(std::vector<DenseMatrix>& of_bodies) const {
  std::vector<Real> all;
  for (const DenseMatrix& own : of_bodies)
    all.insert(all.end(), own.data(), own.data() + own.size());
  system_.sum(all.data(), Index(all.size()));
  const Real* from = all.data();
  for (DenseMatrix& own : of_bodies) {
    std::copy_n(from, own.size(), own.data());
    from += own.size();
  }
}

std::vector<DenseMatrix> RigidCandidates::gram(
    const std::function<void(const Visit&)>& for_each) const {
  std::vector<DenseMatrix> sums;
  for (const std::vector<Index>& own : of_body)
    sums.push_back(DenseMatrix::Zero(Index(own.size()), Index(own.size())));
  for_each([&](Index i, Index j, Real value) {
    const Index body = bodies.of[i], to = place(body, j);
    if (to < 0) return;  // a zero that is stored, or what rounding leaves between bodies
    for (Matrix::InnerIterator m(M, i); m; ++m)
      sums[body](place(body, Index(m.col())), to) += m.value() * value;
  });
  sum(sums);
  return sums;
}

std::vector<DenseMatrix> RigidCandidates::gram_in(const Vector& diagonal) const {
  return gram([&](const Visit& visit) {
    for (Index i = 0; i < diagonal.size(); ++i)
      for (Matrix::InnerIterator m(M, i); m; ++m) visit(i, Index(m.col()), diagonal[i] * m.value());
  });
}

Vector RigidCandidates::nearest_to(const Vector& w) const {
  std::vector<DenseMatrix> mixed;  // one column each
  for (const std::vector<Index>& own : of_body) mixed.push_back(Vector::Zero(Index(own.size())));
  const auto for_each = [&](const auto& visit) {
    for (Index i = 0; i < w.size(); ++i)
      for (Matrix::InnerIterator m(M, i); m; ++m)
        visit(i, m.value(), mixed[bodies.of[i]](place(bodies.of[i], Index(m.col()))));
  };
  for_each([&](Index i, Real value, Real& of) { of += value * w[i]; });
  sum(mixed);
  const std::vector<DenseMatrix> size = gram_in(Vector::Ones(w.size()));
  for (std::size_t body = 0; body < size.size(); ++body)
    mixed[body] = least_squares(size[body], mixed[body]);
  Vector nearest = Vector::Zero(w.size());
  for_each([&](Index i, Real value, Real& of) { nearest[i] += value * of; });
  return nearest;
}

}  // namespace frictioncg
