#include "model/system.h"
#include "model/validate.h"

#include <algorithm>
#include <cmath>

namespace frictioncg {

bool costs_no_energy(const System& system, const Vector& w) {
  Vector Aw;
  system.multiply(w, Aw);
  Real in[] = {w.dot(Aw), w.dot(system.D.cwiseProduct(w))};
  system.sum(in, 2);
  return costs_no_energy(in[0], in[1]);
}

void System::multiply(const Vector& x, Vector& Ax) const {
  if (processes)
    processes->multiply(x, Ax);
  else
    Ax.noalias() = A * x;
}

Vector System::magnitude(const Vector& x) const {
  return processes ? processes->magnitude(x) : frictioncg::magnitude(A, x);
}

Vector magnitude(const Matrix& A, const Vector& x) {
  Vector sum = Vector::Zero(A.rows());
  for (Index i = 0; i < A.rows(); ++i)
    for (Matrix::InnerIterator e(A, i); e; ++e) sum[i] += std::abs(e.value() * x[e.col()]);
  return sum;
}

namespace {

/// Over the usual stiffness: contrasts of materials stay below, what is above is a penalty.
constexpr Real penalty = 1e10;

Real median(Vector values) {
  if (values.size() == 0) return 0;
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// One stiffness per mesh node of the interior.
void take_means(const System& system, Vector& weight) {
  const auto end = system.mesh_node.begin() + system.interior();
  const auto last = std::max_element(system.mesh_node.begin(), end);
  const Index size = last == end ? 0 : *last + 1;
  Vector sum = Vector::Zero(size), count = Vector::Zero(size);
  for (Index k = 0; k < system.interior(); ++k) {
    sum[system.mesh_node[k]] += system.D[k];
    count[system.mesh_node[k]] += 1;
  }
  for (Index k = 0; k < system.interior(); ++k)
    weight[k] = sum[system.mesh_node[k]] / count[system.mesh_node[k]];
}

}  // namespace

Vector node_weights(const System& system) {
  Vector weight = system.D;
  for (Index i = 0; i < system.nodes(); ++i) {
    const Index T = system.first[i] + 1, t = system.tangents(i);
    if (t > 0) weight.segment(T, t).setConstant(system.D.segment(T, t).mean());
  }
  if (!system.mesh_node.empty()) take_means(system, weight);
  const Real most = penalty * std::max(median(weight), median(weight.tail(system.contact_dofs())));
  for (Real& w : weight.head(system.interior()))
    if (w > most) w = std::min(w * (w / most), largest);
  return weight;
}

}  // namespace frictioncg
