#include "statics/equilibrium.h"

#include <Eigen/Jacobi>

#include "model/law.h"
#include "statics/floating.h"

namespace frictioncg {

namespace {

/// A load is balanced where no more than this share of it is left.
constexpr Real rounding = 1e-9;
/// Forces of more than so many times the load are none that a body can bear: a motion that nothing
/// but they could stop is a proof.
constexpr Real most_pressure = 1e6;
/// The search for a balance ends as soon as only forces of so many times the load could make one.
constexpr Real any_pressure = 1e9;
/// A can take the pull F.w of a motion that is not quite rigid, F.w = x'A w, by a displacement x of
/// up to so many times load / stiffness: the motion is then no proof.
constexpr Real most_displacement = 1e4;
/// A column leads to the target only where its cosine to it is above this.
constexpr Real no_descent = 1e-14;
/// What a unit column adds to those before it is nothing below this: rounding.
constexpr Real dependent = 1e-13;
/// A point is nearer, too, where it is as near to rounding: the distance goes with the square of
/// the angle between its normal and the cone, which is what a proof needs.
constexpr Real as_near = 1e-14;
/// In 2D the rounds end by themselves; in 3D tangents to the cones converge like Newton's method.
constexpr int most_rounds = 300;

/// The point of a cone, given by columns that come one by one, that is nearest to a target
/// (nonnegative least squares of Lawson and Hanson).
class NearestInCone {
 public:
  explicit NearestInCone(const Vector& target)
      : target_(target),
        rest_(target),
        G_(target.size(), target.size()),
        Q_(target.size(), target.size()),
        R_(target.size(), target.size()) {}

  const Vector& rest() const { return rest_; }  ///< target - nearest point

  /// Takes the columns into the cone that bring it nearer to the target. False where none does: a
  /// column that rounding keeps out is passed over for the next.
  bool add(const std::vector<Vector>& columns) {
    bool any = false;
    std::vector<char> failed(columns.size(), 0);
    for (std::size_t pass = 0; pass <= columns.size(); ++pass) {
      std::size_t best = columns.size();
      Real steepest = no_descent * rest_.norm();
      for (std::size_t k = 0; k < columns.size(); ++k) {
        if (failed[k]) continue;
        const Real size = columns[k].norm(), slope = size > 0 ? columns[k].dot(rest_) / size : 0;
        if (slope <= steepest) continue;
        steepest = slope;
        best = k;
      }
      if (best == columns.size()) break;
      const bool nearer = add(columns[best]);
      failed[best] = !nearer;
      any = any || nearer;
    }
    return any;
  }

 private:
  Index count() const { return static_cast<Index>(weight_.size()); }
  auto G() const { return G_.leftCols(count()); }
  auto Q() const { return Q_.leftCols(count()); }

  bool add(const Vector& column) {
    const Real before = rest_.norm();
    const DenseMatrix columns = G();
    const std::vector<Real> weight = weight_;
    if (!append(column.normalized(), 0)) return false;
    while (count() > 0 && !step()) {
    }
    const Vector rest = orthogonal_rest();
    if (rest.norm() <= (1 + as_near) * before) {
      const bool kept =
          count() > 0 && G_.col(count() - 1) == column.normalized();  // it is the last
      const bool nearer = kept || rest.norm() < before;
      rest_ = rest;
      return nearer;
    }
    weight_.clear();  // rounding
    for (std::size_t k = 0; k < weight.size(); ++k)
      append(columns.col(static_cast<Index>(k)), weight[k]);
    return false;
  }

  /// False where the columns that are there make it up. Gram and Schmidt, twice.
  bool append(Vector unit, Real weight) {
    const Index k = count();
    if (k == target_.size()) return false;
    G_.col(k) = unit;
    Vector along = Vector::Zero(k);
    for (int pass = 0; pass < 2; ++pass) {
      const Vector more = Q().transpose() * unit;
      unit -= Q() * more;
      along += more;
    }
    const Real left = unit.norm();
    if (!(left > dependent)) return false;
    Q_.col(k) = unit / left;
    R_.col(k).head(k) = along;
    R_(k, k) = left;
    weight_.push_back(weight);
    return true;
  }

  /// By plane rotations, which make R a triangle again.
  void remove(Index j) {
    const Index last = count() - 1;
    for (Index k = j; k < last; ++k) {
      G_.col(k) = G_.col(k + 1);
      R_.col(k).head(k + 2) = R_.col(k + 1).head(k + 2);
    }
    for (Index k = j; k < last; ++k) {
      Eigen::JacobiRotation<Real> turn;
      turn.makeGivens(R_(k, k), R_(k + 1, k));
      R_.middleCols(k, last - k).applyOnTheLeft(k, k + 1, turn.adjoint());
      Q_.applyOnTheRight(k, k + 1, turn);
    }
    weight_.erase(weight_.begin() + j);
  }

  /// Towards the least squares of the present columns, as far as the weights stay positive; drops
  /// those that vanish. True where it got there.
  bool step() {
    const Vector best = R_.topLeftCorner(count(), count())
                            .triangularView<Eigen::Upper>()
                            .solve(Q().transpose() * target_);
    Real length = 1;
    Index first = count();
    for (Index k = 0; k < count(); ++k) {
      if (best[k] > 0) continue;
      const Real to_zero = weight_[k] > 0 ? weight_[k] / (weight_[k] - best[k]) : 0;
      if (first < count() && to_zero >= length) continue;
      length = to_zero;
      first = k;
    }
    for (Index k = 0; k < count(); ++k)
      weight_[k] = std::max(0.0, weight_[k] + length * (best[k] - weight_[k]));
    if (first == count()) return true;
    remove(first);
    return count() == 0;
  }

  /// target - nearest point, orthogonal to the columns to rounding of itself, not of the target: as
  /// a proof it is as good as that.
  Vector orthogonal_rest() const {
    const Vector rest = target_ - G() * Eigen::Map<const Vector>(weight_.data(), count());
    return rest - Q() * (Q().transpose() * rest);
  }

  const Vector target_;
  Vector rest_;
  DenseMatrix G_, Q_, R_;     ///< the unit columns of positive weight, G = QR
  std::vector<Real> weight_;  ///< of the unit columns
};

/// What resists a motion: the forces of contact and friction that work most against it.
///
/// Forces count by their work on the k rigid motions. Given limits, cohesion and caps bound a part
/// of friction: its sum is the last of the columns, and a row k + 1 says that it acts once: it has
/// `unit` there, as the target has.
class Resistance {
 public:
  /// largest: forces above it are none that a body can bear.
  Resistance(const DenseMatrix& W, const Vector& work, Real largest, const ContactProblem& problem)
      : W_(W.bottomRows(problem.contact_dofs())),
        work_(work),
        problem_(problem),
        largest_(largest),
        given_(problem.system->largest(bounded_values(problem.increment)) > 0),
        unit_(work.norm()) {}

  Vector target() const {
    Vector t(work_.size() + given_);
    t.head(work_.size()) = work_;
    if (given_) t[work_.size()] = unit_;
    return t;
  }

  /// At the motion of coefficients c (k, or more): its columns, one a node.
  void meet(const Vector& c) {
    const Index k = static_cast<Index>(work_.size());
    const Vector w = W_.lazyProduct(c.head(k));  // of no rows, on some processes
    const Increment& increment = problem_.increment;
    columns.clear();
    most = 0;
    const Real pull_of_load = work_.dot(c.head(k));
    pull = pull_of_load;
    Vector friction = Vector::Zero(k + given_);
    if (given_) friction[k] = unit_;
    for (Index i = 0; i < problem_.nodes(); ++i) {
      const Index N = problem_.system->first[i] - problem_.interior(), t = problem_.tangents(i);
      const Real slide = w.segment(N + 1, t).norm();
      Vector along = Vector::Zero(k + given_);  // a unit force against the slide
      if (slide > 0)
        along.head(k) = W_.middleRows(N + 1, t).transpose() * w.segment(N + 1, t) / slide;
      const NodeLaw law = law_of(increment, i);
      const bool closes = std::isfinite(increment.gap[i]);
      const Real sense = increment.bilateral && w[N] < 0 ? -1 : 1;
      const Bounded bounded =
          closes ? at_most(law, sense * w[N], slide) : Bounded{0, law.open_limit()};
      friction += bounded.shear * along;
      if (bounded.pressure > 0)
        friction.head(k) += bounded.pressure * sense * W_.row(N).transpose();
      pull -= bounded.shear * slide + bounded.pressure * sense * w[N];
      if (!closes) continue;
      const Real mu = is_capped(law) ? 0 : law.mu;
      Vector column = mu * along;
      column.head(k) += sense * W_.row(N).transpose();
      most = std::max(most, sense * w[N] + mu * slide);
      columns.push_back(column);
    }
    share(pull_of_load, friction);
    if (!given_) return;
    columns.push_back(friction);
    columns.push_back(unit_ * Vector::Unit(k + 1, k));  // no friction at all
  }

  /// Every process gets the columns of all of them.
  void share(Real pull_of_load, Vector& friction) {
    const System& system = *problem_.system;
    system.sum(friction.data(), static_cast<Index>(work_.size()));
    most = system.largest(most);
    pull = pull_of_load + system.sum(pull - pull_of_load);
    const Index rows = static_cast<Index>(friction.size());
    Vector own(rows * static_cast<Index>(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i)
      own.segment(static_cast<Index>(i) * rows, rows) = columns[i];
    const Vector all = system.gathered(own);
    columns.clear();
    for (Index i = 0; i < all.size(); i += rows) columns.push_back(all.segment(i, rows));
  }

  std::vector<Vector> columns;
  Real most = 0;  ///< w_N + mu |w_T|, the largest of the nodes, or 0; capped: w_N
  Real pull = 0;  ///< F.w less what bounded forces take of it

 private:
  static Index bounded_values(const Increment& increment) {
    if (increment.law == Law::tresca) return increment.g.size();
    if (increment.law == Law::frictionless) return 0;
    return increment.cohesion.size() + increment.cap.size();
  }

  /// The bounded forces of a node that can close, of which those work most that this returns, at
  /// its closing w_N and its slide |w_T|.
  struct Bounded {
    Real pressure, shear;
  };
  Bounded at_most(const NodeLaw& law, Real w_N, Real slide) const {
    const bool grows = is_capped(law) && law.mu > 0 && law.cap > law.c && w_N + law.mu * slide > 0;
    if (!grows) return {0, law.limit(0)};
    return {std::min((law.cap - law.c) / law.mu, largest_), law.cap};
  }
  bool is_capped(const NodeLaw& law) const { return law.cap < largest_; }

  const DenseMatrix W_;  ///< contact_dofs x k
  const Vector work_;    ///< k, of the load
  const ContactProblem& problem_;
  const Real largest_;
  const bool given_;
  const Real unit_;
};

/// The largest <Dw,w>^{1/2} of motions: the most that a residual of norm_D 1 can work on them.
Real largest_size(const System& system, const DenseMatrix& W) {
  Vector sizes = W.cwiseAbs2().transpose().lazyProduct(system.D);
  system.sum(sizes.data(), static_cast<Index>(sizes.size()));
  return std::sqrt(sizes.maxCoeff());
}

}  // namespace

std::optional<Vector> unheld_motion(const DenseMatrix& W, const ContactProblem& problem) {
  if (W.cols() == 0) return std::nullopt;
  const Vector& F = problem.increment.F;
  const System& system = *problem.system;
  Vector work = W.transpose().lazyProduct(F);
  system.sum(work.data(), static_cast<Index>(work.size()));
  const Real load = system.sum(F.lpNorm<1>());
  Real noise = rounding * load * system.largest(W.size() > 0 ? W.cwiseAbs().maxCoeff() : 0);
  // what the displacement of before leaves may have been summed of terms a million times larger
  if (problem.increment.noise() > 0) noise += problem.increment.noise() * largest_size(system, W);
  if (work.norm() <= noise) return std::nullopt;
  Resistance resistance(W, work, most_pressure * load, problem);
  NearestInCone nearest(resistance.target());
  const auto proven = [&](Real pressures) {
    resistance.meet(nearest.rest());
    return resistance.pull > 0 && pressures * load * resistance.most <= resistance.pull;
  };
  bool unheld = false;
  for (int round = 0; round < most_rounds; ++round) {
    unheld = proven(any_pressure);
    if (unheld || !nearest.add(resistance.columns)) break;
    if (nearest.rest().norm() <= noise) return std::nullopt;
  }
  if (!unheld && !proven(most_pressure)) return std::nullopt;
  const Vector motion = W.lazyProduct(nearest.rest().head(W.cols()));
  Vector Aw;
  system.multiply(motion, Aw);
  const Real most_pull = most_displacement * norm_D(system, F) * norm_D(system, Aw);
  if (resistance.pull <= most_pull || !may_be_rigid(system, motion)) return std::nullopt;
  return motion;
}

}  // namespace frictioncg
