// A FreeFEM plugin of the benchmarks: what one linear solve with the same matrix costs.
//   real unit = linearSolve(A, b, Vh, label);
//     CPU seconds of CHOLMOD on one thread, analyse + factor + solve: the least of AMD, METIS, and
//     FreeFEM's own solver="CHOLMOD", sym=1, positive=1 on the matrix of the script, as FreeFEM
//     numbers it
//   threads(n);  1: one thread, of CHOLMOD as of the BLAS; 0: as many as users have by default
//   real t = wallTime();     [s], FreeFEM's time() counts whole seconds
//   real a = attainableResidual(A, b, Vh, label, u);
//     the certificate that rounding allows at u: eps_machine ||A||u|| in its norm
//   real e = energyError(A, u, v);
//     |u - v| over |v| in the energy norm of the dofs that no Dirichlet condition holds
//   real t = exportSystem(A, b, Vh, label, file, u, mu=.., gap=..);
//     writes the contact problem in local frames, its condensed form, and u for the peers; CPU
//     seconds of the condensation
//   real t = frictionlessSolve(A, b, Vh, label, u);
//     CPU seconds of the same frictionless scene without any code for friction: copy, factor,
//     active set on S, back-substitution, residual; u becomes the field

// FreeFEM's solver class, in its headers, asks for what FreeFEM was configured with.
#define HAVE_LIBUMFPACK
#define HAVE_SUITESPARSE_UMFPACK_H

#include "on_scene.h"

#include "core/condensed/elimination.h"
#include "core/threads.h"

#include <cholmod.h>

#include <chrono>
#include <fstream>
#include <utility>

using namespace frictioncg;

extern "C" {
void openblas_set_num_threads(int n) __attribute__((weak));
int openblas_get_num_procs() __attribute__((weak));
}

namespace {

/// CPU seconds of CHOLMOD with this ordering: on the dofs, supernodal. The contact dofs get half
/// their diagonal added, without which a body held by contact alone has no factor.
double cholmod_solve_seconds(const System& p, const Vector& F, int ordering) {
  Matrix half = p.entries().triangularView<Eigen::Lower>();
  for (Index i = p.interior(); i < p.dofs(); ++i) half.coeffRef(i, i) *= 1.5;
  cholmod_common common;
  cholmod_start(&common);
  common.supernodal = CHOLMOD_SUPERNODAL;
  common.print = 0;
  common.nmethods = 1;
  common.method[0].ordering = ordering;
  cholmod_sparse A{};
  A.nrow = A.ncol = p.dofs();
  A.nzmax = half.nonZeros();
  A.p = half.outerIndexPtr();
  A.i = half.innerIndexPtr();
  A.x = half.valuePtr();
  A.stype = 1;
  A.itype = CHOLMOD_INT;
  A.xtype = CHOLMOD_REAL;
  A.dtype = CHOLMOD_DOUBLE;
  A.sorted = A.packed = 1;
  cholmod_dense b{};
  b.nrow = b.d = b.nzmax = p.dofs();
  b.ncol = 1;
  b.x = const_cast<Real*>(F.data());
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  const double start = cpu_seconds();
  cholmod_factor* L = cholmod_analyze(&A, &common);
  cholmod_factorize(&A, L, &common);
  cholmod_dense* x = cholmod_solve(CHOLMOD_A, L, &b, &common);
  const double seconds = cpu_seconds() - start;
  cholmod_free_dense(&x, &common);
  cholmod_free_factor(&L, &common);
  cholmod_finish(&common);
  return seconds;
}

/// Half of the script's own matrix, or of that of two bodies, which no script has, with springs on
/// the contact dofs. Half, as a form assembles it for this solver: from a full matrix, FreeFEM 4.11
/// hands CHOLMOD one that is not A.
HashMatrix<int, double> with_springs(const PosedScene& posed) {
  const System& p = posed.system();
  const HashMatrix<int, double>& A = posed.A;
  const bool two_bodies = posed.scene.pairing.has_value();
  const int n = two_bodies ? p.dofs() : A.n;
  HashMatrix<int, double> H(n, n, A.nnz, 1);
  const auto add = [&](int i, int j, double a) {
    if (i >= j) H(i, j) = a;
  };
  if (two_bodies) {
    for (int j = 0; j < n; ++j)
      for (Matrix::InnerIterator it(p.entries(), j); it; ++it) add(int(it.index()), j, it.value());
    for (int i = p.interior(); i < n; ++i) H(i, i) *= 1.5;
    return H;
  }
  for (std::size_t k = 0; k < A.nnz; ++k) add(A.i[k], A.j[k], A.aij[k]);
  for (Index k = 0; k < posed.scene.system->nodes(); ++k)
    for (int c = 0; c < posed.scene.d; ++c) {
      const int dof = posed.scene.contact_point(k).point.dof[c];
      H(dof, dof) *= 1.5;
    }
  return H;
}

/// CPU seconds of FreeFEM's own solver="CHOLMOD", sym=1, positive=1, whose answer is right.
double freefem_solve_seconds(HashMatrix<int, double>& H) {
  Vector b = Vector::Ones(H.n), x = Vector::Zero(H.n);
  Data_Sparse_Solver defaults;
  const double start = cpu_seconds();
  VirtualSolverCHOLMOD<int, double> solver(H, defaults, nullptr);
  solver.fac_symbolic();
  solver.fac_numeric();
  solver.dosolver(x.data(), b.data(), 1, 0);
  const double seconds = cpu_seconds() - start;
  Vector r = b, size = b;
  const auto subtract = [&](int i, double ax) {
    r[i] -= ax;
    size[i] += std::abs(ax);
  };
  for (std::size_t k = 0; k < H.nnz; ++k) {
    subtract(H.i[k], H.aij[k] * x[H.j[k]]);
    if (H.i[k] != H.j[k]) subtract(H.j[k], H.aij[k] * x[H.i[k]]);
  }
  if (!(r.lpNorm<Eigen::Infinity>() <= 1e-12 * size.maxCoeff()))
    throw std::runtime_error("FreeFEM's CHOLMOD has not solved A x = b");
  return seconds;
}

struct LinearSolve {
  static constexpr const char* name = "linearSolve";
  using Result = double;
  static Result run(Stack, const PosedScene& posed) {
    const Threads one;
    auto H = with_springs(posed);
    return std::min({cholmod_solve_seconds(posed.system(), posed.increment.F, CHOLMOD_AMD),
                     cholmod_solve_seconds(posed.system(), posed.increment.F, CHOLMOD_METIS),
                     freefem_solve_seconds(H)});
  }
};

/// eps_machine | |A| |x| | over the norm of the load, both in the norm of D^{-1/2}.
struct AttainableResidual {
  static constexpr const char* name = "attainableResidual";
  using Result = double;
  static Result run(Stack, const PosedScene& posed, KN_<double> u) {
    const System& p = posed.system();
    const Vector x = posed.local(u);
    const Vector size = p.entries().cwiseAbs() * x.cwiseAbs();
    return std::numeric_limits<double>::epsilon() * norm_D(p, size) / posed.increment.force_scale;
  }
};

double energy_error(Matrice_Creuse<double>* const& A, const KN_<double>& u, const KN_<double>& v) {
  HashMatrix<int, double>* H = A->pHM();
  Vector diagonal = Vector::Zero(H->n);
  for (std::size_t k = 0; k < H->nnz; ++k)
    if (H->i[k] == H->j[k]) diagonal[H->i[k]] += H->aij[k];
  const auto is_free = [&](Index i) { return diagonal[i] < 1e20; };
  double error = 0, size = 0;
  for (std::size_t k = 0; k < H->nnz; ++k) {
    const Index i = H->i[k], j = H->j[k];
    if (!is_free(i) || !is_free(j)) continue;
    const double twice = H->half && i != j ? 2 : 1;
    error += twice * H->aij[k] * (u[i] - v[i]) * (u[j] - v[j]);
    size += twice * H->aij[k] * v[i] * v[j];
  }
  return std::sqrt(std::max(error, 0.0) / size);
}

/// Little-endian arrays, each with its length before it as a 64-bit integer.
class ArrayFile {
 public:
  explicit ArrayFile(const std::string& name) : out_(name, std::ios::binary) {}
  template <class T>
  void write(const T* values, std::int64_t size) {
    out_.write(reinterpret_cast<const char*>(&size), sizeof size);
    out_.write(reinterpret_cast<const char*>(values), size * sizeof(T));
  }

 private:
  std::ofstream out_;
};

struct ExportSystem {
  static constexpr const char* name = "exportSystem";
  using Result = double;
  static Result run(Stack, const PosedScene& posed, string* file, KN_<double> u) {
    const System& p = posed.system();
    const Vector x = posed.local(u);
    const double start = cpu_seconds();
    Elimination elimination;
    elimination.factor(p, 1e11);
    const Vector f = elimination.condense(posed.increment.F);
    const double seconds = cpu_seconds() - start;
    ArrayFile out(*file);
    const Index head[] = {p.dimension, p.dofs(), p.nodes()};
    const Vector mu =
        posed.increment.law == Law::coulomb ? posed.increment.mu : Vector::Zero(p.nodes());
    out.write(head, 3);
    out.write(p.entries().outerIndexPtr(), p.dofs() + 1);
    out.write(p.entries().innerIndexPtr(), p.entries().nonZeros());
    out.write(p.entries().valuePtr(), p.entries().nonZeros());
    out.write(posed.increment.F.data(), p.dofs());
    out.write(p.first.data(), p.nodes() + 1);
    out.write(posed.increment.gap.data(), p.nodes());
    out.write(mu.data(), p.nodes());
    out.write(x.data(), p.dofs());
    out.write(elimination.S().data(), elimination.S().size());
    out.write(f.data(), f.size());
    return seconds;
  }
};

/// Unilateral contact alone, S x = f - r: primal-dual active set, no friction anywhere.
Vector obstacle_on_S(const DenseMatrix& S, const Vector& f, const Vector& D, const Vector& gap) {
  const Index m = static_cast<Index>(f.size());
  std::vector<char> closed(m, 1);
  Vector x;
  for (int step = 0; step < 40; ++step) {
    std::vector<Index> open;
    x = Vector::Zero(m);
    for (Index i = 0; i < m; ++i) {
      if (closed[i])
        x[i] = gap[i];
      else
        open.push_back(i);
    }
    const Vector rhs = f - S * x;
    const Index n = static_cast<Index>(open.size());
    DenseMatrix M(n, n);
    Vector y(n);
    for (Index q = 0; q < n; ++q) {
      y[q] = rhs[open[q]];
      for (Index p = 0; p < n; ++p) M(p, q) = S(open[p], open[q]);
    }
    if (n > 0) Eigen::LLT<Eigen::Ref<DenseMatrix>>(M).solveInPlace(y);
    for (Index q = 0; q < n; ++q) x[open[q]] = y[q];
    const Vector r = f - S * x;
    bool same = true;
    for (Index i = 0; i < m; ++i) {
      const char now = r[i] + D[i] * (x[i] - gap[i]) > 0;
      same &= now == closed[i];
      closed[i] = now;
    }
    if (same) break;
  }
  return x;
}

struct FrictionlessSolve {
  static constexpr const char* name = "frictionlessSolve";
  using Result = double;
  static Result run(Stack, const PosedScene& posed, KN_<double> u) {
    const double start = cpu_seconds();
    const System& p = posed.system();
    Elimination elimination;
    elimination.factor(p, 1e11);
    const Vector x =
        elimination.recover(obstacle_on_S(elimination.S(), elimination.condense(posed.increment.F),
                                          p.D.tail(p.contact_dofs()), posed.increment.gap));
    const Vector r = posed.increment.F - p.entries() * x;
    const Vector field = posed.scene.system->to_global(x, posed.u0);
    for (Index i = 0; i < posed.scene.ndof(); ++i) u[i] = field[i];
    return posed.scene.copy_seconds + cpu_seconds() - start + 0 * r[0];
  }
};

double wall_time() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

long threads(const long& n) {
  if (openblas_set_num_threads) openblas_set_num_threads(n == 0 ? openblas_get_num_procs() : n);
  if (omp_set_max_active_levels) omp_set_max_active_levels(n == 1 ? 0 : 1);
  return n;
}

void load() {
  add_on_scene<LinearSolve>();
  add_on_scene<AttainableResidual, KN_<double>>();
  add_on_scene<ExportSystem, string*, KN_<double>>();
  add_on_scene<FrictionlessSolve, KN_<double>>();
  Global.Add(
      "energyError", "(",
      new OneOperator3_<double, Matrice_Creuse<double>*, KN_<double>, KN_<double>>(energy_error));
  Global.Add("wallTime", "(", new OneOperator0<double>(wall_time));
  Global.Add("threads", "(", new OneOperator1_<long, long>(threads));
}

}  // namespace

LOADFUNC(load)
