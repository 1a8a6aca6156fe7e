#include "statics/undetermined.h"

#include "factorization.h"
#include "linear_algebra.h"
#include "statics/nearest_in_cone.h"

namespace frictioncg {

namespace {
constexpr Real forbidden = 1e-9;  ///< part of a unit motion that the laws stand against
constexpr Real forceless = 1e-9;  ///< of the forces at work: a touch that bears no more bears none
constexpr Real margin = 10;       ///< over what rounding leaves of a force
/// Of its limits a body kept 0.35 at most where it was let go, else 0.41 at least, of 1757 tapers.
constexpr Real half = 0.5;

/// The triangle of the rows of all processes, from that of each (k x k).
DenseMatrix of_all_processes(const System& system, const DenseMatrix& R) {
  const Index k = static_cast<Index>(R.cols());
  const auto both = [k](const Vector& a, const Vector& b) -> Vector {
    DenseMatrix rows(2 * k, k);
    rows << a.reshaped(k, k), b.reshaped(k, k);
    return triangle(rows).reshaped();
  };
  return system.combined(R.reshaped(), both).reshaped(k, k);
}

/// Whether M (of any rows) takes each unit vector to something well above `forbidden`: of many
/// bodies that all are held, a product and a factor of it are far cheaper than what shows which are
/// not.
bool has_full_rank(const System& system, const DenseMatrix& M) {
  constexpr Real clear = 1e-10;  // a square
  DenseMatrix size = M.transpose() * M;
  system.sum(size.data(), static_cast<Index>(size.size()));
  const Real largest = size.cwiseAbs().rowwise().sum().maxCoeff();
  const Cholesky factor(size);
  return factor.found() && factor.rcond() * largest > clear;
}

/// A force below it is none, over the root of its weight; and so is a distance, times that weight.
Real no_force(const Certificate& certificate) {
  return std::max(forceless, margin * certificate.attainable) * certificate.scale;
}

}  // namespace

DenseMatrix left_free(const DenseMatrix& W, const ContactProblem& problem,
                      const Branches& branches) {
  if (W.cols() == 0) return W;
  const DenseMatrix W_C = W.bottomRows(problem.contact_dofs());
  const Index k = static_cast<Index>(W.cols());
  DenseMatrix barred = DenseMatrix::Zero(problem.contact_dofs(), k);
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Branch& b = branches[i];
    const Index N = problem.system->first[i] - problem.interior(), t = problem.tangents(i);
    const Real unit = std::sqrt(problem.system->D[problem.system->first[i]]);
    const auto slide = W_C.middleRows(N + 1, t);
    if (b.closed) barred.row(N) = unit * W_C.row(N);
    if (b.stick) barred.middleRows(N + 1, t) = unit * slide;
    if (!b.stick && b.g > 0 && t == 2)
      barred.row(N + 1) = unit * (b.d[1] * slide.row(0) - b.d[0] * slide.row(1));
  }
  if (has_full_rank(*problem.system, barred)) return DenseMatrix(W.rows(), 0);
  const DenseMatrix R = of_all_processes(*problem.system, triangle(barred));
  return W.lazyProduct(null_space(R, forbidden));
}

Branches branches_of(const ContactProblem& problem, const Vector& x,
                     const Certificate& certificate) {
  const System& system = *problem.system;
  const Vector& r = certificate.r;
  const Real none = no_force(certificate);
  Branches branches(problem.nodes());
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Index N = system.first[i], size = problem.tangents(i) + 1;
    const Real closing = problem.closing(i, x);
    const Real touch = none * std::sqrt(system.weight[N]);
    const NodeLaw law = law_of(problem.increment, i);
    const Real shear = r.segment(N + 1, size - 1).norm();
    const Real no_shear = none * std::sqrt(system.weight[N + size - 1]);
    const bool coheres = law.coheres() && shear > no_shear;
    branches[i] = branch_at(law, coheres ? closing - touch : std::max(closing, touch),
                            x.segment(N, size), r.segment(N, size), system.weight[N + size - 1]);
    Branch& b = branches[i];
    if (!b.stick || shear <= no_shear || shear < b.g - no_shear) continue;
    b.stick = false;
    b.d.head(size - 1) = r.segment(N + 1, size - 1) / shear;
  }
  return branches;
}

Vector limits_at(const ContactProblem& problem, const Solution& s) {
  Vector limits(problem.nodes());
  for (Index i = 0; i < problem.nodes(); ++i)
    limits[i] = law_of(problem.increment, i)
                    .limit(problem.closing(i, s.x), s.certificate.r[problem.system->first[i]]);
  return limits;
}

std::vector<std::vector<Index>> let_go(const ContactProblem& problem, const Solution& s) {
  constexpr Real next_to_none = 1e-5;  // of the forces at the start
  const System& system = *problem.system;
  const Vector& F = problem.increment.F;
  const Vector now = limits_at(problem, s), rest = Vector::Zero(problem.dofs());
  const Branches branches = branches_of(problem, s.x, s.certificate);
  const Real none = next_to_none * norm_D(system, F);
  Vector before = Vector::Zero(problem.nodes());
  std::vector<char> sticks(problem.nodes(), 0);
  bool loses = false;
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Index N = system.first[i];
    const Real touch = none * std::sqrt(system.weight[N]);
    if (problem.closing(i, rest) <= touch && F[N] > touch)
      before[i] = law_of(problem.increment, i).limit(F[N]);
    sticks[i] = branches[i].stick && s.certificate.r[N] > touch;
    loses = loses || (now[i] < half * before[i] && !sticks[i]);
  }
  std::vector<std::vector<Index>> found;
  if (!loses) return found;
  const Bodies bodies = system.bodies();
  found.resize(bodies.count);
  for (Index i = 0; i < problem.nodes(); ++i) found[bodies.of[system.first[i]]].push_back(i);
  const auto held = [&](const std::vector<Index>& nodes) {
    const auto stuck = [&](Index i) { return sticks[i] != 0; };
    return std::any_of(nodes.begin(), nodes.end(), stuck) || !hold_more({nodes}, before, now);
  };
  found.erase(std::remove_if(found.begin(), found.end(), held), found.end());
  return found;
}

bool hold_more(const std::vector<std::vector<Index>>& bodies, const Vector& limits,
               const Vector& others) {
  return std::any_of(bodies.begin(), bodies.end(), [&](const std::vector<Index>& nodes) {
    return others(nodes).sum() < half * limits(nodes).sum();
  });
}

bool between_branches(const ContactProblem& problem, const Vector& x,
                      const Certificate& certificate, const Branches& branches) {
  const System& system = *problem.system;
  const Real none = no_force(certificate);
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Index N = system.first[i], t = problem.tangents(i);
    const Real touch = none * std::sqrt(system.weight[N]);
    if (std::abs(problem.closing(i, x)) <= touch && certificate.r[N] <= touch) return true;
    const bool slips = t > 0 && branches[i].closed && !branches[i].stick && branches[i].g > 0;
    if (slips && x.segment(N + 1, t).norm() <= none / std::sqrt(system.weight[N + t])) return true;
  }
  return false;
}

namespace {

/// The half-spaces  a'c >= h  of the motions W c (k = W.cols()) that leave x on its branches: no
/// gap closes beyond contact, no slip turns back.   (k + 1) x ..., columns (a, h), of all processes
DenseMatrix bounds_of(const ContactProblem& problem, const Branches& branches, const Vector& x,
                      const DenseMatrix& W) {
  std::vector<Real> own;
  const auto add = [&](const Vector& a, Real h) {
    own.insert(own.end(), a.begin(), a.end());
    own.push_back(h);
  };
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Branch& b = branches[i];
    const Index N = problem.system->first[i], t = problem.tangents(i);
    const Real gap = problem.increment.gap[i];
    if (!b.closed && std::isfinite(gap)) add(-W.row(N).transpose(), x[N] - gap);
    if (b.stick || !(b.g > 0) || t == 0) continue;
    const Vector d = b.d.head(t);
    add(W.middleRows(N + 1, t).transpose() * d, -d.dot(x.segment(N + 1, t)));
  }
  const Vector all = problem.system->gathered(Eigen::Map<Vector>(own.data(), Index(own.size())));
  return all.reshaped(W.cols() + 1, all.size() / (W.cols() + 1));
}

/// The least of the fields x + W c that the branches allow; x: the least of all of them.
/// |x + W c|_D^2 grows by |z|^2, z = L'c, W'DW = LL'. The z of least norm with  g'z >= h  is that
/// of Lawson and Hanson (chapter 23): what is left of a unit vector e beside the cone of all (g,
/// h).   L: W'DW
Vector least_within(const ContactProblem& problem, const Branches& branches, const Vector& x,
                    const DenseMatrix& W, DenseMatrix L) {
  const Index k = static_cast<Index>(W.cols());
  const DenseMatrix bounds = bounds_of(problem, branches, x, W);
  if (!Cholesky(L).found() || bounds.cols() == 0) return x;
  DenseMatrix directions = bounds.topRows(k);
  L.triangularView<Eigen::Lower>().solveInPlace(directions);
  // in the unit of the way that the furthest bound asks for
  const Vector ways =
      bounds.row(k).transpose().array() / directions.colwise().norm().transpose().array();
  const Real unit = ways.maxCoeff();
  if (!(unit > 0) || !std::isfinite(unit)) return x;
  DenseMatrix columns(k + 1, bounds.cols());
  columns << directions, bounds.row(k) / unit;
  NearestInCone nearest(Vector::Unit(k + 1, k));
  while (nearest.add(columns)) {
  }
  if (!(nearest.rest()[k] > 0)) return x;
  const Vector z = -unit / nearest.rest()[k] * nearest.rest().head(k);
  return x + W.lazyProduct(Vector(L.triangularView<Eigen::Lower>().transpose().solve(z)));
}

}  // namespace

void leave_least(const ContactProblem& problem, Real tol, Solution& s) {
  if (s.undetermined.cols() == 0) return;
  const System& system = *problem.system;
  const Branches branches = branches_of(problem, s.x, s.certificate);
  const DenseMatrix &Z = s.undetermined, DZ = system.D.asDiagonal() * Z;
  DenseMatrix sums(Z.cols(), Z.cols() + 1);
  sums << Z.transpose().lazyProduct(DZ), DZ.transpose().lazyProduct(s.x);
  system.sum(sums.data(), static_cast<Index>(sums.size()));
  const DenseMatrix ZDZ = sums.leftCols(Z.cols());
  const Vector part = least_squares(ZDZ, sums.rightCols(1));
  const Vector x = s.x - Z.lazyProduct(part);
  const auto take = [&](const Vector& other) {
    Certificate certificate = certify(problem, other);
    const bool rounded = s.certificate.residual > tol && may_be_rounding(certificate);
    if (!(rounded || certificate.residual <= std::max(tol, s.certificate.residual))) return false;
    s.x = other;
    s.certificate = std::move(certificate);
    return true;
  };
  if (!take(x)) take(least_within(problem, branches, x, Z, ZDZ));
}

Real leave_out_uncertain_work(const System& system, const DenseMatrix& W, Real told, Vector& F) {
  constexpr Real rounding = 1e-13;  // of squares of n.w, over those of the motion most resisted
  const Index k = static_cast<Index>(W.cols());
  if (k == 0 || told <= 0) return 0;
  DenseMatrix Q = DenseMatrix::Zero(k, k);
  for (Index i = 0; i < system.nodes(); ++i) {
    const Vector n = W.row(system.first[i]).transpose();
    Q += n * n.transpose();
  }
  system.sum(Q.data(), static_cast<Index>(Q.size()));
  const Eigenpairs found = eigenpairs(Q);
  Index slipping = 0;
  while (slipping < k && found.values[slipping] <= rounding * found.values[k - 1]) ++slipping;
  if (slipping == 0) return 0;
  const DenseMatrix Z = W.lazyProduct(found.vectors.leftCols(slipping)),
                    DZ = system.D.asDiagonal() * Z;
  DenseMatrix sums(slipping, slipping + 1);
  sums << Z.transpose().lazyProduct(DZ), Z.transpose().lazyProduct(F);
  system.sum(sums.data(), static_cast<Index>(sums.size()));
  const Vector work = sums.col(slipping);
  const Real could =
      system.sum(F.lpNorm<1>()) * system.largest(Z.size() > 0 ? Z.cwiseAbs().maxCoeff() : 0);
  constexpr Real exact = 1e-13;  // as it is: rounding of the load
  if (!(work.norm() > exact * could && work.norm() <= told * could)) return 0;
  F -= DZ.lazyProduct(solve(sums.leftCols(slipping), work));
  return work.norm() / could;
}

}  // namespace frictioncg
