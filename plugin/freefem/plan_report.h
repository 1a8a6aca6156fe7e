#pragma once
#include "freefem.h"

#include <iostream>

#include "../core/assembly/mortar/validation.h"
#include "node_values.h"
#include "report.h"

namespace frictioncg {

/// What a scene can do without.
inline void report_left_out(const Arguments& args, const Scene& scene, const Plan& plan) {
  std::cout << "; left out:";
  const char* separator = " ";
  const auto left_out = [&](bool absent, const char* what) {
    if (!absent) return;
    std::cout << separator << what;
    separator = ", ";
  };
  left_out(!scene.system->rotated(), "rotation");
  left_out(!plan.fixed_point, "fixed point");
  left_out(plan.tangents == 0, "tangential laws");
  left_out(!plan.regularization, "regularization");
  left_out(!args.has(p_uold), "previous state");
  left_out(!args.has(p_history), "history");
}

/// Mesh nodes with several normals.
inline Index nodes_in_corners(const Scene& scene) {
  Index count = 0;
  for (Index k = 0; k < scene.system->nodes(); ++k)
    count += scene.system->node(k).shared && scene.starts_node(k);
  return count;
}

/// Contact nodes, each with one normal, on an obstacle.
inline Index nodes_on_obstacle(const Scene& scene) {
  Index count = 0;
  for (Index k = 0; k < scene.system->nodes(); ++k) count += scene.on_obstacle(k);
  return count;
}

/// A warning for nodes with more normals than they can obey, such as the tip of a pyramid.
inline void warn_of_averages(const Scene& scene) {
  if (scene.given_normals) return;
  for (const BoundaryNode& n : scene.nodes) {
    if (!n.averaged) continue;
    line() << "warning: the normals at " << place(n, scene.d)
           << " cannot all be obeyed; their mean stands for them" << std::endl;
    return;
  }
}

/// Nodes that the given normal leaves out.
inline void report_averted(const Scene& scene) {
  const std::size_t count = scene.averted.size();
  if (count == 0) return;
  line() << count << (count == 1 ? " node faces" : " nodes face")
         << " away from the normal given, as at " << place(scene.averted.front(), scene.d)
         << ", and cannot touch: left out" << std::endl;
}

/// A warning for nodes that faced away from the obstacle where the increment began, and face it now
/// from within: nothing has held them back.
inline void warn_of_passed(Stack stack, const Arguments& args, const Scene& scene) {
  std::vector<BoundaryNode> facing;
  for (const BoundaryNode& node : scene.averted)
    if (node.begun && !faces_away(node, node.point.normal)) facing.push_back(node);
  Vector gap;
  try {
    gap = at_nodes(stack, args, scene.pairing ? p_obstaclegap : p_gap, scene, facing);
  } catch (const IllegalInput&) {
    return;  // no law asks for it
  }
  Index worst = 0;
  if (gap.size() == 0 || gap.minCoeff(&worst) >= 0) return;
  line() << "warning: " << place(facing[worst], scene.d)
         << " faced away from the obstacle where the increment began, was left out, and lies "
         << -gap[worst] << " inside it; take smaller increments" << std::endl;
}

/// The largest coefficient of Coulomb friction; 0 where there is none.
inline Real largest_friction(const ContactProblem& problem) {
  const Vector& mu = problem.increment.mu;
  return problem.increment.law == Law::coulomb && mu.size() > 0 ? mu.maxCoeff() : 0;
}

/// One answer is certain where friction is small alone.
inline void report_large_friction(Real mu) {
  constexpr Real small = 1;
  if (mu > small)
    line() << "mu = " << mu << " is above " << small
           << ": such laws may have several answers, of which one is given" << std::endl;
}

/// What faces what, in numbers.
inline void report_faces(const mortar::Statistics& s, std::size_t slaves, std::size_t masters) {
  if (s.facing == 0) {
    std::cout << "none of " << counted(slaves, "slave facet") << " faces one of "
              << counted(masters, "master facet") << ": open";
    return;
  }
  std::cout << counted(s.facing, "slave node") << " on " << counted(slaves, "facet") << " face "
            << counted(masters, "master facet") << ", gap " << s.least_gap << " to "
            << s.largest_gap << "; " << counted(s.partly_covered, "slave facet")
            << " partly covered, ";
  if (s.beyond_steps > 0) std::cout << s.beyond_steps << " left out beyond a step of the master, ";
  std::cout << counted(s.removed, "node") << " removed";
}

/// The same of one pair; nodes that carry no law are named by place.
inline void report_pair(const FacingPair& pair, bool only) {
  const mortar::Statistics& s = pair.found;
  line() << (only ? "two bodies" : pair.labels) << ": ";
  report_faces(s, pair.slaves, pair.masters);
  if (s.held > 0)
    std::cout << ", " << s.held << " of them since Dirichlet conditions hold the normal or a part "
              << "of it, as at " << pair.held_at << ": their neighbours take their share";
  std::cout << std::endl;
}

/// All pairs in one line, and from verb 3 on each in one of its own.
inline void report_pairs(const Scene& scene, long verb) {
  if (!scene.pairing) return;
  const std::vector<FacingPair>& pairs = scene.pairing->pairs();
  const std::size_t count = pairs.size();
  if (count == 1 || verb > 2) {
    for (const FacingPair& pair : pairs) report_pair(pair, count == 1);
    return;
  }
  mortar::Statistics all = pairs.front().found;
  std::size_t slaves = 0, masters = 0;
  all.facing = all.removed = all.partly_covered = all.beyond_steps = 0;
  all.least_gap = std::numeric_limits<Real>::infinity();
  all.largest_gap = -all.least_gap;
  for (const FacingPair& pair : pairs) {
    const mortar::Statistics& s = pair.found;
    slaves += pair.slaves;
    masters += pair.masters;
    all.facing += s.facing;
    all.removed += s.removed;
    all.partly_covered += s.partly_covered;
    all.beyond_steps += s.beyond_steps;
    if (s.facing == 0) continue;
    all.least_gap = std::min(all.least_gap, s.least_gap);
    all.largest_gap = std::max(all.largest_gap, s.largest_gap);
  }
  line() << count << " pairs: ";
  report_faces(all, slaves, masters);
  std::cout << "; verb=3 has each" << std::endl;
}

/// The route, and what was weighed.
inline void report_choice(const Plan& plan) {
  if (plan.route == Route::iterative) return;
  std::cout << (plan.route != Route::multigrid ? " by a factorization"
                : std::isfinite(plan.costs.sparse)
                    ? " by sparse factors, or multigrid where they cost more"
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

/// What the scene needs, and what it does not.
inline void report_plan(const Arguments& args, const Scene& scene, const ContactProblem& problem,
                        const Settings& s, long verb) {
  report_pairs(scene, verb);
  const Plan plan = make_plan(problem, s);
  line() << scene.d << "D, " << plan.dofs << " dofs, " << counted(plan.nodes, "contact node");
  if (scene.beside_pairs > 0) std::cout << ", " << nodes_on_obstacle(scene) << " on the obstacle";
  std::cout << ", " << name_of(plan.law);
  if (problem.increment.bilateral) std::cout << ", bilateral";
  if (scene.system->rotated() && !scene.pairing) std::cout << ", frames rotated";
  if (const Index corners = nodes_in_corners(scene))
    std::cout << ", " << corners << (corners == 1 ? " node" : " nodes") << " in a corner";
  if (plan.nodes == 0)
    std::cout << (scene.nodes.empty() ? "; nothing faces the slave"
                                      : "; Dirichlet conditions hold every normal displacement")
              << ": a plain linear solve";
  std::cout << "; " << name_of(s.method, methods);
  if (s.method == Method::automatic) report_choice(plan);
  if (plan.regularization) std::cout << ", " << name_of(s.reg, regularizations);
  report_left_out(args, scene, plan);
  std::cout << "; version " << version << std::endl;
}

}  // namespace frictioncg
