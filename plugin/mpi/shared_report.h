#pragma once
#include "../freefem/freefem.h"

#include <iostream>

#include "../freefem/motions.h"
#include "../freefem/report.h"
#include "shared_scene.h"

namespace frictioncg {

/// A line of rank 0 on what all processes have together.   Collective.
inline void report_plan(const SharedScene& shared, const ContactProblem& problem, long verb) {
  const Domain& domain = *shared.domain;
  Real sums[] = {Real(problem.dofs()), Real(problem.nodes()), Real(shared.scene->averted.size())};
  domain.sum(sums, 3);
  const Real most = domain.largest(problem.dofs()), mu = domain.largest(largest_friction(problem));
  if (verb <= 0) return;
  report_pairs(*shared.scene, verb);
  line() << shared.scene->d << "D, " << static_cast<long>(sums[0]) << " dofs on " << domain.size()
         << (domain.size() == 1 ? " process" : " processes") << " (at most "
         << static_cast<long>(most) << " on one), " << static_cast<long>(sums[1])
         << " contact nodes, " << name_of(problem.increment.law);
  if (problem.increment.bilateral) std::cout << ", bilateral";
  std::cout << "; multigrid by PETSc; version " << version << std::endl;
  if (sums[2] > 0)
    line() << static_cast<long>(sums[2])
           << " nodes face away from the normal given, and cannot touch: left out" << std::endl;
  report_large_friction(mu);
}

/// As in one process, for the mesh as a whole.   Collective.
inline void warn_of_large_displacements(const SharedScene& shared, const Vector& field, long verb) {
  if (shared.scene->at) return;  // the geometry follows
  const Domain& domain = *shared.domain;
  const std::vector<NodePlace> places = shared.scene->places();
  const Real size = 2 * shared.extent.radius;
  const Real most = domain.largest(largest_displacement(places, shared.scene->d, field));
  if (verb > 0 && most > size) warn_of_displacements(most, "mesh", size);
}

/// A motion of the own dofs in those of the script.   Collective.
inline Vector field_of(const SharedScene& shared, const Vector& motion) {
  const Scene& scene = *shared.scene;
  return scene.system->to_global(shared.A->on_local(motion), Vector::Zero(scene.ndof()));
}

/// Some nodes of each body: enough to tell what motion a field is.
class Sample {
 public:
  /// Collective.
  explicit Sample(const SharedScene& shared) : domain_(*shared.domain) {
    constexpr Index of_all = 3000, least = 4;
    const int d = shared.scene->d;
    std::vector<NodePlace> own;
    for (const NodePlace& p : shared.scene->places())
      if (domain_.owns(p.dof[0])) own.push_back(p);
    const auto bodies = by_body(own);
    const Index count = std::max<Index>(static_cast<Index>(bodies.size()), 1);
    const std::size_t most = std::max(least, of_all / (domain_.size() * count));
    std::vector<NodePlace> picked;
    for (const auto& [number, body] : bodies)
      for (std::size_t k = 0; k < body.size(); k += 1 + body.size() / most) {
        picked.push_back(body[k]);
        own_dofs_.insert(own_dofs_.end(), body[k].dof.begin(), body[k].dof.begin() + d);
      }
    nodes_ = domain_.gathered(picked);
    Index next = 0;
    for (NodePlace& n : nodes_) std::generate_n(n.dof.begin(), d, [&] { return next++; });
  }
  const std::vector<NodePlace>& nodes() const { return nodes_; }  ///< of all processes
  /// A field at these: `d` values a node.   Collective.
  Vector of(const Vector& field) const { return domain_.gathered(Vector(field(own_dofs_))); }

 private:
  const Domain& domain_;
  std::vector<NodePlace> nodes_;
  std::vector<Index> own_dofs_;
};

/// A motion of the own dofs in words.   Collective.
inline std::string describe(const SharedScene& shared, const Vector& motion) {
  const Sample sample(shared);
  return describe_motion(sample.nodes(), shared.scene->d, sample.of(field_of(shared, motion)));
}

/// As in one process, by a sample; what the least gyration rules out needs none.   Collective.
inline std::string runaway(SharedScene& shared, const ContactProblem& problem, const Solution& own,
                           const Vector& field) {
  if (own.status != Status::converged) return "";
  const int d = shared.scene->d;
  if (!shared.gyration) shared.gyration = least_gyration(Sample(shared).nodes(), d);
  const Real most = shared.domain->largest(largest_displacement(shared.scene->places(), d, field));
  if (!(most > jamming_turn * *shared.gyration)) return "";
  const Sample sample(shared);
  return runaway(*shared.scene, field, sample.nodes(), sample.of(field),
                 shared.numbering().own_nodes, problem, own,
                 [&](const Vector& w) { return sample.of(field_of(shared, w)); });
}

/// In words, the motion that nothing holds, or that costs negative energy; or empty.   Collective.
inline std::string blamed_motion(const SharedScene& shared, const Solution& solution) {
  const Vector& motion = motion_to_blame(solution);
  return shared.domain->largest(Real(motion.size())) > 0 ? describe(shared, motion) : "";
}

/// The motions that nothing determines.   Collective.
inline void report_undetermined(const SharedScene& shared, const Solution& solution, long verb) {
  for (Index k = 0; k < solution.undetermined.cols(); ++k) {
    const std::string motion = describe(shared, solution.undetermined.col(k));
    if (verb > 0)
      line() << "nothing determines " << motion << "; the field has the least of it" << std::endl;
  }
}

}  // namespace frictioncg
