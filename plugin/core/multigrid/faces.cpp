#include "multigrid/faces.h"

#include "linear_algebra.h"

namespace frictioncg {

namespace {

/// A slipping node resists a change of its direction by a stiffness w, which grows without bound as
/// the force comes near its limit: it is cut off at so many times c.
constexpr Real most_stiffness = 1000;

/// A start need not be exact: the bed is left as it is after so many steps.
constexpr int most_steps = 50;
/// What fewer springs leave free does not move ...
constexpr Real singular = 1e-10;
/// ... and where that leaves this share of the load, they do not hold it: a single node no moment.
constexpr Real unheld = 1e-6;
/// An idle obstacle stays at all of its nodes, up to this share of their gaps.
constexpr Real rounding = 1e-9;

/// t <= 2 components of v from `first` on, then zeros.
Eigen::Vector2d tangent(const Vector& v, Index first, Index t) {
  Eigen::Vector2d two(0, 0);
  for (Index k = 0; k < t; ++k) two[k] = v[first + k];
  return two;
}

}  // namespace

Faces::Faces(const ContactProblem& problem)
    : system_(*problem.system),
      increment_(problem.increment),
      face_(problem.nodes()),
      c_(problem.nodes()),
      c_D_(problem.nodes()),
      fixed_(problem.contact_dofs(), 0) {
  const Real share = wave_share(system_);
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Index t = problem.tangents(i);
    c_D_[i] = t == 0 ? 0 : system_.weight[system_.first[i] + 1];
    c_[i] = share * c_D_[i];
  }
}

void Faces::start_from(const Vector& x, const Vector& b_C) {
  for (Index i = 0; i < system_.nodes(); ++i) {
    const Index first = system_.first[i], size = system_.tangents(i) + 1;
    const Real closing = system_.weight[first] * (increment_.gap[i] - x[first]);
    face_[i] = branch_at(law_of(increment_, i), closing, x.segment(first, size),
                         b_C.segment(normal(i), size), c_[i], most_stiffness);
  }
  update_rows();
}

/// The force of friction on the present branch: where it sticks, whatever b is.
Eigen::Vector2d Faces::friction(Index i, const Vector& x, const Vector& b_C) const {
  const Branch& face = face_[i];
  if (face.stick) return tangent(b_C, normal(i) + 1, system_.tangents(i));
  const Branch::Limit limit = face.limit(law_of(increment_, i));
  const Real g = lagged_ ? face.g : limit.base + limit.slope * b_C[normal(i)];
  const Eigen::Vector2d x_T = tangent(x, system_.first[i] + 1, system_.tangents(i));
  return g * face.d + face.stiffness() * x_T;
}

void Faces::start_from(const Branches& faces) {
  face_ = faces;
  for (std::size_t i = 0; i < face_.size(); ++i) {
    Branch& face = face_[i];
    if (increment_.bilateral) face.closed = true;
    if (!std::isfinite(increment_.gap[static_cast<Index>(i)])) face.closed = face.stick = false;
  }
  update_rows();
}

void Faces::choose(const Vector& x, const Vector& b_C) {
  for (Index i = 0; i < system_.nodes(); ++i) {
    const Branch now = face_[i];
    const Index first = system_.first[i], t = system_.tangents(i);
    const Real r_N = now.closed ? b_C[normal(i)] : 0;
    const Tangent y = friction(i, x, b_C).head(t) + c_[i] * x.segment(first + 1, t);
    Branch& next = face_[i];
    next.closed = increment_.bilateral || (now.closed ? r_N > 0 : x[first] > increment_.gap[i]);
    next.choose_limit(law_of(increment_, i), r_N);
    if (t > 0) next.choose_friction(y, next.g, c_[i], most_stiffness);
    // slip does not reverse at once: on a motion that little resists it would do so for ever
    const bool reverses = !now.stick && y.dot(now.d.head(t)) < 0;
    next.stick = next.stick || (next.g > 0 && reverses);
  }
  update_rows();
}

void Faces::update_rows() {
  W_.clear();
  for (Index i = 0; i < system_.nodes(); ++i) {
    const Branch& face = face_[i];
    const Index N = normal(i), t = system_.tangents(i);
    fixed_[N] = face.closed;
    std::fill(fixed_.begin() + N + 1, fixed_.begin() + N + 1 + t, face.stick);
    if (face.stick || face.w == 0) continue;
    W_.push_back({system_.first[i] + 1, face.stiffness()});
  }
}

void Faces::place(Vector& x) const {
  for (Index i = 0; i < system_.nodes(); ++i) {
    const Index first = system_.first[i];
    if (face_[i].closed) x[first] = increment_.gap[i];
    if (face_[i].stick) x.segment(first + 1, system_.tangents(i)).setZero();
  }
}

void Faces::residual(const Vector& x, const Vector& b_C, Eigen::Ref<Vector> s_C) const {
  for (Index i = 0; i < system_.nodes(); ++i) {
    const Index N = normal(i), t = system_.tangents(i);
    s_C[N] = face_[i].closed ? 0 : b_C[N];
    const Eigen::Vector2d f = friction(i, x, b_C);  // b_T itself where it sticks
    for (Index k = 0; k < t; ++k) s_C[N + 1 + k] = b_C[N + 1 + k] - f[k];
  }
}

void Faces::jacobian(const Vector& z, const Vector& Az_C, Eigen::Ref<Vector> Jz_C) const {
  for (Index i = 0; i < system_.nodes(); ++i) {
    const Branch& face = face_[i];
    const Index N = normal(i), t = system_.tangents(i);
    Jz_C[N] = face.closed ? 0 : Az_C[N];
    if (face.stick) {
      Jz_C.segment(N + 1, t).setZero();
      continue;
    }
    const Eigen::Vector2d z_T = tangent(z, system_.first[i] + 1, t);
    const Real mu = lagged_ ? 0 : face.limit(law_of(increment_, i)).slope;
    const Eigen::Vector2d law = face.stiffness() * z_T - mu * Az_C[N] * face.d;
    for (Index k = 0; k < t; ++k) Jz_C[N + 1 + k] = Az_C[N + 1 + k] + law[k];
  }
}

Real Faces::violation(const Vector& x, const Vector& b_C) const {
  Real sum = 0;
  for (Index i = 0; i < system_.nodes(); ++i) {
    const Index first = system_.first[i], t = system_.tangents(i);
    Vec3 r(face_[i].closed ? b_C[normal(i)] : 0, 0, 0);
    r.tail(2) = friction(i, x, b_C);
    const Violation v = frictioncg::violation(law_of(increment_, i), increment_.gap[i],
                                              system_.weight.segment(first, t + 1),
                                              x.segment(first, t + 1), r.head(t + 1));
    sum += v.normal + v.friction;
  }
  return std::sqrt(system_.sum(sum));
}

Real Faces::misdirection(const Vector& x, const Vector& b_C) const {
  Real sum = 0;
  for (Index i = 0; i < system_.nodes(); ++i) {
    const Index first = system_.first[i], N = normal(i), t = system_.tangents(i);
    if (t < 2 || face_[i].stick) continue;
    const Eigen::Vector2d b_T = tangent(b_C, N + 1, t), x_T = tangent(x, first + 1, t);
    const NodeLaw law = law_of(increment_, i);
    const Real slip = x_T.norm(), g = face_[i].closed ? law.limit(b_C[N]) : law.open_limit();
    if (slip == 0) continue;
    const Real off = std::min(c_D_[i] * slip, (b_T - g / slip * x_T).norm());
    sum += off * off / c_D_[i];
  }
  return std::sqrt(system_.sum(sum));
}

Branches reached(const ContactProblem& problem) {
  const System& system = *problem.system;
  const Increment& increment = problem.increment;
  const Branches stick = all_stick(increment);
  if (system.border.cols() == 0 || increment.bilateral) return stick;
  const Vector load = system.border.transpose() * increment.F;
  const DenseMatrix C = DenseMatrix(system.border).bottomRows(system.contact_dofs());
  const Real share = wave_share(system);
  Branches faces = stick;
  bool changes = true, any = true;
  for (int step = 0; changes && any && step < most_steps; ++step) {
    DenseMatrix H = DenseMatrix::Zero(C.cols(), C.cols());
    Vector f = load;
    for (Index i = 0; i < problem.nodes(); ++i) {
      if (!faces[i].closed) continue;
      const Index N = system.first[i] - system.interior();
      const auto C_i = C.middleRows(N, faces[i].stick ? 1 + system.tangents(i) : 1);
      const Real k = share * system.weight[system.first[i]];
      H += k * C_i.transpose().lazyProduct(C_i);
      f += k * increment.gap[i] * C.row(N).transpose();
    }
    const Vector q = least_squares(H, f, singular);
    if ((H.lazyProduct(q) - f).norm() > unheld * load.norm()) return stick;
    changes = any = false;
    for (Index i = 0; i < problem.nodes(); ++i) {
      const auto row = C.row(system.first[i] - system.interior());
      if (!stick[i].closed || row.isZero(0)) continue;
      const Real gap = increment.gap[i];
      const bool closed = row.dot(q) >= gap - rounding * std::abs(gap);
      changes = changes || closed != faces[i].closed;
      any = any || closed;
      faces[i].closed = closed;
      faces[i].stick = closed && stick[i].stick;
    }
  }
  return any ? faces : stick;
}

}  // namespace frictioncg
