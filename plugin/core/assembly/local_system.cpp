#include "assembly/local_system.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <sstream>

namespace frictioncg {

namespace {

constexpr Real huge_ratio = 1e10;  ///< diagonal over off-diagonals from which a row is Dirichlet
constexpr Real asymmetry = 1e-9;   ///< |a_ij - a_ji| over sqrt(a_ii a_jj) that is refused
constexpr Real aligned = 1e-14;    ///< components of a normal below this are taken as 0
constexpr Real blocked = 1e-6;     ///< projected normals shorter than this are no contact
constexpr Index fixed_dof = -1;
Index in_frame(std::size_t node, int component) {
  return -2 - static_cast<Index>(3 * node) - component;
}

[[noreturn]] void refuse(const std::ostringstream& message) { throw IllegalInput(message.str()); }

}  // namespace

LocalSystem::LocalSystem(const Triplets& A, int dimension, std::vector<ContactPoint> points,
                         const std::vector<Index>& mesh_node)
    : d_(dimension), points_(std::move(points)), half_(A.half) {
  system_->dimension = dimension;
  find_fixed(A);
  number(A.n);
  copy(A);
  if (!mesh_node.empty())
    for (Index dof : original_) system_->mesh_node.push_back(mesh_node[dof]);
  system_->weight = node_weights(*system_);
}

/// Dirichlet rows, by their values: the flags that come with the matrix do not survive its copies.
void LocalSystem::find_fixed(const Triplets& A) {
  Vector diagonal = Vector::Zero(A.n), row_max = Vector::Zero(A.n), column_max = Vector::Zero(A.n);
  std::vector<char> emptied(A.n, 0);  // the row has stored off-diagonal zeros
  for (std::size_t k = 0; k < A.size; ++k) {
    const Index i = A.i[k] - A.base, j = A.j[k] - A.base;
    const Real a = std::abs(A.a[k]);
    if (!(a <= std::numeric_limits<Real>::max())) {
      std::ostringstream m;
      m << "A(" << i << "," << j << ") = " << A.a[k] << "; the entries of A must be finite";
      refuse(m);
    }
    if (i == j) {
      diagonal[i] += A.a[k];
    } else {
      if (a > row_max[i]) row_max[i] = a;
      if (a > column_max[j]) column_max[j] = a;
      if (a == 0) emptied[i] = 1;
    }
  }
  // A half-stored row of the identity shows only its half: believe it where some row shows the
  // zeros that the elimination stores.
  bool emptied_unit_rows = false;
  if (A.half)
    for (Index i = 0; i < A.n; ++i)
      emptied_unit_rows |= emptied[i] && row_max[i] == 0 && diagonal[i] == 1;

  image_.assign(A.n, 0);
  for (Index i = 0; i < A.n; ++i) {
    const Real others = std::max(row_max[i], column_max[i]);
    const bool huge = others > 0 && diagonal[i] >= huge_ratio * others;
    const bool unit = A.half ? emptied_unit_rows && row_max[i] == 0 && diagonal[i] == 1
                             : row_max[i] == 0 && column_max[i] > 0;
    const bool alone = others == 0;
    if (!(diagonal[i] > 0)) {
      std::ostringstream m;
      m << "A(" << i << "," << i << ") = " << diagonal[i]
        << "; every diagonal entry must be > 0 (assemble with tgv=1e30 or tgv=-1, and with an "
           "elasticity term on every element)";
      refuse(m);
    }
    if (!huge && !unit && !alone) continue;
    image_[i] = fixed_dof;
    fixed_.push_back({i, diagonal[i], diagonal[i] == 1 && (alone || A.half)});
    unit_rows_ |= unit && !A.half;
  }
}

/// Frame of a contact point, unless Dirichlet conditions block its normal.
void LocalSystem::add_frame(Index point) {
  const ContactPoint& p = points_[point];
  Frame f;
  f.point = point;
  std::array<Real, 3> n{};
  Real norm = 0;
  for (int c = 0; c < d_; ++c) {
    if (image_[p.dof[c]] == fixed_dof) continue;
    ++f.size;
    n[c] = std::abs(p.normal[c]) > aligned ? p.normal[c] : 0;
    norm = std::hypot(norm, n[c]);
  }
  if (norm < blocked) return;
  f.share = norm;
  for (int c = 0; c < d_; ++c) f.Q[c][0] = n[c] / norm;
  // Tangents: Gram-Schmidt on the axes, that least along n first.
  std::array<bool, 3> used{};
  for (int k = 1; k < f.size; ++k) {
    int axis = -1;
    for (int c = 0; c < d_; ++c)
      if (image_[p.dof[c]] != fixed_dof && !used[c] &&
          (axis < 0 || std::abs(n[c]) < std::abs(n[axis])))
        axis = c;
    used[axis] = true;
    std::array<Real, 3> t{};
    t[axis] = 1;
    for (int q = 0; q < k; ++q) {
      const Real along = f.Q[axis][q];
      for (int c = 0; c < d_; ++c) t[c] -= along * f.Q[c][q];
    }
    Real length = 0;
    for (int c = 0; c < d_; ++c) {
      if (image_[p.dof[c]] == fixed_dof) t[c] = 0;
      length = std::hypot(length, t[c]);
    }
    for (int c = 0; c < d_; ++c) f.Q[c][k] = t[c] / length;
  }
  orient(f);
  for (int c = 0; c < d_; ++c)
    for (int k = 0; k < f.size; ++k) rotated_ |= f.Q[c][k] != 0 && std::abs(f.Q[c][k]) != 1;
  frames_.push_back(f);
}

/// Turns the tangents to the principal directions of orthotropic friction, and scales them. Where
/// Dirichlet conditions leave one tangent t, the dissipation along it decides: g |(t_1, across
/// t_2)|.
void LocalSystem::orient(Frame& f) const {
  const ContactPoint& p = points_[f.point];
  if (p.across == 1 || f.size < 2) return;
  const Eigen::Map<const Eigen::Vector3d> normal(p.normal.data()), direction(p.direction.data());
  const Eigen::Vector3d along = (direction - normal * normal.dot(direction)).normalized();
  const Eigen::Vector3d across = normal.cross(along);
  if (f.size == 3) {
    for (int c = 0; c < 3; ++c) f.Q[c][1] = std::abs(along[c]) > aligned ? along[c] : 0;
    for (int c = 0; c < 3; ++c) f.Q[c][2] = std::abs(across[c]) > aligned ? across[c] : 0;
    f.scale[2] = p.across;
  } else {
    const Eigen::Vector3d t(f.Q[0][1], f.Q[1][1], f.Q[2][1]);
    f.scale[1] = std::hypot(t.dot(along), p.across * t.dot(across));
  }
}

/// Local dofs: the interior in its order, tangential dofs without a law, then node by node.
void LocalSystem::number(Index n) {
  for (Index p = 0; p < static_cast<Index>(points_.size()); ++p) add_frame(p);
  for (std::size_t k = 0; k < frames_.size(); ++k)
    for (int c = 0; c < d_; ++c) {
      Index& image = image_[points_[frames_[k].point].dof[c]];
      if (image != fixed_dof) image = in_frame(k, c);
    }
  const auto next = [this](Index dof) {
    original_.push_back(dof);
    return static_cast<Index>(original_.size()) - 1;
  };
  for (Index i = 0; i < n; ++i)
    if (image_[i] >= 0) image_[i] = next(i);
  for (Frame& f : frames_)
    if (!points_[f.point].friction)
      for (int k = 1; k < f.size; ++k) f.local[k] = next(points_[f.point].dof[0]);
  for (Frame& f : frames_) {
    system_->first.push_back(static_cast<Index>(original_.size()));
    for (int k = 0; k < f.size; ++k)
      if (f.local[k] < 0) f.local[k] = next(points_[f.point].dof[0]);
  }
  system_->first.push_back(static_cast<Index>(original_.size()));
}

template <LocalSystem::Direction direction, class Visit>
void LocalSystem::for_each_image(Index dof, Visit visit) const {
  const Index image = image_[dof];
  if (image >= 0) {
    visit(image, 1.0);
  } else if (image != fixed_dof) {
    const Index k = -2 - image;
    const Frame& f = frames_[k / 3];
    for (int q = 0; q < f.size; ++q) {
      const Real Q = f.Q[k % 3][q];
      if (Q == 0) continue;
      visit(f.local[q], direction == Direction::from_frame ? Q / f.scale[q] : Q * f.scale[q]);
    }
  }
}

/// A in local frames by two bucket passes over the triplets' images, the second of which sorts the
/// rows; what couples to Dirichlet dofs is kept aside.
void LocalSystem::copy(const Triplets& A) {
  const Index n = static_cast<Index>(original_.size());
  std::vector<Index> fixed_index(A.n, -1);
  for (std::size_t k = 0; k < fixed_.size(); ++k) fixed_index[fixed_[k].dof] = Index(k);

  const auto for_each_entry = [&](const auto& visit) {
    for (std::size_t k = 0; k < A.size; ++k) {
      const Real a = A.a[k];
      if (a == 0) continue;
      const Index i = A.i[k] - A.base, j = A.j[k] - A.base;
      if (image_[i] >= 0 && image_[j] >= 0) {
        visit(image_[i], image_[j], a);
        if (A.half && i != j) visit(image_[j], image_[i], a);
      } else if (image_[i] != fixed_dof && image_[j] != fixed_dof) {
        for_each_image(i, [&](Index p, Real P) {
          for_each_image(j, [&](Index q, Real Q) {
            visit(p, q, P * Q * a);
            if (A.half && i != j) visit(q, p, P * Q * a);
          });
        });
      }
    }
  };
  std::vector<Index> row(n + 1, 0), column(n + 1, 0);
  std::size_t size = 0;
  for_each_entry([&](Index p, Index q, Real) {
    ++row[p + 1];
    ++column[q + 1];
    ++size;
  });
  if (size == 0) throw IllegalInput("Dirichlet conditions hold every degree of freedom of A");
  if (size > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
    throw IllegalInput("A has more than 2^31 - 1 entries; this build indexes them by 32 bits");
  for (Index p = 0; p < n; ++p) {
    row[p + 1] += row[p];
    column[p + 1] += column[p];
  }
  const std::unique_ptr<Index[]> where(new Index[size]);
  const std::unique_ptr<Real[]> value(new Real[size]);
  {
    std::vector<Index> at(row.begin(), row.end() - 1);
    for_each_entry([&](Index p, Index q, Real a) {
      where[at[p]] = q;
      value[at[p]++] = a;
    });
  }
  Matrix& M = system_->A;
  M.resize(n, n);
  M.resizeNonZeros(static_cast<Index>(size));
  std::copy(column.begin(), column.end(), M.outerIndexPtr());
  for (Index p = 0; p < n; ++p)
    for (Index k = row[p]; k < row[p + 1]; ++k) {
      const Index at = column[where[k]]++;
      M.innerIndexPtr()[at] = p;
      M.valuePtr()[at] = value[k];
    }
  if (rotated_) merge_duplicates();
  system_->D = M.diagonal();
  if (!A.half) check_symmetry();

  for (std::size_t k = 0; k < A.size; ++k) {
    if (A.a[k] == 0) continue;
    const Index i = A.i[k] - A.base, j = A.j[k] - A.base;
    const auto couple = [&](Index free, Index fixed) {
      for_each_image(free, [&](Index p, Real P) {
        couplings_.push_back({p, fixed_index[fixed], P * A.a[k]});
      });
    };
    if (image_[i] != fixed_dof && image_[j] == fixed_dof) couple(i, j);
    if (A.half && image_[i] == fixed_dof && image_[j] != fixed_dof) couple(j, i);
  }
}

/// Rotation sends several triplets to one place: sums them. Rows are sorted.
void LocalSystem::merge_duplicates() {
  Matrix& M = system_->A;
  Index* row = M.outerIndexPtr();
  Index* col = M.innerIndexPtr();
  Real* a = M.valuePtr();
  Index to = 0, from = 0;
  for (Index p = 0; p < M.rows(); ++p) {
    const Index begin = to;
    for (const Index end = row[p + 1]; from < end; ++from) {
      if (to > begin && col[to - 1] == col[from]) {
        a[to - 1] += a[from];
      } else {
        col[to] = col[from];
        a[to++] = a[from];
      }
    }
    row[p + 1] = to;
  }
  M.resizeNonZeros(to);
}

/// A cursor a row meets the mirror image of each lower entry in order.
void LocalSystem::check_symmetry() const {
  const Matrix& M = system_->A;
  const Index* row = M.outerIndexPtr();
  const Index* col = M.innerIndexPtr();
  const Real* a = M.valuePtr();
  const Vector& D = system_->D;
  std::vector<Index> cursor(M.rows());
  const auto compare = [&](Index p, Index q, Real a_pq, Real a_qp) {
    if (std::abs(a_pq - a_qp) <= asymmetry * std::sqrt(D[p] * D[q])) return;
    std::ostringstream m;
    m << "A(" << original_[p] << "," << original_[q] << ") = " << a_pq << " but A(" << original_[q]
      << "," << original_[p] << ") = " << a_qp
      << "; A must be symmetric (friction enters by mu, not by the matrix)";
    refuse(m);
  };
  for (Index p = 0; p < M.rows(); ++p) {
    for (Index k = row[p]; k < row[p + 1] && col[k] < p; ++k) {
      const Index q = col[k];
      Index& c = cursor[q];
      for (; c < row[q + 1] && col[c] < p; ++c) compare(q, col[c], a[c], 0);
      const bool mirrored = c < row[q + 1] && col[c] == p;
      compare(p, q, a[k], mirrored ? a[c] : 0);
      if (mirrored) ++c;
    }
    cursor[p] = static_cast<Index>(std::upper_bound(col + row[p], col + row[p + 1], p) - col);
  }
  for (Index q = 0; q < M.rows(); ++q)
    for (Index c = cursor[q]; c < row[q + 1]; ++c) compare(q, col[c], a[c], 0);
}

Vector LocalSystem::dirichlet_data(const Vector& b) const {
  Vector data(fixed_dofs());
  for (Index k = 0; k < fixed_dofs(); ++k) {
    const Fixed& f = fixed_[k];
    data[k] = b[f.dof] / f.diagonal;
    if (f.alone && data[k] != 0 && !unit_rows_) {
      std::ostringstream m;
      m << "b[" << f.dof << "] = " << b[f.dof]
        << " is the data of a Dirichlet dof whose couplings are not in A ("
        << (half_ ? "half-stored with tgv=-1); assemble without sym=1 or with tgv=1e30"
                  : "tgv=-2); assemble with tgv=1e30 or tgv=-1");
      refuse(m);
    }
  }
  return data;
}

Vector LocalSystem::gap_left(const Vector& gap, const Vector& u0) const {
  Vector left(nodes());
  for (Index k = 0; k < nodes(); ++k) {
    const ContactPoint& p = points_[frames_[k].point];
    left[k] = gap[frames_[k].point];
    for (int c = 0; c < d_; ++c) left[k] -= p.normal[c] * u0[p.dof[c]];
    left[k] /= frames_[k].share;
  }
  return left;
}

/// F = b - A_D u_D - A u_old: the load of the increment.
LocalIncrement LocalSystem::increment(const Vector& b, const Vector& u_old,
                                      const PointLaws& laws) const {
  LocalIncrement result;
  Increment& increment = result.increment;
  const Vector data = dirichlet_data(b);
  increment.F = load_to_local(b);
  increment.load_norm = norm_D(*system_, increment.F);
  Vector terms = increment.F.cwiseAbs();  // sum of the sizes of what F is summed of
  for (const Coupling& c : couplings_) {
    increment.F[c.local] -= c.a * data[c.fixed];
    terms[c.local] += std::abs(c.a * data[c.fixed]);
  }
  const Real total_load = norm_D(*system_, increment.F);
  if (u_old.size() > 0) {
    const Vector x_old = to_local(u_old);
    increment.F.noalias() -= system_->A * x_old;
    terms += magnitude(system_->A, x_old);
  }
  increment.rounding = std::numeric_limits<Real>::epsilon() * norm_D(*system_, terms);
  result.u0 = u_old.size() > 0 ? u_old : Vector(Vector::Zero(b.size()));
  for (Index k = 0; k < fixed_dofs(); ++k) result.u0[fixed_[k].dof] = data[k];

  increment.gap = gap_left(laws.gap, result.u0);
  increment.law = laws.law;
  increment.bilateral = laws.bilateral;
  increment.force_scale = std::max(total_load, driving_norm(*system_, increment));
  if (increment.force_scale == 0) increment.force_scale = 1;
  if (laws.law == Law::frictionless) return result;
  Vector& coefficient = laws.law == Law::coulomb ? increment.mu : increment.g;
  coefficient.resize(nodes());
  for (Index k = 0; k < nodes(); ++k) coefficient[k] = laws.friction[frames_[k].point];
  return result;
}

Vector LocalSystem::to_local(const Vector& u) const {
  Vector x = Vector::Zero(static_cast<Index>(original_.size()));
  for (Index i = 0; i < u.size(); ++i)
    for_each_image<Direction::to_frame>(i, [&](Index p, Real Q) { x[p] += Q * u[i]; });
  return x;
}

Vector LocalSystem::load_to_local(const Vector& b) const {
  Vector F = Vector::Zero(static_cast<Index>(original_.size()));
  for (Index i = 0; i < b.size(); ++i)
    for_each_image(i, [&](Index p, Real Q) { F[p] += Q * b[i]; });
  return F;
}

Vector LocalSystem::to_global(const Vector& x, const Vector& u0) const {
  Vector u = u0;
  for (Index i = 0; i < u.size(); ++i)
    for_each_image(i, [&](Index p, Real Q) { u[i] += Q * x[p]; });
  return u;
}

Vector LocalSystem::force_to_global(const Vector& r) const {
  Vector force = Vector::Zero(static_cast<Index>(image_.size()));
  for (const Frame& f : frames_)
    for (int c = 0; c < d_; ++c)
      for_each_image<Direction::to_frame>(points_[f.point].dof[c], [&](Index p, Real Q) {
        if (p >= system_->interior()) force[points_[f.point].dof[c]] -= Q * r[p];
      });
  return force;
}

}  // namespace frictioncg
