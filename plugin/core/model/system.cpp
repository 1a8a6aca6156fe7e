#include "model/system.h"
#include "model/validate.h"

namespace frictioncg {

bool costs_no_energy(const System& system, const Vector& w) {
  Vector Aw;
  system.multiply(w, Aw);
  Real in[] = {w.dot(Aw), w.dot(system.D.cwiseProduct(w))};
  system.sum(in, 2);
  return costs_no_energy(in[0], in[1]);
}

bool costs_negative_energy(const System& system, const Vector& p) {
  // assembly leaves some units of rounding, and conjugate gradients on nearly free bodies meet such
  // directions where contact cannot hold them
  constexpr Real beyond_rounding = 1000;
  if (system.largest(p.size()) == 0) return false;
  Vector Ap;
  const Vector sizes = system.multiply_sized(p, Ap);
  const Real energy = system.sum(p.dot(Ap)), size = system.sum(p.cwiseAbs().dot(sizes));
  return energy < -beyond_rounding * epsilon * size;
}

Groups::Groups(Index n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

Index Groups::of(Index i) {
  while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
  return i;
}

/// Under the lower number, which neighbours in a mesh share: trees stay flat.
void Groups::join(Index i, Index j) {
  if (parent_[i] == parent_[j]) return;
  const Index p = of(i), q = of(j);
  parent_[std::max(p, q)] = std::min(p, q);
}

bool same_dofs(const System& one, const System& other) {
  return one.dimension == other.dimension && one.first == other.first &&
         one.mesh_node == other.mesh_node && one.border.cols() == other.border.cols();
}

bool same_pattern(const System& one, const System& other) {
  const Matrix &A = one.entries(), &B = other.entries();
  return same_dofs(one, other) && A.nonZeros() == B.nonZeros() &&
         std::equal(A.outerIndexPtr(), A.outerIndexPtr() + A.rows() + 1, B.outerIndexPtr()) &&
         std::equal(A.innerIndexPtr(), A.innerIndexPtr() + A.nonZeros(), B.innerIndexPtr());
}

void System::product(const Matrix& M, const VisitRow& visit) const {
  const Index k = static_cast<Index>(M.cols());
  DenseMatrix AM(M.rows(), k);
  Vector column;
  for (Index j = 0; j < k; ++j) {
    multiply(M * Vector::Unit(k, j), column);
    AM.col(j) = column;
  }
  std::vector<Index> columns;
  for (Index i = 0; i < static_cast<Index>(AM.rows()); ++i) {
    columns.clear();
    for (Index j = 0; j < k; ++j)
      if (AM(i, j) != 0) columns.push_back(j);
    visit(i, columns, AM.row(i));
  }
}

void AssembledSystem::multiply(const Vector& x, Vector& Ax) const { Ax.noalias() = A * x; }

/// Of so many columns, the motions of one body, all are summed up: telling those that are 0 takes
/// longer.
constexpr Index few_columns = 6;

void AssembledSystem::product(const Matrix& M, const VisitRow& visit) const {
  const auto [row, col, a] = arrays_of(A);
  const auto [begin, at, m] = arrays_of(M);
  Vector sum = Vector::Zero(M.cols());
  std::vector<Index> columns(M.cols()), seen(M.cols(), -1);
  if (M.cols() <= few_columns) {
    std::iota(columns.begin(), columns.end(), 0);
    for (Index i = 0; i < A.rows(); ++i) {
      sum.setZero();
      for (Index k = row[i]; k < row[i + 1]; ++k)
        for (Index q = begin[col[k]]; q < begin[col[k] + 1]; ++q) sum[at[q]] += a[k] * m[q];
      visit(i, columns, sum);
    }
    return;
  }
  for (Index i = 0; i < A.rows(); ++i) {
    columns.clear();
    for (Index k = row[i]; k < row[i + 1]; ++k)
      for (Index q = begin[col[k]]; q < begin[col[k] + 1]; ++q) {
        const Index j = at[q];
        if (std::exchange(seen[j], i) != i) {
          columns.push_back(j);
          sum[j] = 0;
        }
        sum[j] += a[k] * m[q];
      }
    visit(i, columns, sum);
  }
}

Vector AssembledSystem::multiply_sized(const Vector& x_in, Vector& Ax) const {
  if (x_in.isZero(0)) return Ax = Vector::Zero(A.rows());  // rest, a start of every increment
  Ax.resize(A.rows());
  Vector size(A.rows());
  const auto [row, col, a] = arrays_of(A);
  const Real* x = x_in.data();
  for (Index i = 0; i < A.rows(); ++i) {
    Real sum = 0, sum_of_sizes = 0;
    for (Index k = row[i]; k < row[i + 1]; ++k) {
      const Real product = a[k] * x[col[k]];
      sum += product;
      sum_of_sizes += std::abs(product);
    }
    Ax[i] = sum;
    size[i] = sum_of_sizes;
  }
  return size;
}

void AssembledSystem::move_contact(const Vector& dx_C, Vector& r) const {
  for (Index c = 0; c < dx_C.size(); ++c) {
    if (dx_C[c] == 0) continue;
    for (Matrix::InnerIterator a(A, interior() + c); a; ++a) r[a.col()] -= a.value() * dx_C[c];
  }
}

Bodies bodies_of(const Matrix& A) {
  const Index n = static_cast<Index>(A.rows());
  Groups groups(n);
  for (Index i = 0; i < n; ++i)
    for (Matrix::InnerIterator e(A, i); e && e.col() < i; ++e)
      if (e.value() != 0) groups.join(i, static_cast<Index>(e.col()));
  Bodies bodies{std::vector<Index>(n), 0};
  for (Index i = 0; i < n; ++i)  // a root comes before the dofs it stands for
    bodies.of[i] = groups.of(i) == i ? bodies.count++ : bodies.of[groups.of(i)];
  return bodies;
}

namespace {

/// Over the usual stiffness: supports below hide nothing that tol asks for.
constexpr Real penalty = 1e6;
/// A support resists a rigid motion by more than this share of its diagonal, rounding of what a
/// body's stiffness sums up to by less.
constexpr Real resists = 1e-8;
/// Of the geometric mean of two diagonals: the couplings of a trace's mass.
constexpr Real coupled = 1e-3;

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

/// Marks those of the stiff dofs that supports hold: rigid motions are resisted there, or beside
/// them where the rows of a trace's mass sum up to 0. No candidates for motions: none is told.
std::vector<char> supported(const System& system, const std::vector<Index>& stiff) {
  std::vector<char> found(system.dofs(), 0);
  const DenseMatrix M = system.rigid_modes ? system.rigid_modes() : DenseMatrix();
  if (M.rows() != system.dofs() || !M.allFinite()) return found;
  for (Index k : stiff) {
    const Eigen::RowVectorXd resisted = system.entries().row(k) * M;
    found[k] = resisted.cwiseAbs().maxCoeff() > resists * system.D[k];
  }
  std::vector<char> beside = found;
  for (Index k : stiff)
    for (Matrix::InnerIterator a(system.entries(), k); a && !beside[k]; ++a)
      beside[k] = found[a.col()] &&
                  std::abs(a.value()) > coupled * std::sqrt(system.D[k] * system.D[a.col()]);
  return beside;
}

/// One stiffness per mesh node, spread over its dofs.
Vector node_stiffness(const System& system) {
  Vector stiffness = system.D;
  for (Index i = 0; i < system.nodes(); ++i) {
    const Index T = system.first[i] + 1, t = system.tangents(i);
    if (t > 0) stiffness.segment(T, t).setConstant(system.D.segment(T, t).mean());
  }
  if (!system.mesh_node.empty()) take_means(system, stiffness);
  return stiffness;
}

/// The dofs that penalties hold, and the stiffness from which on they do.
struct Penalties {
  std::vector<Index> dofs;
  Real most = 0;
};
Penalties penalties(const System& system, const Vector& stiffness) {
  Penalties found;
  if (stiffness.size() == 0 || stiffness.maxCoeff() <= penalty * stiffness.minCoeff()) return found;
  found.most = penalty * std::max(median(stiffness), median(stiffness.tail(system.contact_dofs())));
  std::vector<Index> stiff;
  for (Index k = 0; k < system.dofs(); ++k)
    if (stiffness[k] > found.most) stiff.push_back(k);
  if (stiff.empty()) return found;
  const std::vector<char> held = supported(system, stiff);
  for (Index k : stiff)
    if (held[k]) found.dofs.push_back(k);
  return found;
}

}  // namespace

Vector node_weights(const System& system) {
  Vector weight = node_stiffness(system);
  const Penalties held = penalties(system, weight);
  for (Index k : held.dofs) weight[k] = std::min(weight[k] * (weight[k] / held.most), largest);
  return weight;
}

std::vector<LostPenalty> lost_penalties(const System& system) {
  constexpr Real lost = 1e4;         // over where penalties begin: a hundred times more costs 7 %
  constexpr Real force_lost = 1e12;  // likewise: forces of 500 times more have left their cones
  constexpr Real along_an_axis = 1e-6;
  const std::vector<Index>& node = system.mesh_node;
  std::vector<LostPenalty> all;
  if (node.empty()) return all;
  const Penalties found = penalties(system, node_stiffness(system));
  for (Index k : found.dofs) {
    if (system.D[k] < lost * found.most) continue;
    bool aslant = false;
    for (Matrix::InnerIterator a(system.entries(), k); a; ++a) {
      const Index l = static_cast<Index>(a.col());
      const Real both = system.D[k] * system.D[l], square = a.value() * a.value();
      aslant |= l != k && node[k] == node[l] && both - square < along_an_axis * both;
    }
    if (aslant || (k >= system.interior() && system.D[k] > force_lost * found.most))
      all.push_back({k, aslant});
  }
  return all;
}

Real contrast(const System& system) {
  Vector stiffness = node_stiffness(system);
  if (stiffness.size() == 0) return 1;
  const Real least = stiffness.minCoeff();
  for (Index k : penalties(system, stiffness).dofs) stiffness[k] = least;
  return stiffness.maxCoeff() / least;
}

}  // namespace frictioncg
