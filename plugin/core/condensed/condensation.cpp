#include "condensed/condensation.h"

#include <algorithm>
#include <stdexcept>

#include "clock.h"

namespace frictioncg {

namespace {

constexpr Real sigma = 0.5;

/// CHOLMOD's view of the upper triangle of a symmetric matrix, or of its pattern (value null).
cholmod_sparse symmetric_view(Index n, std::vector<Index>& column, std::vector<Index>& row,
                              Real* value) {
  cholmod_sparse view{};
  view.nrow = view.ncol = n;
  view.nzmax = row.size();
  view.p = column.data();
  view.i = row.data();
  view.x = value;
  view.stype = 1;
  view.itype = CHOLMOD_INT;
  view.xtype = value ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = value != nullptr;  // the rows of a pattern come as the graph was walked
  view.packed = 1;
  return view;
}

/// Rows of A up to the diagonal: by columns, the upper triangle that CHOLMOD reads. The contact
/// dofs, last, get the shift, and are chained by entries (zero if need be) next to the diagonal: so
/// each is the parent of the one before in the elimination tree. `roots` are interior dofs that
/// shall be children of the first contact dof.
struct UpperTriangle {
  std::vector<Index> column, row;
  std::vector<Real> value;
  cholmod_sparse view{};

  explicit UpperTriangle(const System& s, const std::vector<Index>& roots = {}) {
    const Index n = s.dofs(), interior = s.interior();
    const Index* begin = s.A.outerIndexPtr();
    const Index* col = s.A.innerIndexPtr();
    const Real* a = s.A.valuePtr();
    column.reserve(n + 1);
    row.reserve(s.A.nonZeros() / 2 + n);
    value.reserve(s.A.nonZeros() / 2 + n);
    column.push_back(0);
    for (Index j = 0; j < n; ++j) {
      for (Index k = begin[j]; k < begin[j + 1] && col[k] < j; ++k) {
        row.push_back(col[k]);
        value.push_back(a[k]);
      }
      if (j == interior) insert(roots);
      if (j > interior && (row.size() == std::size_t(column[j]) || row.back() != j - 1)) {
        row.push_back(j - 1);
        value.push_back(0);
      }
      row.push_back(j);
      value.push_back(j < interior ? s.D[j] : (1 + sigma) * s.D[j]);
      column.push_back(static_cast<Index>(row.size()));
    }
    view = symmetric_view(n, column, row, value.data());
  }

 private:
  /// Zero entries in these rows of the column under construction, which stays sorted.
  void insert(const std::vector<Index>& rows) {
    for (Index r : rows) {
      const auto begin = row.begin() + column.back();
      const auto at = std::lower_bound(begin, row.end(), r);
      if (at != row.end() && *at == r) continue;
      value.insert(value.begin() + (at - row.begin()), 0);
      row.insert(at, r);
    }
  }
};

/// The graph of the mesh nodes: its upper triangle by columns, and the dofs of each node.
struct NodeGraph {
  std::vector<Index> column, row;
  std::vector<Index> first_dof;  ///< nodes + 1, into dofs
  std::vector<Index> dofs;
  Index interior = 0;  ///< nodes with interior dofs; contact nodes follow
  cholmod_sparse view{};

  explicit NodeGraph(const System& s) {
    const Index n = s.dofs();
    std::vector<Index> node_of(n);
    number_nodes(s, node_of);
    const Index nodes = static_cast<Index>(first_dof.size()) - 1;
    const Index* begin = s.A.outerIndexPtr();
    const Index* col = s.A.innerIndexPtr();
    std::vector<Index> seen_by(nodes, -1);
    column.reserve(nodes + 1);
    column.push_back(0);
    for (Index v = 0; v < nodes; ++v) {
      for (Index k = first_dof[v]; k < first_dof[v + 1]; ++k)
        for (Index e = begin[dofs[k]]; e < begin[dofs[k] + 1]; ++e) {
          const Index w = node_of[col[e]];
          if (w >= v || seen_by[w] == v) continue;
          seen_by[w] = v;
          row.push_back(w);
        }
      column.push_back(static_cast<Index>(row.size()));
    }
    view = symmetric_view(nodes, column, row, nullptr);
  }

  void restrict_to_interior() {
    view.nrow = view.ncol = interior;
    view.nzmax = column[interior];
  }

 private:
  void number_nodes(const System& s, std::vector<Index>& node_of) {
    const Index n = s.dofs();
    Index nodes = 0;
    if (s.mesh_node.empty()) {
      for (Index i = 0; i < s.interior(); ++i) node_of[i] = nodes++;
    } else {
      std::vector<Index> number(*std::max_element(s.mesh_node.begin(), s.mesh_node.end()) + 1, -1);
      for (Index i = 0; i < s.interior(); ++i) {
        Index& k = number[s.mesh_node[i]];
        if (k < 0) k = nodes++;
        node_of[i] = k;
      }
    }
    interior = nodes;
    for (Index c = 0; c < s.nodes(); ++c, ++nodes)
      for (Index i = s.first[c]; i < s.first[c + 1]; ++i) node_of[i] = nodes;
    first_dof.assign(nodes + 1, 0);
    for (Index i = 0; i < n; ++i) ++first_dof[node_of[i] + 1];
    for (Index v = 0; v < nodes; ++v) first_dof[v + 1] += first_dof[v];
    dofs.resize(n);
    std::vector<Index> at(first_dof.begin(), first_dof.end() - 1);
    for (Index i = 0; i < n; ++i) dofs[at[node_of[i]]++] = i;
  }
};

void check(bool ok, const cholmod_common& common) {
  if (ok) return;
  if (common.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
  throw std::runtime_error("CHOLMOD failed with status " + std::to_string(common.status));
}

/// A permutation of the dofs with little fill-in, the contact dofs last and in their order.
std::vector<Index> contact_last(const System& s, Ordering ordering, cholmod_common& common) {
  NodeGraph graph(s);
  const Index nodes = static_cast<Index>(graph.first_dof.size()) - 1;
  std::vector<Index> order(nodes);
  int ok = 1;
  if (graph.interior == 0) {
    // all dofs are contact dofs
  } else if (ordering == Ordering::camd) {
    std::vector<Index> member(nodes, 0);
    std::fill(member.begin() + graph.interior, member.end(), 1);
    ok = cholmod_camd(&graph.view, nullptr, 0, member.data(), order.data(), &common);
  } else {
    graph.restrict_to_interior();
    ok = ordering == Ordering::amd
             ? cholmod_amd(&graph.view, nullptr, 0, order.data(), &common)
             : cholmod_metis(&graph.view, nullptr, 0, 0, order.data(), &common);
  }
  check(ok, common);
  std::vector<Index> dofs;
  dofs.reserve(s.dofs());
  for (Index v = 0; v < graph.interior; ++v)
    for (Index k = graph.first_dof[order[v]]; k < graph.first_dof[order[v] + 1]; ++k)
      dofs.push_back(graph.dofs[k]);
  for (Index i = s.interior(); i < s.dofs(); ++i) dofs.push_back(i);
  return dofs;
}

/// In each connected part of the interior, the dof eliminated last: the root of its tree.
std::vector<Index> last_of_each_body(const System& s, const std::vector<Index>& order) {
  const Index* row = s.A.outerIndexPtr();
  const Index* col = s.A.innerIndexPtr();
  std::vector<char> seen(s.interior(), 0);
  std::vector<Index> roots, stack;
  for (Index k = s.interior() - 1; k >= 0; --k) {
    if (seen[order[k]]) continue;
    roots.push_back(order[k]);
    stack.assign(1, order[k]);
    seen[order[k]] = 1;
    while (!stack.empty()) {
      const Index i = stack.back();
      stack.pop_back();
      for (Index e = row[i]; e < row[i + 1] && col[e] < s.interior(); ++e)
        if (!seen[col[e]]) {
          seen[col[e]] = 1;
          stack.push_back(col[e]);
        }
    }
  }
  return roots;
}

}  // namespace

Condensation::Condensation() {
  cholmod_start(&common_);
  common_.print = 0;
  common_.try_catch = 1;
  common_.supernodal = CHOLMOD_SUPERNODAL;
  common_.final_ll = 1;
  common_.nmethods = 1;
  common_.method[0].ordering = CHOLMOD_GIVEN;
}

Condensation::~Condensation() {
  release();
  cholmod_finish(&common_);
}

void Condensation::release() {
  cholmod_free_factor(&L_, &common_);
  cholmod_free_dense(&X_, &common_);
  cholmod_free_dense(&Y_, &common_);
  cholmod_free_dense(&E_, &common_);
}

double Condensation::factor_bytes() const {
  return L_ ? double(sizeof(Real)) * double(L_->xsize) : 0;
}

Condensation::Outcome Condensation::factor(const System& system, double memory_bound,
                                           Ordering ordering) {
  release();
  times_ = {};
  n_ = system.dofs();
  interior_ = system.interior();
  const double contact = system.contact_dofs();
  const double dense = 3 * sizeof(Real) * contact * contact;
  if (dense > memory_bound) return Outcome::too_large;

  double start = cpu_seconds();
  UpperTriangle A(system);
  // Measured on blocks (2D to 800 k dofs, 3D to 100 k), against CHOLMOD's best plain solve: minimum
  // degree with constraints 0.7 in 2D but 1.6 in 3D, nested dissection 0.9 and 1.1; minimum degree
  // of the interior alone fills more than either.
  if (ordering == Ordering::automatic)
    ordering = system.dimension == 2 ? Ordering::camd : Ordering::metis;
  const std::vector<Index> order = contact_last(system, ordering, common_);
  const auto analyze = [&] {
    L_ = cholmod_analyze_p(&A.view, const_cast<Index*>(order.data()), nullptr, 0, &common_);
    const bool fits = common_.status != CHOLMOD_TOO_LARGE;  // CHOLMOD indexes the factor by 32 bits
    if (fits) check(L_ != nullptr, common_);
    return fits;
  };
  if (!analyze()) return Outcome::too_large;
  if (!contact_is_last()) {
    // Several bodies: a postordering may end one body, its contact included, before the next.
    A = UpperTriangle(system, last_of_each_body(system, order));
    cholmod_free_factor(&L_, &common_);
    if (!analyze()) return Outcome::too_large;
    if (!contact_is_last())
      throw std::logic_error("condensation: the contact dofs are not last in the factor");
  }
  times_.order = cpu_seconds() - start;
  if (factor_bytes() + dense > memory_bound) return Outcome::too_large;

  start = cpu_seconds();
  const int ok = cholmod_factorize(&A.view, L_, &common_);
  if (common_.status == CHOLMOD_NOT_POSDEF) return Outcome::not_positive_definite;
  check(ok, common_);
  times_.factor = cpu_seconds() - start;

  start = cpu_seconds();
  read_trailing_block();
  multiply_by_transpose();
  S_.diagonal() -= sigma * system.D.tail(system.contact_dofs());
  times_.condense = cpu_seconds() - start;
  return Outcome::done;
}

bool Condensation::contact_is_last() const {
  for (Index i = interior_; i < n_; ++i)
    if (static_cast<const Index*>(L_->Perm)[i] != i) return false;
  return true;
}

/// Visits the entries (row, column, value) of L_CC, by the supernodes that end in the contact dofs.
template <class Visit>
void Condensation::for_each_trailing(Visit visit) const {
  const Index* super = static_cast<Index*>(L_->super);
  const Index* pi = static_cast<Index*>(L_->pi);
  const Index* px = static_cast<Index*>(L_->px);
  const Index* s = static_cast<Index*>(L_->s);
  const Real* x = static_cast<Real*>(L_->x);
  for (Index k = static_cast<Index>(L_->nsuper) - 1; k >= 0 && super[k + 1] > interior_; --k) {
    const Index rows = pi[k + 1] - pi[k];
    for (Index j = std::max(super[k], interior_); j < super[k + 1]; ++j)
      for (Index q = j - super[k]; q < rows; ++q)
        visit(s[pi[k] + q] - interior_, j - interior_, x[px[k] + q + (j - super[k]) * rows]);
  }
}

void Condensation::read_trailing_block() {
  S_.setZero(n_ - interior_, n_ - interior_);
  for_each_trailing([this](Index i, Index j, Real l) { S_(i, j) = l; });
}

/// S := S S' in place, S lower triangular: a column of the product needs the columns up to its own,
/// so the last goes first.
void Condensation::multiply_by_transpose() {
  const Index n = static_cast<Index>(S_.rows());
  constexpr Index block = 64;
  DenseMatrix panel;
  for (Index end = n; end > 0;) {
    const Index begin = std::max(0, end - block), width = end - begin;
    panel.noalias() =
        S_.block(begin, 0, n - begin, end) * S_.block(begin, 0, width, end).transpose();
    S_.block(begin, begin, n - begin, width) = panel;
    end = begin;
  }
  S_.triangularView<Eigen::StrictlyUpper>() = S_.transpose();
}

Vector Condensation::solve(int triangle, const Vector& rhs) {
  cholmod_dense b{};
  b.nrow = b.d = b.nzmax = n_;
  b.ncol = 1;
  b.x = const_cast<Real*>(rhs.data());
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  // cholmod_solve2 would make its own, but goes on without where there is no memory
  const auto ensure = [this](cholmod_dense*& workspace, std::size_t rows) {
    check(cholmod_ensure_dense(&workspace, rows, 1, rows, CHOLMOD_REAL, &common_), common_);
  };
  ensure(X_, n_);
  ensure(Y_, n_);
  ensure(E_, L_->maxesize);
  check(cholmod_solve2(triangle, L_, &b, nullptr, &X_, nullptr, &Y_, &E_, &common_), common_);
  return Eigen::Map<const Vector>(static_cast<Real*>(X_->x), n_);
}

Vector Condensation::reduce(const Vector& F) {
  y_ = solve(CHOLMOD_L, solve(CHOLMOD_P, F));
  Vector f = Vector::Zero(n_ - interior_);
  for_each_trailing([&](Index i, Index j, Real l) { f[i] += l * y_[interior_ + j]; });
  return f;
}

Vector Condensation::expand(const Vector& x_C) {
  Vector y = y_;
  y.tail(n_ - interior_).setZero();
  for_each_trailing([&](Index i, Index j, Real l) { y[interior_ + j] += l * x_C[i]; });
  return solve(CHOLMOD_Pt, solve(CHOLMOD_Lt, y));
}

}  // namespace frictioncg
