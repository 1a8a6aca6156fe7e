#include "statics/floating.h"

#include "linear_algebra.h"

namespace frictioncg {

namespace {

constexpr Real dependent = 1e-13;    ///< of the largest <Dw,w>: a candidate that the others make up
constexpr Real nearly_rigid = 1e-6;  ///< <Aw,w>/<Dw,w>, with what rounding leaves of small bodies
/// What is left of a motion beside rigid ones, over all of it: rounding makes 1e-8, and the bending
/// of a body that its supports hold a tenth and more.
constexpr Real bent = 1e-3;
constexpr Real still = 1e-10;  ///< over the largest displacement: what does not move

/// The motions of one body: combinations (k x j) of the candidates, from their Gram matrices in A
/// and D. Those nearly in the kernel, <Dw,w> = 1. size_of_all: below its rounding a candidate is 0.
DenseMatrix candidates_of_a_body(const DenseMatrix& in_A, const DenseMatrix& in_D,
                                 Real size_of_all) {
  const Eigenpairs sizes = eigenpairs(in_D);
  const Vector& size = sizes.values;
  const Index k = static_cast<Index>(size.size());
  Index first = 0;
  const Real least = dependent * std::max(size[k - 1], size_of_all);
  while (first < k && !(size[first] > least)) ++first;
  const DenseMatrix V = sizes.vectors.rightCols(k - first) *
                        size.tail(k - first).cwiseSqrt().cwiseInverse().asDiagonal();
  if (V.cols() == 0) return V;
  const Eigenpairs ritz = eigenpairs(V.transpose() * DenseMatrix(in_A * V));
  Index count = 0;
  while (count < V.cols() && ritz.values[count] <= nearly_rigid) ++count;
  return V * ritz.vectors.leftCols(count);
}

/// Makes `rest`, a projector, drop c, too, in the product of D.
void take_out(const Vector& c, const DenseMatrix& in_D, DenseMatrix& rest) {
  const Vector left = rest * c;
  const Real norm2 = left.dot(in_D * left);
  if (norm2 > 0) rest -= left * (left.transpose() * in_D * rest) / norm2;
}

/// Sums over each body's dofs of left_i right_j: one k x k matrix a body, side by side.
DenseMatrix gram(const System& system, const Bodies& bodies, const DenseMatrix& left,
                 const DenseMatrix& right) {
  const Index k = static_cast<Index>(left.cols());
  DenseMatrix sum = DenseMatrix::Zero(k, k * bodies.count);
  for (Index i = 0; i < static_cast<Index>(bodies.of.size()); ++i)
    sum.middleCols(k * bodies.of[i], k).noalias() += left.row(i).transpose() * right.row(i);
  system.sum(sum.data(), static_cast<Index>(sum.size()));
  return sum;
}

/// The candidates of the system; no columns where it knows none, or none of use.
DenseMatrix candidates_of(const System& system) {
  const RigidModes& made = system.body_modes ? system.body_modes : system.rigid_modes;
  DenseMatrix M(system.dofs(), 0);
  if (!made || system.largest(system.dofs()) == 0) return M;
  M = made();
  const bool of_use = M.rows() == system.dofs() && M.allFinite();
  return system.largest(of_use ? 0 : 1) == 0 ? M : DenseMatrix(system.dofs(), 0);  // on all alike
}

/// The rigid ones among combinations of candidates M (n x k). Bodies share no entry of A: one
/// product tries a combination of each.
class RigidMotions {
 public:
  RigidMotions(const System& system, const Bodies& bodies, const DenseMatrix& M)
      : system_(system), bodies_(bodies), M_(M) {}

  /// c: of each body, as columns. accept(body, j): its j-th is a motion.
  template <class Accept>
  void add(const std::vector<DenseMatrix>& c, const Accept& accept) {
    Index most = 0;
    for (const DenseMatrix& of_body : c) most = std::max(most, static_cast<Index>(of_body.cols()));
    for (Index j = 0; j < most; ++j) {
      Vector w = Vector::Zero(M_.rows());
      for (Index i = 0; i < w.size(); ++i)
        if (const DenseMatrix& own = c[bodies_.of[i]]; j < own.cols())
          w[i] = M_.row(i).dot(own.col(j));
      const DenseMatrix size = gram(system_, bodies_, w, system_.D.cwiseProduct(w));
      const DenseMatrix energy = gram(system_, bodies_, w, system_.product(w));
      for (Index body = 0; body < bodies_.count; ++body) {
        if (!(size(body) > 0) || !costs_no_energy(energy(body), size(body))) continue;
        found_.push_back({body, tried_.size(), 1 / std::sqrt(size(body))});
        accept(body, j);
      }
      tried_.push_back(std::move(w));
    }
  }
  /// Body by body.
  DenseMatrix columns() {
    std::stable_sort(found_.begin(), found_.end(),
                     [](const Found& a, const Found& b) { return a.body < b.body; });
    DenseMatrix W = DenseMatrix::Zero(M_.rows(), static_cast<Index>(found_.size()));
    for (Index j = 0; j < W.cols(); ++j)
      for (Index i = 0; i < W.rows(); ++i)
        if (bodies_.of[i] == found_[j].body) W(i, j) = found_[j].scale * tried_[found_[j].tried][i];
    return W;
  }

 private:
  struct Found {
    Index body;
    std::size_t tried;
    Real scale;
  };
  const System& system_;
  const Bodies& bodies_;
  const DenseMatrix& M_;
  std::vector<Vector> tried_;  ///< n
  std::vector<Found> found_;
};

}  // namespace

DenseMatrix floating_motions(const System& system) {
  const DenseMatrix M = candidates_of(system);
  if (M.cols() == 0) return DenseMatrix(system.dofs(), 0);
  const Bodies bodies = system.bodies();
  const DenseMatrix in_A = gram(system, bodies, M, system.product(M));
  const DenseMatrix in_D = gram(system, bodies, M, system.D.asDiagonal() * M);
  const Index k = static_cast<Index>(M.cols()), each = system.dimension == 2 ? 3 : 6;
  RigidMotions motions(system, bodies, M);
  // first those of each candidate's body alone: beside a stiff body that a coupling joins to it in
  // A, what rounding leaves of a soft one would blur them
  std::vector<DenseMatrix> c(bodies.count), rest(bodies.count, DenseMatrix::Identity(k, k));
  for (Index first = 0; first < k && each < k; first += each) {
    const Index size = std::min(each, k - first);
    for (Index body = 0; body < bodies.count; ++body) {
      const DenseMatrix alone =
          candidates_of_a_body(in_A.block(first, body * k + first, size, size),
                               in_D.block(first, body * k + first, size, size), 0);
      c[body] = DenseMatrix::Zero(k, alone.cols());
      c[body].middleRows(first, size) = alone;
    }
    motions.add(c, [&](Index body, Index j) {
      take_out(c[body].col(j), in_D.middleCols(body * k, k), rest[body]);
    });
  }
  // then what is left in common
  for (Index body = 0; body < bodies.count; ++body) {
    const DenseMatrix& R = rest[body];
    const DenseMatrix of_body = in_D.middleCols(body * k, k);
    c[body] = R * candidates_of_a_body(R.transpose() * in_A.middleCols(body * k, k) * R,
                                       R.transpose() * of_body * R, of_body.trace());
  }
  motions.add(c, [](Index, Index) {});
  return motions.columns();
}

/// Of the motions W c those with little beside the candidates:   R c = lambda W'W c,
/// R = W'W - W'M (M'M)^+ M'W, body by body,  lambda <= bent^2. In the product of D soft parts would
/// not count, whose bending is what lets stiff ones move.
DenseMatrix rigid_among(const System& system, const DenseMatrix& W) {
  const Index j = static_cast<Index>(W.cols());
  if (j == 0) return W;
  const DenseMatrix M = candidates_of(system);
  if (M.cols() == 0) return W;
  const Bodies bodies = system.bodies();
  const Index k = static_cast<Index>(M.cols());
  DenseMatrix all(W.rows(), k + j);
  all << M, W;
  DenseMatrix size = DenseMatrix::Zero(j, j), rest = size;
  const DenseMatrix of_bodies = gram(system, bodies, all, all);
  for (Index body = 0; body < bodies.count; ++body) {
    const DenseMatrix G = of_bodies.middleCols(body * (k + j), k + j);
    const DenseMatrix mixed = G.topRightCorner(k, j);
    size += G.bottomRightCorner(j, j);
    rest +=
        G.bottomRightCorner(j, j) - mixed.transpose() * least_squares(G.topLeftCorner(k, k), mixed);
  }
  const Eigenpairs found = eigenpairs(rest, size);
  Index count = 0;
  while (count < j && found.values[count] <= bent * bent) ++count;
  return count == j ? W : DenseMatrix(W * found.vectors.leftCols(count));
}

bool may_be_rigid(const System& system, const Vector& w) {
  return rigid_among(system, w).cols() == 1;
}

DenseMatrix motions_of_interior(const DenseMatrix& W, Index interior,
                                const std::vector<Index>& units) {
  const Index n = static_cast<Index>(W.rows()), k = static_cast<Index>(W.cols());
  const Index count = static_cast<Index>(units.size());
  DenseMatrix Z = W;
  if (k > 0 && interior < n) {
    Z = W * null_space(W.bottomRows(n - interior), still * W.cwiseAbs().maxCoeff());
    Z.bottomRows(n - interior).setZero();
  }
  if (count == 0 || Z.cols() != count) return DenseMatrix(n, 0);
  DenseMatrix at_units(count, count);
  for (Index j = 0; j < count; ++j) at_units.row(j) = Z.row(units[j]);
  const DenseMatrix I = DenseMatrix::Identity(count, count), inverse = solve(at_units, I);
  const bool regular = (at_units * inverse - I).norm() < 0.5;  // of fewer dimensions: 1 and more
  return regular ? DenseMatrix(Z * inverse) : DenseMatrix(n, 0);
}

}  // namespace frictioncg
