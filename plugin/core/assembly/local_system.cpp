#include "assembly/local_system.h"

#include "model/inertia.h"
#include "model/rigid_candidates.h"
#include "model/validate.h"

namespace frictioncg {

/// Two gaps are one where they differ by less than this share of the largest gap or prescribed
/// displacement.
constexpr Real same_gap = 1e-9;

LocalSystem::LocalSystem(const Triplets& A, int dimension, std::vector<ContactPoint> points,
                         std::vector<Index> mesh_node, BodyShape shape, const LocalSystem* before,
                         const RigidObstacles& obstacles)
    : points_(std::move(points)), dirichlet_(A, dofs_of(points_)) {
  make_basis(A, dimension);
  const Index n_q = obstacles.dofs();
  if (n_q > 0) {
    basis_ = std::make_shared<const Basis>(
        with_obstacles(*basis_, dimension, points_, nodes_, obstacles));
    std::vector<char> given(A.n + n_q, 0);
    for (Index k = 0; k < n_q; ++k) given[A.n + k] = !obstacles.free[k];
    dirichlet_ = dirichlet_.with_more(given, Vector::Ones(A.n + n_q));
  }
  if (!mesh_node.empty()) {  // each component as if it had a node of its own
    const Index next = 1 + *std::max_element(mesh_node.begin(), mesh_node.end());
    for (Index k = 0; k < n_q; ++k) mesh_node.push_back(next + k);
  }
  if (shape.rigid_modes && n_q > 0)
    shape.rigid_modes = [n_q, of_bodies = std::move(shape.rigid_modes)] {
      DenseMatrix M = of_bodies();
      M.conservativeResizeLike(DenseMatrix::Zero(M.rows() + n_q, M.cols()));
      return M;
    };
  if (shape.body_modes)
    shape.body_modes = [n_q, of_bodies = std::move(shape.body_modes)] {
      return with_obstacles(of_bodies(), n_q);
    };
  assemble(A, dimension, mesh_node, std::move(shape), before);
}

LocalSystem::LocalSystem(const Triplets& A, int dimension, std::vector<ContactPoint> points,
                         const std::vector<Index>& mesh_node, Dirichlet dirichlet,
                         const Coupling& coupling, BodyShape shape, const LocalSystem* before)
    : points_(std::move(points)), dirichlet_(std::move(dirichlet)) {
  make_basis(A, dimension);
  const auto of_u = std::make_shared<Basis>(*basis_);
  of_u->T = coupling.T * basis_->T;
  of_u->W = basis_->W * coupling.W;
  of_u->rotated = basis_->rotated || coupling.T.nonZeros() > coupling.T.rows();
  basis_ = of_u;
  assemble(A, dimension, mesh_node, std::move(shape), before);
}

/// The frames of the contact points.
void LocalSystem::make_basis(const Triplets& A, int dimension) {
  Frames frames = frames_at(dimension, A.n, points_, dirichlet_);
  nodes_ = std::move(frames.nodes);
  basis_ = std::move(frames.basis);
}

/// W (0, q) for each free component, q_k of its local dof 1.
Matrix LocalSystem::border(Index n) const {
  EntryList q;
  for (Index p = 0; p < basis_->first.front(); ++p)
    if (const Index i = basis_->origin[p]; i >= n)
      q.emplace_back(i, static_cast<Index>(q.size()), basis_->T.coeff(i, p));
  const Matrix Q = sparse(basis_->T.rows(), static_cast<Index>(q.size()), q);
  return q.empty() ? Matrix() : Matrix(basis_->W * Q);
}

/// The system in the basis.
void LocalSystem::assemble(const Triplets& A, int dimension, const std::vector<Index>& mesh_node,
                           BodyShape shape, const LocalSystem* before) {
  const auto system = std::make_shared<AssembledSystem>();
  system->dimension = dimension;
  system->first = basis_->first;
  system->border = border(A.n);
  if (before) {  // over the pattern that was there, where it still holds
    system->A = before->system_->entries();
    places_ = before->places_;
  }
  transform(A, *basis_, places_, system->A, K_);
  system->D = system->A.diagonal();
  for (Index p = 0; p < system->dofs(); ++p) {
    const Index i = basis_->origin[p];
    if (has_squares(system->D[p]) || !A.is_whole(i)) continue;
    refuse("A(", i, ",", i, ") = ", system->D[p], "; a stiffness lies between ", smallest, " and ",
           largest, " (squares must not overflow): check the coefficients, or choose other units");
  }
  if (!A.half) check_symmetry(A, system->A, system->D, basis_->origin);
  if (!mesh_node.empty()) {
    system->mesh_node.reserve(basis_->origin.size());
    for (Index dof : basis_->origin) system->mesh_node.push_back(mesh_node[dof]);
  }
  system->rigid_modes = in_local_dofs(std::move(shape.rigid_modes));
  system->body_modes = in_local_dofs(std::move(shape.body_modes));
  system->slenderness = std::move(shape.slenderness);
  system->weight = node_weights(*system);
  system->inertia = inertia_of(*system);
  system_ = system;
}

/// Modes of another number of dofs are as none: System's are asked for their rows.
template <class Modes>
std::function<Modes()> LocalSystem::in_local_dofs(std::function<Modes()> modes) const {
  if (!modes) return {};
  return [basis = basis_, modes = std::move(modes)] {
    const Modes M = modes();
    Modes local;
    if (M.rows() == basis->W.cols()) local = basis->W * M;
    return local;
  };
}

namespace {

/// As System::multiply_sized, without what rounding makes of rigid motions, however far bodies have
/// come: the nearest ones are taken off w, and are felt where A resists them by more than its own
/// rounding.
Vector multiply_apart(const System& system, const Vector& w, Vector& Aw) {
  constexpr Real rounded = 16 * epsilon;
  const RigidCandidates all(system);
  if (all.count() == 0) return system.multiply_sized(w, Aw);
  const Vector rigid = all.nearest_to(w);
  Vector of_rigid;
  Vector sizes = system.multiply_sized(rigid, of_rigid);
  const Eigen::Array<bool, Eigen::Dynamic, 1> felt =
      of_rigid.array().abs() > rounded * sizes.array();
  sizes = felt.select(sizes, 0.) + system.multiply_sized(w - rigid, Aw);
  Aw += felt.select(of_rigid, 0.);
  return sizes;
}

}  // namespace

/// F = T'b - K u_D - A w_old
LocalLoad LocalSystem::load_from(const Vector& b, const Vector& w_old, bool as_known) const {
  LocalLoad load;
  const Index w = basis_->local_dofs();
  load.start = Vector::Zero(w + fixed_dofs());
  load.start.tail(fixed_dofs()) = dirichlet_.data(b);
  load.external = (basis_->T.transpose() * b).head(w);
  load.total = load.external - K_ * load.start.tail(fixed_dofs());
  load.sizes = load.external.cwiseAbs() + K_.cwiseAbs() * load.start.tail(fixed_dofs()).cwiseAbs();
  load.F = load.total;
  if (w_old.size() == 0) return load;
  load.start.head(w) = w_old;
  Vector Aw;
  Vector sizes = system_->multiply_sized(w_old, Aw);
  constexpr Real hides = 1e-9;  // the load, where the sizes are rounded by this share of it
  if (!as_known && epsilon * norm_D(*system_, sizes) > hides * norm_D(*system_, load.total))
    sizes = multiply_apart(*system_, w_old, Aw);
  load.sizes += sizes;
  load.F -= Aw;
  return load;
}

void set_load(const LocalLoad& load, const System& system, Increment& increment) {
  increment.F = load.F;
  increment.rounding = epsilon * norm_D(system, load.sizes);
  increment.load_norm = load_beside_inertia(system, load.external);
  increment.external_norm = norm_D(system, load.external);
  // what a displacement of before leaves of a body that nothing loads
  const Real noise = increment.noise();
  if (noise > 0 && std::isfinite(noise) && norm_D(system, increment.F) <= noise)
    increment.F.setZero();
  if (system.largest(!load.total.isZero(0)) == 0) forget_what_vanishes(system, increment);
  increment.force_scale = std::max(norm_D(system, load.total), driving_norm(system, increment));
  if (increment.force_scale == 0) increment.force_scale = 1;
}

LocalIncrement LocalSystem::increment(const Vector& b, const Vector& u_old,
                                      const PointLaws& laws) const {
  require_size("b", Index(b.size()), Index(basis_->T.rows()), "dof");
  if (u_old.size() > 0) require_size("u_old", Index(u_old.size()), Index(basis_->T.rows()), "dof");
  return increment(load_from(b, u_old.size() > 0 ? to_local(u_old) : u_old), laws);
}

LocalIncrement LocalSystem::increment(const LocalLoad& load, const PointLaws& laws) const {
  const auto require = [&](const char* name, const Vector& values) {
    require_size(name, Index(values.size()), Index(points_.size()), "contact point");
  };
  require("gap", laws.gap);
  if (laws.law == Law::coulomb) require("mu", laws.mu);
  if (laws.law == Law::tresca) require("g", laws.g);
  if (laws.cohesion.size() > 0) require("cohesion", laws.cohesion);
  if (laws.cap.size() > 0) require("cap", laws.cap);
  LocalIncrement result;
  Increment& increment = result.increment;
  const Vector& start = load.start;
  result.u0 = basis_->T * start;

  const Real rounding = same_gap * std::max(laws.gap.lpNorm<Eigen::Infinity>(),
                                            start.tail(fixed_dofs()).lpNorm<Eigen::Infinity>());
  increment.gap.resize(nodes());
  for (Index k = 0; k < nodes(); ++k)
    increment.gap[k] =
        nearest_obstacle(nodes_[k], laws, rounding, start) - start[system_->first[k]];
  increment.law = laws.law;
  increment.bilateral = laws.bilateral;
  set_load(load, *system_, increment);
  if (laws.law == Law::frictionless) return result;
  const auto at_nodes = [&](const Vector& values) {
    Vector v(values.size() > 0 ? nodes() : 0);
    for (Index k = 0; k < v.size(); ++k) v[k] = nodes_[k].shared ? 0 : values[nodes_[k].point];
    return v;
  };
  increment.mu = at_nodes(laws.mu);
  increment.g = at_nodes(laws.g);
  increment.cohesion = at_nodes(laws.cohesion);
  increment.cap = at_nodes(laws.cap);
  return result;
}

/// The bound on w_N = n.u: the gap, or a rival's, n_r.u <= gap_r on the free components: with the
/// held ones prescribed, n.u <= factor (gap_r - n_r.u_D) + n.u_D. Bilateral contact takes the gaps
/// for one: throws ConflictingObstacles where they differ by more than rounding.
Real LocalSystem::nearest_obstacle(const ContactNode& node, const PointLaws& laws, Real rounding,
                                   const Vector& start) const {
  const auto prescribed = [&](Index point) {
    const ContactPoint& p = points_[point];
    Real sum = 0;
    for (int c = 0; c < system_->dimension; ++c)
      if (dirichlet_.holds(p.dof[c]))
        sum += p.normal[c] * start[basis_->local_dofs() + dirichlet_.number(p.dof[c])];
    return sum;
  };
  const Real own = laws.gap[node.point];
  Real nearest = own;
  for (const Rival& r : node.rivals) {
    const Real other =
        r.factor * (laws.gap[r.point] - prescribed(r.point)) + prescribed(node.point);
    if (laws.bilateral && std::abs(other - own) > rounding)
      throw ConflictingObstacles(
          r.point, "the node of dof " + std::to_string(points_[r.point].dof[0]), different_gaps);
    nearest = std::min(nearest, other);
  }
  return nearest;
}

Vector LocalSystem::to_global(const Vector& x, const Vector& u0) const { return u0 + to_global(x); }

Vector LocalSystem::to_global(const Vector& x) const {
  Vector w = Vector::Zero(basis_->T.cols());
  w.head(x.size()) = x;
  return basis_->T * w;
}

Vector LocalSystem::force_to_global(const Vector& r) const {
  Vector lambda = -r;
  lambda.head(system_->interior()).setZero();
  return basis_->W.transpose() * lambda;
}

}  // namespace frictioncg
