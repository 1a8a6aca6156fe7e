// A FreeFEM plugin of the benchmarks: paperTables(A, b, Vh, label, mu=..., ...) repeats the tables
// 3 to 6 of Raous and Barbarin (1992) on the scene it is given, with the paper's own counts beside.
#include "core/gradient/tresca.h"
#include "on_scene.h"

#include <iomanip>

using namespace frictioncg;

namespace {

struct Run {
  std::string text;
  double count = 0;    // 0: not reached
  double seconds = 0;  // CPU
};

/// One row: iterations of a method at the given sliding limit, by the paper's stopping test, and
/// what the answer is worth: the energy-norm error to the exact solution at the same g.
class Tables {
 public:
  explicit Tables(const ContactProblem& coulomb) : problem_(coulomb) {
    const Solution exact = solve(problem_, Settings());
    if (exact.status != Status::converged) throw IllegalInput("the scene has no exact solution");
    Increment& given = problem_.increment;
    given.law = Law::tresca;
    given.g.resize(problem_.nodes());
    for (Index i = 0; i < problem_.nodes(); ++i)
      given.g[i] =
          law_of(coulomb.increment, i).limit(exact.certificate.r[problem_.system->first[i]]);
    x_ = exact.x;
    energy_ = x_.dot(problem_.system->entries() * x_);
  }

  /// eps [length]; stop on |dx| <= 0.5e-5 |x|, partial convergence at `partial`
  Run run(Method method, Regularization reg, Precon precon, Step step, double eps, double partial,
          double omega) const {
    Settings s;
    s.method = method;
    s.reg = reg;
    s.precon = precon;
    s.step = step;
    s.regeps = eps;
    s.stop_on_step = 0.5e-5;
    s.partial = partial / s.stop_on_step;
    s.omega = omega;
    s.nbiter = 20000;
    s.tol = 1e-15;
    Vector x = Vector::Zero(problem_.dofs());
    const auto solver = make_tresca_solver(problem_, s, nullptr);
    const double start = cpu_seconds();
    const Outcome o = solver->minimize(x, problem_.increment.g, eps, Tangents::sliding, 0);
    const double seconds = cpu_seconds() - start;
    const Vector e = x - x_;
    const double error = std::sqrt(std::abs(e.dot(problem_.system->entries() * e)) / energy_);
    std::ostringstream text;
    if (o.status == Status::converged && error > 1e-2) {
      text << " stops wrong (" << std::setprecision(1) << std::scientific << error << ")";
      return {text.str(), 0, seconds};
    }
    if (o.status == Status::converged) {
      text << std::setw(6) << o.iterations() << "  (" << std::setprecision(1) << std::scientific
           << error << ")";
      return {text.str(), double(o.iterations()), seconds};
    }
    text << " stalls  (" << std::setprecision(1) << std::scientific << error << ")";
    return {text.str(), 0, seconds};
  }

  /// The omega of least iterations, of (0, 2) by steps of 0.02.
  double best_omega(double eps) const {
    double best = 1, least = 1e9;
    for (double omega = 1; omega < 1.99; omega += 0.02) {
      const Run r = run(Method::sorp, Regularization::polynomial, Precon::none, Step::exact, eps,
                        1e-3, omega);
      if (r.count > 0 && r.count < least) {
        least = r.count;
        best = omega;
      }
    }
    return best;
  }

  const ContactProblem& problem() const { return problem_; }

 private:
  ContactProblem problem_;
  Vector x_;
  double energy_ = 0;
};

struct PaperCounts {
  double gc[3][3];    // GC1..3 by REG1..3, 0 where not published
  double sorp;        // at its omega
  double precon[4];   // diag(A), SSOR(A), diag(J''), SSOR(J'')
  double seconds[5];  // their times on a VAX 6310, and that of SORP; 0 where not published
  double omega;
  Regularization precon_reg;
  double partial;
};

void print_ratio(double ours, double paper) {
  if (ours > 0 && paper > 0)
    std::cout << std::setw(9) << std::fixed << std::setprecision(2) << ours << std::setw(9)
              << paper;
  else
    std::cout << std::setw(9) << (ours > 0 ? std::to_string(ours).substr(0, 4) : "-")
              << std::setw(9) << (paper > 0 ? std::to_string(paper).substr(0, 4) : "-");
}

void print_tables(const Tables& t, const PaperCounts& paper, double eps) {
  const Regularization regs[] = {Regularization::square_root, Regularization::log_cosh,
                                 Regularization::polynomial};
  const Method methods_[] = {Method::gc1, Method::gc2, Method::gc3};
  const char* names[] = {"GC1", "GC2", "GC3"};
  for (Step step : {Step::newton, Step::exact}) {
    std::cout << "\n  projections, SSOR(J''), step "
              << (step == Step::newton ? "(14) as printed" : "exact, with the safeguards") << "\n"
              << "    iterations (energy error); ratio to GC3 of the same regularization\n"
              << "                                            paper      ours/GC3  paper/GC3\n";
    double base[3] = {0, 0, 0};
    std::vector<std::array<Run, 3>> rows(3);
    for (int m = 2; m >= 0; --m)
      for (int r = 0; r < 3; ++r) {
        rows[m][r] = t.run(methods_[m], regs[r], Precon::hessian_ssor, step, eps, paper.partial, 1);
        if (m == 2) base[r] = rows[m][r].count;
      }
    for (int m = 0; m < 3; ++m)
      for (int r = 0; r < 3; ++r) {
        std::cout << "    " << names[m] << " REG" << r + 1 << "  " << std::setw(23)
                  << rows[m][r].text << "  " << std::setw(9);
        if (paper.gc[m][r] > 0)
          std::cout << std::fixed << std::setprecision(0) << paper.gc[m][r];
        else
          std::cout << "-";
        print_ratio(base[r] > 0 ? rows[m][r].count / base[r] : 0,
                    paper.gc[2][r] > 0 ? paper.gc[m][r] / paper.gc[2][r] : 0);
        std::cout << "\n";
      }
  }

  const double best = t.best_omega(eps);
  const Run gc3 = t.run(Method::gc3, Regularization::polynomial, Precon::hessian_ssor, Step::exact,
                        eps, paper.partial, 1);
  std::cout << "\n  SORP                               paper   ratios to GC3, SSOR(J''): "
               "iterations, ours and "
               "paper's; time, ours and paper's\n";
  for (double omega : {paper.omega, best}) {
    const Run r = t.run(Method::sorp, Regularization::polynomial, Precon::none, Step::exact, eps,
                        paper.partial, omega);
    std::cout << "    omega " << std::fixed << std::setprecision(2) << omega << "   "
              << std::setw(23) << r.text << "  " << std::setw(9);
    if (omega == paper.omega)
      std::cout << std::fixed << std::setprecision(0) << paper.sorp;
    else
      std::cout << "our best";
    print_ratio(gc3.count > 0 ? r.count / gc3.count : 0,
                omega == paper.omega && paper.precon[3] > 0 ? paper.sorp / paper.precon[3] : 0);
    print_ratio(r.seconds / gc3.seconds, omega == paper.omega && paper.seconds[3] > 0
                                             ? paper.seconds[4] / paper.seconds[3]
                                             : 0);
    std::cout << "\n";
  }

  const Precon precons[] = {Precon::diagonal, Precon::ssor, Precon::hessian_diagonal,
                            Precon::hessian_ssor};
  const char* precon_names[] = {"diag(A)", "SSOR(A)", "diag(J'')", "SSOR(J'')"};
  for (Step step : {Step::newton, Step::exact}) {
    std::cout
        << "\n  preconditioners of GC3, step "
        << (step == Step::newton ? "(14) as printed" : "exact, with the safeguards") << "\n"
        << "                                     paper   ratios to SSOR(J''): iterations, ours and "
           "paper's; time, ours and paper's\n";
    std::array<Run, 4> rows;
    for (int p = 0; p < 4; ++p)
      rows[p] = t.run(Method::gc3, paper.precon_reg, precons[p], step, eps, paper.partial, 1);
    for (int p = 0; p < 4; ++p) {
      std::cout << "    " << std::left << std::setw(11) << precon_names[p] << std::right
                << std::setw(23) << rows[p].text << "  " << std::setw(9);
      if (paper.precon[p] > 0)
        std::cout << std::fixed << std::setprecision(0) << paper.precon[p];
      else
        std::cout << "-";
      print_ratio(rows[3].count > 0 ? rows[p].count / rows[3].count : 0,
                  paper.precon[p] / paper.precon[3]);
      print_ratio(rows[p].count > 0 ? rows[p].seconds / rows[3].seconds : 0,
                  paper.seconds[3] > 0 ? paper.seconds[p] / paper.seconds[3] : 0);
      std::cout << "\n";
    }
  }
  std::cout << std::defaultfloat;
}

/// paperTables(A, b, Vh, label, which, mu=...): which = 1, 2, 3 for the paper's scenes.
struct PaperTables {
  static constexpr const char* name = "paperTables";
  using Result = long;
  static Result run(Stack, const PosedScene& posed, long which) {
    const Tables tables({posed.scene.system->system(), posed.increment});
    const PaperCounts counts[] = {{{{102, 71, 93}, {98, 93, 90}, {50, 49, 47}},
                                   225,
                                   {115, 49, 113, 47},
                                   {30, 28, 30, 27, 30},
                                   1.58,
                                   Regularization::square_root,
                                   1e-3},
                                  {{{289, 227, 257}, {0, 0, 0}, {241, 223, 220}},
                                   776,
                                   {0, 0, 0, 241},
                                   {0, 0, 0, 0, 0},
                                   1.96,
                                   Regularization::square_root,
                                   0.5e-3},
                                  {{{0, 0, 0}, {0, 0, 0}, {0, 277, 0}},
                                   3646,
                                   {676, 305, 584, 277},
                                   {742, 588, 680, 560, 1579},
                                   1.86,
                                   Regularization::log_cosh,
                                   0.5e-3}};
    const long nodes = tables.problem().nodes();
    std::cout << "  " << tables.problem().dofs() << " dofs, " << nodes
              << " contact nodes, eps 1e-8 mm, |dx| <= 0.5e-5 |x|\n";
    print_tables(tables, counts[which - 1], 1e-8);
    return nodes;
  }
};

void load() { add_on_scene<PaperTables, long>(); }

}  // namespace

LOADFUNC(load)
