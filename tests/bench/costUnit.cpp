// A FreeFEM plugin of the benchmarks: what one linear solve, and one product, with the same matrix
// cost.
//   real[int] t = linearSolve(A, b, Vh, label);
//     CPU seconds of CHOLMOD on one thread, analyse + factor + solve: the best, with AMD, with
//     METIS; of one product A x; the peak memory of the best [MB]; and of FreeFEM's own
//     solver="CHOLMOD", sym=1, positive=1 on the matrix of the script, as FreeFEM numbers it
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
//   real t = wallTime();     [s], FreeFEM's time() counts whole seconds
//   real m = peakMemory(reset);  peak memory of the process since the last reset [MB]

// FreeFEM's solver class, in its headers, asks for what FreeFEM was configured with.
#define HAVE_LIBUMFPACK
#define HAVE_SUITESPARSE_UMFPACK_H

#include "on_scene.h"

#include "core/condensed/cholmod_elimination.h"
#include "core/condensed/serial.h"

#include <cholmod.h>

#include <chrono>
#include <fstream>
#include <utility>

using namespace frictioncg;

namespace {

double peak_megabytes(bool reset) {
  std::ifstream status("/proc/self/status");
  std::string line;
  double peak = 0;
  while (std::getline(status, line))
    if (line.rfind("VmHWM:", 0) == 0) peak = std::atof(line.c_str() + 6) / 1024;
  if (reset) std::ofstream("/proc/self/clear_refs") << "5";
  return peak;
}

/// CHOLMOD as a user would call it: on the dofs, supernodal. The contact dofs get half their
/// diagonal added, without which a body held by contact alone has no factor.
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

/// CPU seconds of FreeFEM's own solver="CHOLMOD", sym=1, positive=1, with its defaults.
double freefem_solve_seconds(HashMatrix<int, double>& H) {
  Vector b = Vector::Ones(H.n), x = Vector::Zero(H.n);
  Data_Sparse_Solver defaults;
  const double start = cpu_seconds();
  VirtualSolverCHOLMOD<int, double> solver(H, defaults, nullptr);
  solver.fac_symbolic();
  solver.fac_numeric();
  solver.dosolver(x.data(), b.data(), 1, 0);
  return cpu_seconds() - start;
}

/// The script's own matrix, or that of two bodies, which no script has: with springs on the contact
/// dofs.
std::unique_ptr<HashMatrix<int, double>> with_springs(const PosedScene& posed) {
  const System& p = posed.system();
  if (!posed.scene.pairing) {
    auto H = std::make_unique<HashMatrix<int, double>>(posed.A);
    for (Index k = 0; k < posed.scene.system->nodes(); ++k)
      for (int c = 0; c < posed.scene.d; ++c) {
        const int dof = posed.scene.contact_point(k).point.dof[c];
        (*H)(dof, dof) *= 1.5;
      }
    return H;
  }
  const Matrix& A = p.entries();
  const int n = p.dofs();
  auto H = std::make_unique<HashMatrix<int, double>>(n, n, A.nonZeros(), 1);
  for (int j = 0; j < n; ++j)
    for (Matrix::InnerIterator it(A, j); it; ++it)
      if (it.index() >= j)
        (*H)(int(it.index()), j) = it.value() * (it.index() == j && j >= p.interior() ? 1.5 : 1);
  return H;
}

struct LinearSolve {
  static constexpr const char* name = "linearSolve";
  using Result = KN_<double>;
  static Result run(Stack stack, const PosedScene& posed) {
    const System& p = posed.system();
    KN<double>* t = Add2StackOfPtr2Free(stack, new KN<double>(6));
    const Serial serial;
    peak_megabytes(true);
    (*t)[1] = cholmod_solve_seconds(p, posed.increment.F, CHOLMOD_AMD);
    const double with_amd = peak_megabytes(true);
    (*t)[2] = cholmod_solve_seconds(p, posed.increment.F, CHOLMOD_METIS);
    const double with_metis = peak_megabytes(true);
    const auto H = with_springs(posed);
    peak_megabytes(true);
    (*t)[5] = freefem_solve_seconds(*H);
    const double with_freefem = peak_megabytes(true);
    (*t)[0] = std::min({(*t)[1], (*t)[2], (*t)[5]});
    Vector x = Vector::Ones(p.dofs()), y(p.dofs());
    const int products = 1 + static_cast<int>(2e8 / (1 + p.entries().nonZeros()));
    const double start = cpu_seconds();
    for (int k = 0; k < products; ++k) {
      y.noalias() = p.entries() * x;
      x[k % p.dofs()] += 1e-9 * y[0];
    }
    (*t)[3] = (cpu_seconds() - start) / products;
    (*t)[4] = (*t)[0] == (*t)[1] ? with_amd : (*t)[0] == (*t)[2] ? with_metis : with_freefem;
    return *t;
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
    CholmodElimination elimination;
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
    CholmodElimination elimination;
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

double peak_memory(const long& reset) { return peak_megabytes(reset != 0); }

void load() {
  add_on_scene<LinearSolve>();
  add_on_scene<AttainableResidual, KN_<double>>();
  add_on_scene<ExportSystem, string*, KN_<double>>();
  add_on_scene<FrictionlessSolve, KN_<double>>();
  Global.Add(
      "energyError", "(",
      new OneOperator3_<double, Matrice_Creuse<double>*, KN_<double>, KN_<double>>(energy_error));
  Global.Add("wallTime", "(", new OneOperator0<double>(wall_time));
  Global.Add("peakMemory", "(", new OneOperator1_<double, long>(peak_memory));
}

}  // namespace

LOADFUNC(load)
