#include "assembly/mortar/geometric_stiffness.h"

#include "linear_algebra.h"

namespace frictioncg::mortar {

namespace {

/// One row of G with its derivatives, balanced as in moments.h:
///
///   P_l += w_l b.q_l,   w_l = |P_l|,   q_l = T (X_l - mean),   T = 1 - n n',
///   M b = T arm,   M = sum_l w_l q_l q_l',   arm = sum_c G_c (X_c - X_i)
///
/// with the part of b that changes no weight by more than most_change; then across the gap
///
///   P_v += s c_v,   c_v = grad lambda_v.e,   dc_v = grad lambda_v.(de - sum_w c_w dX_w)
class GapRow {
 public:
  /// choice: of the row as it is
  GapRow(const SlopedRow& row, const RowChoice& choice, const SlaveNode& at, const Turns& turns,
         const std::vector<Crossing>& crossings, const Nodes& nodes)
      : i_(at.node), n_(at.normal), X_(nodes.X), turns_(turns), G_(row.own) {
    T_ = Mat3::Identity() - n_ * n_.transpose();
    G_[i_].value += 1;
    for (const auto& [l, weight] : row.theirs) G_[l].add(weight, -1);
    for (const auto& [c, weight] : G_) {
      for (const auto& [j, by] : weight.slope) near_.insert(j);
      near_.insert(c);
    }
    arm_ = arm(X_);
    for (const auto& [j, by] : turns_) near_.insert(j);
    for (const auto& [j, by] : row.offset.slope) near_.insert(j);
    set_gap(row, nodes);
    balance(row.theirs, choice);
    cross(crossings, nodes);
  }
  /// Of the force y
  void add_to(GeometricStiffness& stiffness, const Vec3& y) const {
    const Mat3 turning = n_.dot(y) * Mat3::Identity() - n_ * y.transpose();
    for (const auto& [c, weight] : G_)
      for (Index j : near_) {
        const Mat3 by = y * weight.by(j).transpose() + weight.value * turning * turn(j);
        if (!by.isZero(0)) stiffness.forces.emplace_back(std::make_pair(c, j), by);
      }
    for (const auto& [vj, by] : bent_) stiffness.bent.emplace_back(vj, y * by.transpose());
  }
  /// Of the gap n.(offset - arm)
  const std::map<Index, Vec3>& gap() const { return gap_; }
  /// What it has more by the way of mid-edges from their straight edges.
  const std::map<Index, Vec3>& bent_gap() const { return bent_gap_; }

 private:
  struct Place {
    Real w, sign;
    Vec3 x, q;  ///< from the mean, and across the normal
  };
  Mat3 turn(Index j) const {
    const auto found = turns_.find(j);
    return found == turns_.end() ? Mat3(Mat3::Zero()) : found->second;
  }
  void place_master(const std::map<Index, Sloped>& theirs, Index rank) {
    for (const auto& [l, weight] : theirs) sum_ += std::abs(weight.value);
    for (int pass = 0; pass < 2; ++pass) {  // as in moments.cpp
      Vec3 way = Vec3::Zero();
      for (const auto& [l, weight] : theirs) way += std::abs(weight.value) * (X_[l] - mean_);
      mean_ += way / sum_;
    }
    Mat3 M = Mat3::Zero();
    for (const auto& [l, weight] : theirs) {
      const Vec3 x = X_[l] - mean_, q = T_ * x;
      at_[l] = {std::abs(weight.value), weight.value < 0 ? -1. : 1., x, q};
      M += at_[l].w * q * q.transpose();
    }
    inverse_ = least_squares(M, Mat3::Identity(), singular(rank));
  }
  void balance(const std::map<Index, Sloped>& theirs, const RowChoice& choice) {
    place_master(theirs, choice.rank);
    b_ = inverse_ * arm_;
    Real largest = choice.most_change;
    for (const auto& [l, p] : at_)
      if (const Real change = std::abs(b_.dot(p.q)); change > largest) largest = change, most_ = l;
    part_ = choice.most_change / largest;
    for (Index j : near_) balance_slopes(theirs, j);
    for (const auto& [l, p] : at_) G_[l].value -= part_ * p.w * b_.dot(p.q);
  }
  void set_gap(const SlopedRow& row, const Nodes& nodes) {
    const std::vector<Vec3>& X = nodes.where_forces_act();
    const Vec3 way = row.between - arm(X);
    g_ = n_.dot(way);
    for (Index j : near_)
      gap_[j] = row.offset.by(j) - slope_of_arm(j, X).transpose() * n_ + turn(j).transpose() * way;
    if (!nodes.bent.empty())
      for (const auto& [c, weight] : G_) bent_gap_[c] = -weight.value * n_;
  }
  void balance_slopes(const std::map<Index, Sloped>& theirs, Index j) {
    const Mat3 dn = turn(j), dmean = slope_of_mean(theirs, j);
    Mat3 rest = slope_of_arm(j, X_) - n_.dot(arm_) * dn;  // T d(T arm) - dM b
    std::map<Index, Mat3> dq;
    for (const auto& [l, p] : at_) {
      dq[l] = -T_ * dmean - n_.dot(p.x) * dn - n_ * p.x.transpose() * dn;
      if (l == j) dq[l] += T_;
      const Eigen::RowVector3d dw = p.sign * theirs.at(l).by(j).transpose();
      rest -= p.q.dot(b_) * (p.q * dw + p.w * dq[l]) + p.w * p.q * (b_.transpose() * dq[l]);
    }
    Mat3 db = inverse_ * rest;
    if (part_ < 1) {
      const Vec3& q = at_[most_].q;
      const Eigen::RowVector3d change = q.transpose() * db + b_.transpose() * dq[most_];
      db -= b_ * change / b_.dot(q);
    }
    for (const auto& [l, p] : at_)
      G_[l].at(j) -= part_ * (p.sign * b_.dot(p.q) * theirs.at(l).by(j) +
                              p.w * (db.transpose() * p.q + dq[l].transpose() * b_));
  }
  void cross(const std::vector<Crossing>& crossings, const Nodes& nodes) {
    if (crossings.empty()) return;
    const std::vector<Vec3>& X = nodes.where_forces_act();
    const Vec3 left = arm(X);
    std::map<Index, Mat3> slope;
    for (Index j : near_) slope[j] = slope_of_arm(j, X);
    std::map<Index, Sloped> change;
    for (const Crossing& crossing : crossings) {
      near_.insert(crossing.vertices.begin(), crossing.vertices.end());
      const DenseMatrix along = crossing.share * crossing.gradients;
      const Vec3 e = crossing.e(left, n_, g_);
      const Vector c = crossing.gradients * e;
      for (std::size_t v = 0; v < crossing.vertices.size(); ++v) {
        Sloped& of_vertex = change[crossing.vertices[v]];
        const Vec3 by = along.row(static_cast<Index>(v)).transpose();
        of_vertex.value += by.dot(e);
        if (!nodes.bent.empty())
          for (const auto& [i, weight] : G_) {
            Vec3& bent = bent_.try_emplace({crossing.vertices[v], i}, Vec3::Zero()).first->second;
            bent -= weight.value * by;
            if (!crossing.one_body) bent -= n_.dot(by) * bent_gap_[i];
          }
        for (const auto& [j, of_arm] : slope) {
          of_vertex.at(j) += of_arm.transpose() * by;
          if (!crossing.one_body)  // and of g n
            of_vertex.at(j) += n_.dot(by) * gap_[j] + g_ * turn(j).transpose() * by;
        }
        for (std::size_t w = 0; w < crossing.vertices.size(); ++w)
          of_vertex.at(crossing.vertices[w]) -= c[static_cast<Index>(w)] * by;
      }
    }
    for (const auto& [v, weight] : change) G_[v].add(weight, -1);
  }
  /// Of the weights as they are so far
  Vec3 arm(const std::vector<Vec3>& X) const {
    Vec3 sum = Vec3::Zero();
    for (const auto& [c, weight] : G_) sum += weight.value * (X[c] - X[i_]);
    return sum;
  }
  Mat3 slope_of_arm(Index j, const std::vector<Vec3>& X) const {
    Mat3 slope = Mat3::Zero();
    for (const auto& [c, weight] : G_) {
      slope += (X[c] - X[i_]) * weight.by(j).transpose();
      if (c == j) slope += weight.value * Mat3::Identity();
      if (i_ == j) slope -= weight.value * Mat3::Identity();
    }
    return slope;
  }
  Mat3 slope_of_mean(const std::map<Index, Sloped>& theirs, Index j) const {
    Mat3 slope = Mat3::Zero();
    for (const auto& [l, p] : at_) {
      slope += p.sign * p.x * theirs.at(l).by(j).transpose();
      if (l == j) slope += p.w * Mat3::Identity();
    }
    return slope / sum_;
  }

  Index i_;
  Vec3 n_;
  const std::vector<Vec3>& X_;
  const Turns& turns_;
  std::map<Index, Sloped> G_;
  std::set<Index> near_;  ///< nodes that the row depends on
  std::map<Index, Place> at_;
  std::map<Index, Vec3> gap_;
  std::map<Index, Vec3> bent_gap_;
  std::map<std::pair<Index, Index>, Vec3> bent_;  ///< slopes of weights, by mid-edges' way
  Real g_ = 0;
  Real sum_ = 0;     ///< of w
  Real part_ = 1;    ///< of b, which most_change leaves
  Index most_ = -1;  ///< whose weight would change most, where that is less than 1
  Vec3 arm_ = Vec3::Zero(), mean_ = Vec3::Zero(), b_ = Vec3::Zero();
  Mat3 T_, inverse_;  ///< of M
};

/// The turns of the normals of contact nodes, by node; none of those that have the master's.
std::map<Index, Turns> turns_of(const Arrangement& of, const std::vector<SlaveNode>& contact) {
  std::vector<std::map<Index, std::vector<Index>>> around(of.slaves.size());  // facets, by the pair
  for_each_vertex(of.slaves, [&](std::size_t p, Index f, Index i) { around[p][i].push_back(f); });
  std::map<Index, Turns> turns;
  for (const SlaveNode& c : contact)
    if (!of.ownership->common.of_master[c.node])
      turns[c.node] =
          turns_of_normal(c.node, c.normal, around[c.pair][c.node], of.slaves[c.pair], of.nodes.X);
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

GeometricStiffness geometric_stiffness(const Mortar& mortar, const Arrangement& of,
                                       const std::map<Index, SlopedRow>& rows,
                                       const Crossings& crossings, const Options& options) {
  GeometricStiffness found;
  if (options.force.empty()) return found;
  const DenseMatrix y = multipliers(mortar, options.force);
  std::map<Index, Turns> turns;
  if (options.normals.empty()) turns = turns_of(of, mortar.nodes());
  for (Index k = 0; k < y.cols(); ++k) {
    const SlaveNode& at = mortar.nodes()[k];
    const auto row = rows.find(at.node);
    if (row == rows.end() || y.col(k).isZero(0)) continue;
    const auto choice = of.choices.find(at.node);
    const GapRow sloped(row->second, choice == of.choices.end() ? RowChoice() : choice->second, at,
                        turns[at.node], crossings[k], of.nodes);
    sloped.add_to(found, y.col(k));
    for (const auto& [j, by] : sloped.gap()) found.gaps.push_back({{k, j}, by});
    for (const auto& [j, by] : sloped.bent_gap()) found.bent_gaps.push_back({{k, j}, by});
  }
  return found;
}

Change change(const Mortar& mortar, const std::vector<Vec3>& v, const std::vector<Vec3>& x) {
  Change found{std::vector<Vec3>(v.size(), Vec3::Zero()), Vector::Zero(mortar.relative().rows())};
  for (const auto& [ij, block] : mortar.stiffness().forces)
    found.force[ij.first] += block * x[ij.second];
  for (const auto& [ij, block] : mortar.stiffness().bent)
    found.force[ij.first] += block * (v[ij.second] - x[ij.second]);
  for (const auto& [kj, slope] : mortar.stiffness().bent_gaps)
    found.gap[kj.first] += slope.dot(v[kj.second] - x[kj.second]);
  Index last = -1;
  for (const auto& [kj, slope] : mortar.stiffness().gaps) {
    const auto [k, j] = kj;
    found.gap[k] += slope.dot(x[j]);
    if (k == last) continue;
    last = k;
    for (Matrix::InnerIterator G(mortar.relative(), k); G; ++G)
      found.gap[k] += G.value() * mortar.nodes()[k].normal.dot(v[G.col()]);
  }
  return found;
}

}  // namespace frictioncg::mortar
