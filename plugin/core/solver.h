#pragma once
#include "cost.h"
#include "solution.h"
#include "statics/floating.h"

namespace frictioncg {

/// What the scene needs, decided before anything is solved; what is absent is left out.
struct Plan {
  Route route;          ///< the first choice; a factor that does not fit leaves the other
  Costs costs;          ///< method auto: why
  Law law;              ///< coulomb: g depends on the answer
  bool regularization;  ///< friction by a conjugate gradient
};

Plan make_plan(const ContactProblem& problem, const Settings& settings);

class CondensedSolver;
class MultigridSolver;
class SparseSolver;
struct Allowance;

/// Solves increment after increment of one system: a factorization, or a hierarchy, is made at the
/// first call that wants it, and kept.
class Solver {
 public:
  /// Throws IllegalInput for what validate refuses.
  explicit Solver(SystemPtr system);
  ~Solver();

  /// Another matrix in the place of A. On the same dofs the faces of the last answer stay; over the
  /// same pattern ordering and layout of the factors, too, as far as there are any. Throws
  /// IllegalInput for what validate refuses, and leaves all as it was then.
  void renew(SystemPtr system);

  /// Solves by the method of the settings, and certifies the answer. x0 (n), or empty to start from
  /// the scene. Where the method does not arrive another one may answer: see Solution::layer.
  /// Throws IllegalInput for what validate refuses, and where the condensed route is demanded and
  /// does not fit in settings.memory; the factorization stays as it was.
  Solution solve(const Increment& increment, const Settings& settings, const Vector& x0 = {},
                 Observer* observer = nullptr);
  /// What the condensed route takes [bytes], as far as calls before have found it out; else 0.
  double memory_needed() const { return memory_needed_; }

 private:
  using Way = Solution (Solver::*)(const Request& request);
  Solution or_as_held_before(Solution s, const Request& request);
  Solution by_route(const Request& request);
  Solution by_condensation(const Request& request);
  void try_on_A(const Request& request, Solution& s);
  void buckle(const Request& request, Solution& s);
  Solution by_gradients(const Request& request);
  const DenseMatrix& floating();
  void decide_on_equilibrium(const ContactProblem& problem, Solution& s);
  Solution by_multigrid(const Request& request);
  Solution by_sparse_factors(const Request& request);
  Way after_multigrid(const Settings& settings);
  bool path_is_cheaper_on_A(const Settings& settings);
  Solution or_by(Way next, Solution s, const Request& request);
  bool lay_out_sparse_factor(const Settings& settings);
  bool sparse_comes_first(const Settings& settings);
  Allowance allowance(const Settings& settings) const;
  bool condense(const Request& request);

  SystemPtr system_;
  std::optional<DenseMatrix> floating_;  ///< of A, once they were asked for
  Costs costs_;                          ///< of the plan
  std::unique_ptr<CondensedSolver> condensed_;
  double memory_needed_ = 0;  ///< by the condensed route, as far as it is known [bytes]
  bool factored_ = false;
  bool indefinite_ = false;        ///< A has no factor, whatever the memory
  bool multigrid_failed_ = false;  ///< in this call
  bool path_tried_ = false;        ///< the central path on A, in this call
  bool poor_ = false;              ///< the hierarchy is, or that of the matrix before was
  std::unique_ptr<MultigridSolver> multigrid_;
  std::unique_ptr<SparseSolver> sparse_;
};

/// One problem, solved once.
Solution solve(const ContactProblem& problem, const Settings& settings, const Vector& x0 = {},
               Observer* observer = nullptr);

}  // namespace frictioncg
