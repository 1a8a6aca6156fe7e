#include "assembly/mortar/geometric_stiffness.h"

#include <algorithm>
#include <set>

#include "assembly/mortar/moments.h"
#include "assembly/mortar/smooth_side.h"
#include "linear_algebra.h"

namespace frictioncg::mortar {

namespace {

using Mat3 = Eigen::Matrix3d;
using Turns = std::map<Index, Mat3>;  ///< dn_i/dX_j by j

Mat3 cross(const Vec3& a) {
  Mat3 m;
  m << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return m;
}

/// Of e / |e|^2.
Mat3 slope_of_inverse(const Vec3& e) {
  const Real square = e.squaredNorm();
  return (Mat3::Identity() - 2 / square * e * e.transpose()) / square;
}

/// The sum that the normal n of a node is along, with its derivatives: over the facets of the
/// slaves around it that are one surface with it.
class TurningNormal {
 public:
  TurningNormal(Index i, const Vec3& n, const std::vector<Vec3>& X) : i_(i), n_(n), X_(X) {}
  void add(const Side& side, Index f) {
    if (side.planes[f].normal.dot(n_) < sharp) return;
    const auto& node = side.facet(f).node;
    const int v =
        static_cast<int>(std::find(node.begin(), node.begin() + side.d, i_) - node.begin());
    const Index j = node[(v + 1) % side.d], k = node[(v + 2) % side.d];
    const Vec3 e = X_[j] - X_[i_];
    if (side.d == 2) return add(e, Vec3::UnitZ(), j, side.planes[f].normal);
    add(e, (X_[k] - X_[i_]) / (X_[k] - X_[i_]).squaredNorm(), j, side.planes[f].normal);
    const Mat3 by = sign_ * cross(e / e.squaredNorm()) * slope_of_inverse(X_[k] - X_[i_]);
    slope(k) += by;
    slope(i_) -= by;
  }
  Turns turns() const {
    Turns turns = slopes_;
    const Mat3 along = (Mat3::Identity() - n_ * n_.transpose()) / sum_.norm();
    for (auto& [j, by] : turns) by = along * by;
    return turns;
  }

 private:
  /// e/|e|^2 x other, of the sign of n_f
  void add(const Vec3& e, const Vec3& other, Index j, const Vec3& n_f) {
    const Vec3 term = (e / e.squaredNorm()).cross(other);
    sign_ = term.dot(n_f) < 0 ? -1 : 1;
    sum_ += sign_ * term;
    const Mat3 by = -sign_ * cross(other) * slope_of_inverse(e);
    slope(j) += by;
    slope(i_) -= by;
  }
  Mat3& slope(Index j) { return slopes_.try_emplace(j, Mat3::Zero()).first->second; }

  Index i_;
  Vec3 n_;
  const std::vector<Vec3>& X_;
  Real sign_ = 1;
  Vec3 sum_ = Vec3::Zero();
  Turns slopes_;
};

/// One row of G with its derivatives, balanced as in moments.h:
///
///   P_l += w_l b.q_l,   w_l = |P_l|,   q_l = T (X_l - mean),   T = 1 - n n',
///   M b = T arm,   M = sum_l w_l q_l q_l',   arm = sum_c G_c (X_c - X_i)
class Row {
 public:
  Row(const SlopedRow& row, const ContactNode& at, const Turns& turns, const std::vector<Vec3>& X);
  /// Of the force y
  void add_to(NodeBlocks& blocks, const Vec3& y) const;

 private:
  struct Place {
    Real w, sign;
    Vec3 x, q;  ///< from the mean, and across the normal
  };
  Mat3 turn(Index j) const {
    const auto found = turns_.find(j);
    return found == turns_.end() ? Mat3(Mat3::Zero()) : found->second;
  }
  void place_master(const std::map<Index, Sloped>& theirs);
  void balance(const std::map<Index, Sloped>& theirs);
  void balance_slopes(const std::map<Index, Sloped>& theirs, Index j);
  Mat3 slope_of_arm(Index j) const;
  Mat3 slope_of_mean(const std::map<Index, Sloped>& theirs, Index j) const;

  Index i_;
  Vec3 n_;
  const std::vector<Vec3>& X_;
  const Turns& turns_;
  std::map<Index, Sloped> G_;
  std::set<Index> near_;  ///< nodes that the row depends on
  std::map<Index, Place> at_;
  Real sum_ = 0;  ///< of w
  Vec3 arm_ = Vec3::Zero(), mean_ = Vec3::Zero(), b_ = Vec3::Zero();
  Mat3 T_, inverse_;  ///< of M
};

Row::Row(const SlopedRow& row, const ContactNode& at, const Turns& turns,
         const std::vector<Vec3>& X)
    : i_(at.node), n_(at.normal), X_(X), turns_(turns), G_(row.own) {
  T_ = Mat3::Identity() - n_ * n_.transpose();
  G_[i_].value += 1;
  for (const auto& [l, weight] : row.theirs) G_[l].add(weight, -1);
  for (const auto& [c, weight] : G_) {
    for (const auto& [j, by] : weight.slope) near_.insert(j);
    near_.insert(c);
    arm_ += weight.value * (X_[c] - X_[i_]);
  }
  for (const auto& [j, by] : turns_) near_.insert(j);
  balance(row.theirs);
}

void Row::add_to(NodeBlocks& blocks, const Vec3& y) const {
  const Mat3 turning = n_.dot(y) * Mat3::Identity() - n_ * y.transpose();
  for (const auto& [c, weight] : G_)
    for (Index j : near_) {
      const Mat3 by = y * weight.by(j).transpose() + weight.value * turning * turn(j);
      if (!by.isZero(0)) blocks.emplace_back(std::make_pair(c, j), by);
    }
}

void Row::place_master(const std::map<Index, Sloped>& theirs) {
  for (const auto& [l, weight] : theirs) {
    sum_ += std::abs(weight.value);
    mean_ += std::abs(weight.value) * X_[l];
  }
  mean_ /= sum_;
  Mat3 M = Mat3::Zero();
  for (const auto& [l, weight] : theirs) {
    const Vec3 x = X_[l] - mean_, q = T_ * x;
    at_[l] = {std::abs(weight.value), weight.value < 0 ? -1. : 1., x, q};
    M += at_[l].w * q * q.transpose();
  }
  inverse_ = least_squares(M, Mat3::Identity(), singular);
}

void Row::balance(const std::map<Index, Sloped>& theirs) {
  place_master(theirs);
  b_ = inverse_ * arm_;
  Real largest = 0;
  for (const auto& [l, p] : at_) largest = std::max(largest, std::abs(b_.dot(p.q)));
  if (largest > most_change) inverse_ *= most_change / largest;
  b_ = inverse_ * arm_;
  for (Index j : near_) balance_slopes(theirs, j);
  for (const auto& [l, p] : at_) G_[l].value -= p.w * b_.dot(p.q);
}

/// Of the weights before they are balanced.
Mat3 Row::slope_of_arm(Index j) const {
  Mat3 slope = Mat3::Zero();
  for (const auto& [c, weight] : G_) {
    slope += (X_[c] - X_[i_]) * weight.by(j).transpose();
    if (c == j) slope += weight.value * Mat3::Identity();
    if (i_ == j) slope -= weight.value * Mat3::Identity();
  }
  return slope;
}

Mat3 Row::slope_of_mean(const std::map<Index, Sloped>& theirs, Index j) const {
  Mat3 slope = Mat3::Zero();
  for (const auto& [l, p] : at_) {
    slope += p.sign * p.x * theirs.at(l).by(j).transpose();
    if (l == j) slope += p.w * Mat3::Identity();
  }
  return slope / sum_;
}

void Row::balance_slopes(const std::map<Index, Sloped>& theirs, Index j) {
  const Mat3 dn = turn(j), dmean = slope_of_mean(theirs, j);
  Mat3 rest = slope_of_arm(j) - n_.dot(arm_) * dn;  // T d(T arm) - dM b
  std::map<Index, Mat3> dq;
  for (const auto& [l, p] : at_) {
    dq[l] = -T_ * dmean - n_.dot(p.x) * dn - n_ * p.x.transpose() * dn;
    if (l == j) dq[l] += T_;
    const Eigen::RowVector3d dw = p.sign * theirs.at(l).by(j).transpose();
    rest -= p.q.dot(b_) * (p.q * dw + p.w * dq[l]) + p.w * p.q * (b_.transpose() * dq[l]);
  }
  const Mat3 db = inverse_ * rest;
  for (const auto& [l, p] : at_)
    G_[l].at(j) -= p.sign * b_.dot(p.q) * theirs.at(l).by(j) +
                   p.w * (db.transpose() * p.q + dq[l].transpose() * b_);
}

/// The turns of the normals of contact nodes, by node.
std::map<Index, Turns> turns_of(const Nodes& nodes, const std::vector<Side>& slaves,
                                const std::vector<ContactNode>& contact) {
  std::map<Index, TurningNormal> at;
  for (const ContactNode& c : contact) at.emplace(c.node, TurningNormal(c.node, c.normal, nodes.X));
  for (const Side& side : slaves)
    for (Index f = 0; f < side.facets(); ++f)
      for (int v = 0; v < side.d; ++v) {
        const auto found = at.find(side.facet(f).node[v]);
        if (found != at.end()) found->second.add(side, f);
      }
  std::map<Index, Turns> turns;
  for (const auto& [i, normal] : at) turns[i] = normal.turns();
  return turns;
}

/// y = T'f at the contact nodes, of f = G'y: G T is the identity there. As columns.
DenseMatrix multipliers(const Mortar& mortar, const std::vector<Vec3>& force) {
  DenseMatrix f(static_cast<Index>(force.size()), 3);
  for (Index i = 0; i < f.rows(); ++i) f.row(i) = force[i].transpose();
  const DenseMatrix all = mortar.change_of_basis().transpose() * f;
  DenseMatrix y(3, static_cast<Index>(mortar.nodes().size()));
  for (Index k = 0; k < y.cols(); ++k) y.col(k) = all.row(mortar.nodes()[k].node).transpose();
  return y;
}

}  // namespace

NodeBlocks geometric_stiffness(const Mortar& mortar, const Nodes& nodes,
                               const std::vector<Side>& slaves,
                               const std::map<Index, SlopedRow>& rows, const Options& options) {
  NodeBlocks blocks;
  if (options.force.empty()) return blocks;
  const DenseMatrix y = multipliers(mortar, options.force);
  std::map<Index, Turns> turns;
  if (options.normals.empty()) turns = turns_of(nodes, slaves, mortar.nodes());
  for (Index k = 0; k < y.cols(); ++k) {
    const ContactNode& at = mortar.nodes()[k];
    const auto row = rows.find(at.node);
    if (row == rows.end() || y.col(k).isZero(0)) continue;
    Row(row->second, at, turns[at.node], nodes.X).add_to(blocks, y.col(k));
  }
  return blocks;
}

}  // namespace frictioncg::mortar
