// A FreeFEM plugin of the benchmarks: what one linear solve, and one product, with the same matrix
// cost.
//   real[int] t = linearSolve(A, b, Vh, label);
//     CPU seconds of CHOLMOD, analyse + factor + solve: the best, with AMD, with METIS; of one
//     product A x; the peak memory of the best [MB]; and of FreeFEM's own solver=CHOLMOD
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
//   real m = peakMemory(reset);  peak memory of the process since the last reset [MB]

// FreeFEM's solver class, in its headers, asks for what FreeFEM was configured with.
#define HAVE_LIBUMFPACK
#define HAVE_SUITESPARSE_UMFPACK_H

#include "../../plugin/freefem/call.h"
#include "../../plugin/freefem/errors.h"
#include "../../plugin/freefem/operators.h"

#include "core/condensed/cholmod_elimination.h"

#include <cholmod.h>

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
  Matrix half = p.A.triangularView<Eigen::Lower>();
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

/// The same by FreeFEM's own solver="CHOLMOD", sym=1, positive=1, with its defaults.
double freefem_solve_seconds(const System& p, const Vector& F) {
  const Index n = p.dofs();
  HashMatrix<int, double> H(static_cast<int>(n), static_cast<int>(n), p.A.nonZeros(), 1);
  for (Index j = 0; j < n; ++j)
    for (Matrix::InnerIterator it(p.A, j); it; ++it)
      if (it.index() >= j)
        H(static_cast<int>(it.index()), static_cast<int>(j)) =
            it.value() * (it.index() == j && j >= p.interior() ? 1.5 : 1);
  Vector b = F, x = Vector::Zero(n);
  Data_Sparse_Solver defaults;
  const double start = cpu_seconds();
  VirtualSolverCHOLMOD<int, double> solver(H, defaults, nullptr);
  solver.fac_symbolic();
  solver.fac_numeric();
  solver.dosolver(x.data(), b.data(), 1, 0);
  return cpu_seconds() - start;
}

/// A scene under its load.
struct PosedScene {
  Scene& scene;
  const Increment& increment;
  const Vector& u0;
  const System& system() const { return *scene.system->system(); }
  Vector local(const KN_<double>& u) const {
    const Vector field = copy_of(u);
    check_vector(field, "u", scene.dofs);
    return scene.system->to_local(field);
  }
};

/// name(A, b, site, extra ..., mu=.., gap=..): poses the contact problem, and hands it to
/// Body::run(stack, posed, extra ...).
template <class Body, class... Extra>
class OnScene : public E_F0mps {
 public:
  using Result = typename Body::Result;
  /// next: the first of the extra arguments
  OnScene(const basicAC_F0& args, std::shared_ptr<const Site> site, int next)
      : arguments_(args, site->dimension(), site->two_bodies()),
        A_(to<Matrice_Creuse<double>*>(args[0])),
        b_(to<KN_<double>>(args[1])),
        site_(std::move(site)) {
    (extra_.push_back(to<Extra>(args[next++])), ...);
  }
  AnyType operator()(Stack stack) const override {
    return translated(Body::name, [&] {
      const Call call(stack, arguments_, b_);
      PointLaws laws;
      const auto scene = read_scene(stack, arguments_, A_, *site_, true, laws);
      const LocalIncrement now = increment(call, *scene, laws);
      return SetAny<Result>(
          run(stack, {*scene, now.increment, now.u0}, std::index_sequence_for<Extra...>()));
    });
  }

 private:
  template <std::size_t... k>
  Result run(Stack stack, const PosedScene& posed, std::index_sequence<k...>) const {
    return Body::run(stack, posed, GetAny<Extra>((*extra_[k])(stack))...);
  }

  Arguments arguments_;
  Expression A_, b_;
  std::shared_ptr<const Site> site_;
  std::vector<Expression> extra_;
};

template <class Body, class... Extra>
void add_on_site(const std::vector<aType>& site, const MakeSite& make) {
  std::vector<aType> types = SolveOnce::before_site();
  const int first = static_cast<int>(types.size());
  types.insert(types.end(), site.begin(), site.end());
  const int next = static_cast<int>(types.size());
  (types.push_back(atype<Extra>()), ...);
  Global.Add(Body::name, "(",
             new Overload(atype<typename Body::Result>(), types, [=](const basicAC_F0& args) {
               return new OnScene<Body, Extra...>(args, make(args, first), next);
             }));
}

template <class Body, class... Extra>
void add_on_scene() {
  for_each_site<v_fes>(add_on_site<Body, Extra...>);
  for_each_site<v_fes3>(add_on_site<Body, Extra...>);
}

struct LinearSolve {
  static constexpr const char* name = "linearSolve";
  using Result = KN_<double>;
  static Result run(Stack stack, const PosedScene& posed) {
    const System& p = posed.system();
    KN<double>* t = Add2StackOfPtr2Free(stack, new KN<double>(6));
    peak_megabytes(true);
    (*t)[1] = cholmod_solve_seconds(p, posed.increment.F, CHOLMOD_AMD);
    const double with_amd = peak_megabytes(true);
    (*t)[2] = cholmod_solve_seconds(p, posed.increment.F, CHOLMOD_METIS);
    const double with_metis = peak_megabytes(true);
    (*t)[5] = freefem_solve_seconds(p, posed.increment.F);
    const double with_freefem = peak_megabytes(true);
    (*t)[0] = std::min({(*t)[1], (*t)[2], (*t)[5]});
    Vector x = Vector::Ones(p.dofs()), y(p.dofs());
    const int products = 1 + static_cast<int>(2e8 / (1 + p.A.nonZeros()));
    const double start = cpu_seconds();
    for (int k = 0; k < products; ++k) {
      y.noalias() = p.A * x;
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
    const Vector size = p.A.cwiseAbs() * x.cwiseAbs();
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
    out.write(p.A.outerIndexPtr(), p.dofs() + 1);
    out.write(p.A.innerIndexPtr(), p.A.nonZeros());
    out.write(p.A.valuePtr(), p.A.nonZeros());
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
    const Vector r = posed.increment.F - p.A * x;
    const Vector field = posed.scene.system->to_global(x, posed.u0);
    for (Index i = 0; i < posed.scene.ndof(); ++i) u[i] = field[i];
    return posed.scene.copy_seconds + cpu_seconds() - start + 0 * r[0];
  }
};

double peak_memory(const long& reset) { return peak_megabytes(reset != 0); }

void load() {
  add_on_scene<LinearSolve>();
  add_on_scene<AttainableResidual, KN_<double>>();
  add_on_scene<ExportSystem, string*, KN_<double>>();
  add_on_scene<FrictionlessSolve, KN_<double>>();
  Global.Add(
      "energyError", "(",
      new OneOperator3_<double, Matrice_Creuse<double>*, KN_<double>, KN_<double>>(energy_error));
  Global.Add("peakMemory", "(", new OneOperator1_<double, long>(peak_memory));
}

}  // namespace

LOADFUNC(load)
