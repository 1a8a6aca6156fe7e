#include "report.h"

#include <iostream>

#include "node_values.h"

namespace frictioncg {

namespace {

/// Words of enumerators, in their order.
constexpr const char* law_names[] = {"no friction", "given sliding limit", "Coulomb friction"};

constexpr const char* layer_names[] = {
    "none",
    "a linear solve",
    "Newton on the condensed laws",
    "an interior point on the condensed laws, with Newton after it",
    "Newton on the condensed laws, with springs that vanish",
    "Newton on the condensed laws, one sliding limit after the other",
    "the regularized conjugate gradient on the condensed system",
    "GCX on A",
    "the regularized conjugate gradient on A",
    "SORP on A",
    "Newton on A, preconditioned by multigrid",
    "Newton on A, by sparse factors",
    "an interior point on A, by sparse factors, with Newton after it"};

/// "1 iteration", "2 iterations".
std::string counted(std::size_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

/// What to do about a call that did not converge. Only no_equilibrium and runaway blame the load.
std::string remedy(const Solution& solution, const Settings& s) {
  const Status status = solution.status;
  const Certificate& c = solution.certificate;
  const bool of_method = status != Status::no_equilibrium && status != Status::runaway;
  if (smooths_friction(s) && s.step != Step::exact && of_method)
    return std::string("step=\"") + name_of(s.step, steps) +
           "\" may be what keeps it from converging; leave step out, or raise nbiter";
  switch (status) {
    case Status::converged:
      break;
    case Status::max_iterations:
      if (smooths_friction(s)) return "raise nbiter, or try omega=1.5";
      return s.nbiter > 0 ? "raise nbiter"
                          : "no answer was found, which proves nothing: near its limit a load may "
                            "have none; apply it in increments, give start= a field near the "
                            "answer, such as that without friction, or raise nbiter";
    case Status::stagnated:
      if (may_be_rounding(c)) {
        std::ostringstream m;
        m << "rounding leaves about " << c.attainable
          << " of it in any case; raise tol, or, of two bodies, let the softer one be the slave";
        return m.str();
      }
      return takes_newton_steps(s)
                 ? "no answer was found, which proves nothing: near its limit a load may have "
                   "none; apply it in increments, or give start= a field near the answer, such as "
                   "that without friction"
                 : "the method came to a standstill above tol; raise tol, or name another method";
    case Status::no_equilibrium:
      return "contact, friction and supports cannot hold this load";
    case Status::not_positive_definite:
      return "A must be positive semi-definite where contact does not hold the body, and a tangent "
             "is not where the body buckles; check its coefficients";
    case Status::fixed_point_diverged:
      return condenses(s) ? "mu is large for this scene; apply the load in increments"
                          : "mu is large for this method; leave method out, or apply the "
                            "load in increments";
    case Status::regularized:
      return "regeps limits the accuracy; lower it, leave it out, or raise tol";
    case Status::runaway:
      return "hold the rotation by a support, lower the load, give the exact normal, or move the "
             "faces of a crack together by movemesh";
  }
  return "";
}

constexpr const char* negative_energy = "A has negative energy, p'Ap < 0, for p = ";

constexpr const char* step_names[step_labels] = {"conjugate",   "restart",  "stick frozen",
                                                 "contact hit", "release",  "sweep",
                                                 "Newton",      "expansion"};

constexpr const char* work_names[works] = {
    "the factorization",
    "the multigrid hierarchy",
    "Newton on the condensed laws",
    "the interior point",
    "Newton on the condensed laws, with springs that vanish",
    "the regularized conjugate gradient on the condensed system"};

static_assert(std::size(law_names) == static_cast<int>(Law::coulomb) + 1);
static_assert(std::size(layer_names) == static_cast<int>(Layer::sparse_interior_point) + 1);

/// What a scene can do without.
void report_left_out(const Arguments& args, const Scene& scene, const ContactProblem& problem,
                     const Plan& plan) {
  std::cout << "; left out:";
  const char* separator = " ";
  const auto left_out = [&](bool absent, const char* what) {
    if (!absent) return;
    std::cout << separator << what;
    separator = ", ";
  };
  left_out(!scene.system->rotated(), "rotation");
  left_out(plan.law != Law::coulomb, "fixed point");
  left_out(problem.contact_dofs() == problem.nodes(), "tangential laws");
  left_out(!plan.regularization, "regularization");
  left_out(!args.has(p_uold), "previous state");
  left_out(!args.has(p_history), "history");
}

/// What faces what, in numbers.
void report_faces(const FacingPair& pair) {
  const mortar::Statistics& s = pair.found;
  if (s.facing == 0)
    std::cout << "none of " << counted(pair.slaves, "slave facet") << " faces one of "
              << counted(pair.masters, "master facet") << ": open";
  else
    std::cout << counted(s.facing, "slave node") << " on " << counted(pair.slaves, "facet")
              << " face " << counted(pair.masters, "master facet") << ", gap " << s.least_gap
              << " to " << s.largest_gap << "; " << counted(s.partly_covered, "slave facet")
              << " partly covered, " << counted(s.removed, "node") << " removed";
}

/// The same of one pair; nodes that carry no law are named by place.
void report_pair(const FacingPair& pair, bool only) {
  const mortar::Statistics& s = pair.found;
  line() << (only ? "two bodies" : pair.labels) << ": ";
  report_faces(pair);
  if (s.held > 0)
    std::cout << ", " << s.held << " of them since Dirichlet conditions hold the normal or a part "
              << "of it, as at " << pair.held_at << ": their neighbours take their share";
  if (s.held_facets > 0)
    std::cout << "; warning: " << counted(s.held_facets, "facet") << " of them alone, which the "
              << "master may pass through: swap slave and master";
  std::cout << std::endl;
}

/// The route, and what was weighed.
void report_choice(const Plan& plan) {
  if (plan.route == Route::iterative) return;
  std::cout << (plan.route != Route::multigrid ? " by a factorization"
                : plan.costs.sparse_first ? " by sparse factors, or multigrid where they cost more"
                                          : " by multigrid");
  if (!std::isfinite(plan.costs.multigrid)) return;
  const std::streamsize digits = std::cout.precision(1);
  std::cout << " (weighed: a factorization at about " << plan.costs.condensed << " s, multigrid at "
            << plan.costs.multigrid << " s";
  if (std::isfinite(plan.costs.sparse))
    std::cout << ", sparse factors of slender bodies at " << plan.costs.sparse << " s";
  std::cout << ")";
  std::cout.precision(digits);
}

/// A note where the rounding of A is felt, which the certificate does not see: rigid motions of a
/// stiff part cost the energy that its entries are rounded to, beside what a soft part resists.
void note_contrast(const System& system) {
  constexpr Real error = 1e-13;  // of the answer, over the contrast, where parts are the largest
  const Real times = contrast(system);
  if (times < felt_contrast) return;
  std::ostringstream m;
  m.precision(1);
  m << "note: A is " << times
    << " times as stiff at one node as at another; its rounding may change "
    << "the answer by " << std::min<Real>(1, error * times) << " of it. 1e6 is as good as rigid";
  line() << m.str() << std::endl;
}

/// A warning for nodes with more normals than they can obey, such as the tip of a pyramid.
void warn_of_averages(const Scene& scene) {
  if (scene.given_normals) return;
  for (const BoundaryNode& n : scene.nodes) {
    if (!n.averaged) continue;
    line() << "warning: the normals at " << place(n, scene.d)
           << " cannot all be obeyed; their mean stands for them" << std::endl;
    return;
  }
}

/// Nodes that the given normal leaves out.
void report_averted(const Scene& scene) {
  const std::size_t count = scene.averted.size();
  if (count == 0) return;
  line() << count << (count == 1 ? " node faces" : " nodes face")
         << " away from the normal given, as at " << place(scene.averted.front(), scene.d)
         << ", and cannot touch: left out" << std::endl;
}

/// A warning for nodes that faced away from the obstacle where the increment began, and face it now
/// from within: nothing has held them back.
void warn_of_passed(Stack stack, const Arguments& args, const Scene& scene) {
  std::vector<BoundaryNode> facing;
  for (const BoundaryNode& node : scene.averted)
    if (node.begun && !faces_away(node, node.point.normal)) facing.push_back(node);
  Vector gap;
  try {
    gap = at_nodes(stack, args, scene.pairing ? p_obstaclegap : p_gap, facing);
  } catch (const IllegalInput&) {
    return;  // no law asks for it
  }
  Index worst = 0;
  if (gap.size() == 0 || gap.minCoeff(&worst) >= 0) return;
  line() << "warning: " << place(facing[worst], scene.d)
         << " faced away from the obstacle where the increment began, was left out, and lies "
         << -gap[worst] << " inside it; take smaller increments" << std::endl;
}

void note_weight(const Scene& scene) {
  if (scene.unnamed_radius < 0) return;
  const char* const r = scene.unnamed_radius == 0 ? "x" : "y";
  line() << "note: A looks axisymmetric, with the radius " << r << ", and no weight is named; "
         << "give weight=" << r << std::endl;
}

}  // namespace

std::ostream& line() { return std::cout << " -- " << operator_name << ": "; }

const char* name_of(Law law) { return law_names[static_cast<int>(law)]; }

void warn_of_displacements(Real most, const char* of_what, Real size) {
  line() << "warning: displacements of up to " << most << " in a " << of_what << " of size " << size
         << "; the laws are those of small displacements, and hold on the undeformed geometry"
         << std::endl;
}

void warn_of_large_displacements(const Scene& scene, const Vector& u) {
  if (scene.at || u.size() == 0) return;  // the geometry follows; or there is no field
  if (std::sqrt(scene.d) * u.lpNorm<Eigen::Infinity>() <= scene.least_gyration()) return;
  for (const auto& [number, body] : by_body(scene.places())) {
    const Real size = 2 * nearest_rigid_motion(body, scene.d, u).extent;
    const Real most = largest_displacement(body, scene.d, u);
    if (most > size) return warn_of_displacements(most, "body", size);
  }
}

void warn_of_far_slips(const Scene& scene, const Solution& solution, const Vector& moved) {
  if (!scene.pairing || scene.at || moved.size() == 0) return;
  const Interface& faces = scene.pairing->between();
  Real largest = 0, farthest = 0;
  for (const mortar::Pair& pair : faces.pairs)
    for (const mortar::Facet& f : pair.slave.facets)
      for (int v = 0; v < faces.d; ++v)
        largest =
            std::max(largest, (faces.X[f.node[v]] - faces.X[f.node[(v + 1) % faces.d]]).norm());
  const System& system = *scene.system->system();
  const Vector w = scene.system->to_local(moved);
  for (Index k = 0; k < system.nodes(); ++k) {
    if (scene.on_obstacle(k) || solution.state[k] == NodeState::separated) continue;
    const Real own = scene.pairing->faced().own[scene.system->node(k).point];
    const Real slip = w.segment(system.first[k] + 1, system.tangents(k)).norm();
    farthest = std::max(farthest, slip / std::max(1., own));
  }
  if (farthest > largest)
    line() << "warning: bodies in contact slip by up to " << farthest << ", past facets of size "
           << largest << ", while they face what they faced; at=U in increments follows them"
           << std::endl;
}

void report_leftover(Real most, long verb) {
  if (verb <= 0 || most == 0) return;
  line() << "b has up to " << most
         << " in Dirichlet rows of A, which is no data of tgv = 1e30: taken for what b = A*U + r "
            "leaves there, and the displacement for 0"
         << std::endl;
}

void report_left_out(Real share, long verb) {
  if (verb <= 0 || share == 0) return;
  line() << "b drives what no normal resists by " << share
         << " of itself, less than the mesh tells of normals: left out" << std::endl;
}

void report_end(const Solution& solution, const std::string& motion) {
  std::string reason = solution.status == Status::converged ? " at rest" : "";
  if (solution.layer != Layer::none)
    reason = std::string(" by ") + layer_names[static_cast<int>(solution.layer)];
  if (solution.status == Status::no_equilibrium) reason = " by a proof of statics";
  line() << name_of(solution.status) << reason << ", residual " << solution.certificate.residual
         << ", " << counted(solution.iterations, "iteration");
  if (solution.levels.count > 1)
    std::cout << " on " << solution.levels.count << " levels of complexity "
              << solution.levels.complexity;
  if (solution.passes > 0)
    std::cout << " in " << solution.passes << (solution.passes == 1 ? " pass" : " passes")
              << " of the fixed point";
  if (solution.eps > 0) std::cout << ", regeps " << solution.eps;
  std::cout << std::endl;
  if (motion.empty()) return;
  const char* of_motion = solution.status == Status::runaway                 ? ""
                          : solution.status == Status::not_positive_definite ? negative_energy
                                                                             : "nothing holds ";
  line() << of_motion << motion << std::endl;
}

void report_held_friction(const Scene& scene, const ContactProblem& problem,
                          const Solution& solution, const Vector& u0, const Vector& u_old) {
  constexpr Real rounding = 1e-12;
  const Real least = rounding * u0.lpNorm<Eigen::Infinity>();
  std::set<Index> moved;  // first dofs
  const BoundaryNode* first = nullptr;
  for (Index i = 0; i < problem.nodes(); ++i) {
    const BoundaryNode& n = scene.nodes[i];
    const bool rubs = law_of(problem.increment, i).has_friction();
    if (solution.state[i] == NodeState::separated || !rubs) continue;
    Vec3 by = Vec3::Zero();
    for (int c = 0; c < scene.d; ++c)
      if (const Index k = n.point.dof[c]; scene.holds(k))
        by[c] = u0[k] - (u_old.size() > 0 ? u_old[k] : 0);
    if (!((by - n.point.normal.dot(by) * n.point.normal).norm() > least)) continue;
    if (moved.empty()) first = &n;
    moved.insert(n.point.dof[0]);
  }
  if (moved.empty()) return;
  line() << "note: Dirichlet data move " << counted(Index(moved.size()), "contact node")
         << ", as at " << place(*first, scene.d)
         << ", along the contact: their friction is left to the supports, "
         << "and force has none" << std::endl;
}

void report_corners(const Scene& scene, const ContactProblem& problem, const Solution& solution) {
  constexpr Real little = 0.02;
  if (problem.increment.law == Law::frictionless) return;
  Real all = 0, in_corners = 0;
  for (Index i = 0; i < problem.nodes(); ++i) {
    const Real pressing = std::max<Real>(solution.certificate.r[problem.system->first[i]], 0);
    all += pressing;
    if (scene.system->node(i).shared) in_corners += pressing;
  }
  if (in_corners > little * all)
    line() << "note: " << std::lround(100 * in_corners / all)
           << " % of the normal forces act on nodes "
           << "in corners, which have no friction before an obstacle; before a meshed master "
           << "that on() holds they have" << std::endl;
}

void report_memory(double needed, const Settings& s) {
  if (s.method != Method::automatic || needed <= s.memory) return;
  line() << "memory = " << s.memory / 1e9 << " GB, and a factorization takes ";
  if (std::isfinite(needed))
    std::cout << "at least " << needed / 1e9
              << " GB: auto went on without one; raise memory to have it";
  else
    std::cout << "more entries than CHOLMOD can index: auto went on without one";
  std::cout << std::endl;
}

void report_phases(const Scene& scene, const Solution& solution) {
  const Times& t = solution.times;
  line() << "CPU seconds: copy " << scene.copy_seconds << ", order " << t.order << ", factor "
         << t.factor << ", condense " << t.condense << ", contact " << t.contact
         << ", back-substitution " << t.back_substitution << ", certificate " << t.certificate
         << std::endl;
  const Matrix& A = scene.system->system()->entries();
  const double of_A =
      (sizeof(Real) + sizeof(Index)) * double(A.nonZeros()) + sizeof(Index) * (A.rows() + 1.0);
  if (solution.levels.count > 0)
    line() << "multigrid hierarchy: " << solution.levels.bytes / 1e6 << " MB, "
           << solution.levels.bytes / of_A << " times the storage of A" << std::endl;
  if (solution.steps.total() > 0) {
    line() << "steps:";
    for (int k = 0; k < step_labels; ++k)
      if (solution.steps.count[k] > 0)
        std::cout << " " << solution.steps.count[k] << " " << step_names[k];
    std::cout << std::endl;
  }
  Index count[4] = {0, 0, 0, 0};
  for (NodeState s : solution.state) ++count[static_cast<Index>(s)];
  const Certificate& c = solution.certificate;
  line() << count[1] << " nodes separated, " << count[2] << " in slip, " << count[3]
         << " in stick; residual of equilibrium " << c.equilibrium << ", of contact " << c.normal
         << ", of friction " << c.friction << std::endl;
}

[[noreturn]] void refuse_unconverged(const Solution& solution, const Settings& s,
                                     const std::string& motion) {
  const bool turned = solution.status == Status::runaway;
  const bool indefinite = solution.status == Status::not_positive_definite;
  std::ostringstream m;
  m << "not converged (" << name_of(solution.status) << ") after "
    << counted(solution.iterations, "iteration") << ": residual " << solution.certificate.residual
    << ", tol " << s.tol << "; ";
  if (turned) m << motion << "; ";
  m << remedy(solution, s);
  if (!turned && !motion.empty())
    m << (indefinite ? std::string("; ") + negative_energy : ", which nothing holds against ")
      << motion;
  m << "; pass status=... to get the field all the same";
  throw IllegalInput(m.str());
}

Progress::Progress(const ContactProblem& problem, long verb, bool keep_history)
    : problem_(problem), verb_(verb), keep_history_(keep_history) {}

void Progress::iterate(Index iteration, StepLabel label, const Vector& x) {
  const double now = cpu_seconds();
  const bool due = verb_ > 0 && ((first_ && verb_ > 1) || since(spoken_) >= interval());
  const bool speaks = problem_.system->largest(due) > 0;  // certify is a matter of all processes
  if (keep_history_ || speaks) {
    const double residual = certify(problem_, x).residual;
    if (keep_history_) rows_.push_back({now - start_, double(iteration), residual, double(label)});
    if (verb_ > 0 && speaks) {
      first_ = false;
      speak() << "iteration " << iteration << " (" << step_names[static_cast<int>(label)]
              << "), certificate " << residual << ", " << since(begun_) << " s" << std::endl;
    }
  }
  start_ += cpu_seconds() - now;
}

void Progress::step(Work work, Real residual) {
  const int count = ++steps_[static_cast<int>(work)];
  if (!listens()) return;
  speak() << "step " << count << " of " << work_names[static_cast<int>(work)] << ", residual "
          << residual << ", " << since(begun_) << " s" << std::endl;
}

void Progress::begin(Work work, double seconds) {
  if (verb_ < 1 || seconds < interval()) return;
  speak() << work_names[static_cast<int>(work)] << " of " << problem_.dofs()
          << " dofs begins: about " << std::round(seconds) << " s without a word" << std::endl;
}

double Progress::since(Clock::time_point t) {
  return std::chrono::duration<double>(Clock::now() - t).count();
}

std::ostream& Progress::speak() {
  spoken_ = Clock::now();
  return line();
}

Real largest_friction(const ContactProblem& problem) {
  const Vector& mu = problem.increment.mu;
  return problem.increment.law == Law::coulomb && mu.size() > 0 ? mu.maxCoeff() : 0;
}

void report_large_friction(Real mu) {
  constexpr Real small = 1;
  if (mu > small)
    line() << "mu = " << mu << " is above " << small
           << ": such laws may have several answers, of which one is given" << std::endl;
}

void report_pairs(const Scene& scene, long verb) {
  if (!scene.pairing) return;
  const std::vector<FacingPair>& pairs = scene.pairing->faced().pairs;
  const std::size_t count = pairs.size();
  if (count == 1 || verb > 2) {
    for (const FacingPair& pair : pairs) report_pair(pair, count == 1);
    return;
  }
  FacingPair all;
  mortar::Statistics& found = all.found;
  found.least_gap = infinity;
  found.largest_gap = -infinity;
  for (const FacingPair& pair : pairs) {
    const mortar::Statistics& s = pair.found;
    all.slaves += pair.slaves;
    all.masters += pair.masters;
    found.facing += s.facing;
    found.removed += s.removed;
    found.partly_covered += s.partly_covered;
    if (s.facing == 0) continue;
    found.least_gap = std::min(found.least_gap, s.least_gap);
    found.largest_gap = std::max(found.largest_gap, s.largest_gap);
  }
  line() << count << " pairs: ";
  report_faces(all);
  std::cout << "; verb=3 has each" << std::endl;
}

void report_plan(Stack stack, const Arguments& args, const Scene& scene,
                 const ContactProblem& problem, const Settings& s, long verb) {
  report_pairs(scene, verb);
  const Plan plan = make_plan(problem, s);
  Index on_obstacle = 0, in_corners = 0;
  for (Index k = 0; k < scene.system->nodes(); ++k) {
    on_obstacle += scene.on_obstacle(k);
    in_corners += scene.system->node(k).shared && scene.starts_node(k);
  }
  line() << scene.d << "D, " << problem.dofs() << " dofs, "
         << counted(problem.nodes(), "contact node");
  if (scene.beside_pairs > 0) std::cout << ", " << on_obstacle << " on the obstacle";
  std::cout << ", " << name_of(plan.law);
  if (problem.increment.bilateral) std::cout << ", bilateral";
  if (scene.system->rotated() && !scene.pairing) std::cout << ", frames rotated";
  if (in_corners > 0) std::cout << ", " << counted(in_corners, "node") << " in a corner";
  if (problem.nodes() == 0)
    std::cout << (scene.nodes.empty() ? "; nothing faces the slave"
                                      : "; Dirichlet conditions hold every normal displacement")
              << ": a plain linear solve";
  std::cout << "; " << name_of(s.method, methods);
  if (s.method == Method::automatic) report_choice(plan);
  if (plan.regularization) std::cout << ", " << name_of(s.reg, regularizations);
  report_left_out(args, scene, problem, plan);
  std::cout << "; version " << version << std::endl;
  warn_of_averages(scene);
  report_averted(scene);
  warn_of_passed(stack, args, scene);
  report_large_friction(largest_friction(problem));
  note_weight(scene);
  note_contrast(*problem.system);
}

}  // namespace frictioncg
