// A FreeFEM plugin of the benchmarks: what one linear solve, and one product, with the same matrix
// cost.
//   real[int] t = linearSolve(A, b, Vh, label);
//     CPU seconds of CHOLMOD, analyse + factor + solve: best, with AMD, with METIS; then of one
//     product A x, and the peak memory of the factorization [MB]
//   real a = attainableResidual(A, b, Vh, label, u);
//     the certificate that rounding allows at u: eps_machine ||A||u|| in its norm
//   real m = peakMemory(reset);  peak memory of the process since the last reset [MB]
#include "../../plugin/freefem/pose.h"

#include <cholmod.h>

#include <fstream>

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
double cholmod_solve_seconds(const ContactProblem& p, int ordering) {
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
  b.x = const_cast<Real*>(p.F.data());
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

template <class V>
class LinearSolve : public E_F0mps {
 public:
  using Result = KN_<double>;
  explicit LinearSolve(const basicAC_F0& args)
      : arguments_(args, Dimension<typename V::FESpace>::d, true),
        A_(to<Matrice_Creuse<double>*>(args[0])),
        b_(to<KN_<double>>(args[1])),
        Vh_(to<typename V::pfes*>(args[2])),
        label_(to<long>(args[3])) {}
  static ArrayOfaType typeargs() {
    return ArrayOfaType(atype<Matrice_Creuse<double>*>(), atype<KN_<double>>(),
                        atype<typename V::pfes*>(), atype<long>());
  }
  static E_F0* f(const basicAC_F0& args) { return new LinearSolve(args); }
  AnyType operator()(Stack stack) const override {
    return translated("linearSolve", [&] {
      const auto scene =
          pose<V>(stack, arguments_, GetAny<Matrice_Creuse<double>*>((*A_)(stack)),
                  GetAny<typename V::pfes*>((*Vh_)(stack)), {GetAny<long>((*label_)(stack))}, true);
      scene->system->set_load(checked_vector(GetAny<KN_<double>>((*b_)(stack)), "b", scene->ndof),
                              {}, scene->gap);
      const ContactProblem& p = scene->system->problem();
      KN<double>* t = Add2StackOfPtr2Free(stack, new KN<double>(5));
      peak_megabytes(true);
      (*t)[1] = cholmod_solve_seconds(p, CHOLMOD_AMD);
      const double with_amd = peak_megabytes(true);
      (*t)[2] = cholmod_solve_seconds(p, CHOLMOD_METIS);
      const double with_metis = peak_megabytes(true);
      (*t)[0] = std::min((*t)[1], (*t)[2]);
      Vector x = Vector::Ones(p.dofs()), y(p.dofs());
      const int products = 1 + static_cast<int>(2e8 / (1 + p.A.nonZeros()));
      const double start = cpu_seconds();
      for (int k = 0; k < products; ++k) {
        y.noalias() = p.A * x;
        x[k % p.dofs()] += 1e-9 * y[0];
      }
      (*t)[3] = (cpu_seconds() - start) / products;
      (*t)[4] = (*t)[1] < (*t)[2] ? with_amd : with_metis;
      return SetAny<KN_<double>>(*t);
    });
  }

 private:
  Arguments arguments_;
  Expression A_, b_, Vh_, label_;
};

/// eps_machine | |A| |x| | over the norm of the load, both in the norm of D^{-1/2}.
template <class V>
class AttainableResidual : public E_F0mps {
 public:
  using Result = double;
  explicit AttainableResidual(const basicAC_F0& args)
      : arguments_(args, Dimension<typename V::FESpace>::d, true),
        A_(to<Matrice_Creuse<double>*>(args[0])),
        b_(to<KN_<double>>(args[1])),
        Vh_(to<typename V::pfes*>(args[2])),
        label_(to<long>(args[3])),
        u_(to<KN_<double>>(args[4])) {}
  static ArrayOfaType typeargs() {
    return ArrayOfaType(atype<Matrice_Creuse<double>*>(), atype<KN_<double>>(),
                        atype<typename V::pfes*>(), atype<long>(), atype<KN_<double>>());
  }
  static E_F0* f(const basicAC_F0& args) { return new AttainableResidual(args); }
  AnyType operator()(Stack stack) const override {
    return translated("attainableResidual", [&] {
      const auto scene =
          pose<V>(stack, arguments_, GetAny<Matrice_Creuse<double>*>((*A_)(stack)),
                  GetAny<typename V::pfes*>((*Vh_)(stack)), {GetAny<long>((*label_)(stack))}, true);
      scene->system->set_load(checked_vector(GetAny<KN_<double>>((*b_)(stack)), "b", scene->ndof),
                              {}, scene->gap);
      const ContactProblem& p = scene->system->problem();
      const Vector x = scene->system->to_local(
          checked_vector(GetAny<KN_<double>>((*u_)(stack)), "u", scene->ndof));
      const Vector size = p.A.cwiseAbs() * x.cwiseAbs();
      return SetAny<double>(std::numeric_limits<double>::epsilon() * norm_D(p, size) /
                            p.force_scale);
    });
  }

 private:
  Arguments arguments_;
  Expression A_, b_, Vh_, label_, u_;
};

double peak_memory(const long& reset) { return peak_megabytes(reset != 0); }

void load() {
  Global.Add("linearSolve", "(", new OneOperatorCode<LinearSolve<v_fes>>());
  Global.Add("linearSolve", "(", new OneOperatorCode<LinearSolve<v_fes3>>());
  Global.Add("attainableResidual", "(", new OneOperatorCode<AttainableResidual<v_fes>>());
  Global.Add("attainableResidual", "(", new OneOperatorCode<AttainableResidual<v_fes3>>());
  Global.Add("peakMemory", "(", new OneOperator1_<double, long>(peak_memory));
}

}  // namespace

LOADFUNC(load)
