#include "statics/equilibrium.h"

#include "model/law.h"
#include "statics/floating.h"
#include "statics/nearest_in_cone.h"

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
/// In 2D the rounds end by themselves; in 3D tangents to the cones converge like Newton's method.
constexpr int most_rounds = 300;

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
    std::vector<Real> own;
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
      own.insert(own.end(), column.begin(), column.end());
    }
    share(own, pull_of_load, friction);
    if (!given_) return;
    columns.conservativeResize(Eigen::NoChange, columns.cols() + 2);
    columns.rightCols(2) << friction, unit_ * Vector::Unit(k + 1, k);  // no friction at all
  }

  /// Every process gets the columns of all of them.
  void share(std::vector<Real>& own, Real pull_of_load, Vector& friction) {
    const System& system = *problem_.system;
    system.sum(friction.data(), static_cast<Index>(work_.size()));
    most = system.largest(most);
    pull = pull_of_load + system.sum(pull - pull_of_load);
    const Index rows = static_cast<Index>(friction.size());
    const Vector all = system.gathered(Eigen::Map<Vector>(own.data(), Index(own.size())));
    columns = all.reshaped(rows, all.size() / rows);
  }

  DenseMatrix columns;
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
