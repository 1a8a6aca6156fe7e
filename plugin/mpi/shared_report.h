#pragma once
#include "../freefem/freefem.h"

#include "../freefem/motions.h"
#include "shared_scene.h"

namespace frictioncg {

/// A line of rank 0 on what all processes have together.   Collective.
inline void report_plan(const SharedScene& shared, const ContactProblem& problem, long verb) {
  const Domain& domain = *shared.domain;
  Real sums[] = {Real(problem.dofs()), Real(problem.nodes())};
  domain.sum(sums, 2);
  const Real most = domain.largest(problem.dofs()), mu = domain.largest(largest_friction(problem));
  Real averted = shared.scene->averted.size();
  domain.sum(&averted, 1);
  if (verb <= 0) return;
  report_pairs(*shared.scene, verb);
  line() << shared.scene->d << "D, " << static_cast<long>(sums[0]) << " dofs on " << domain.size()
         << (domain.size() == 1 ? " process" : " processes") << " (at most "
         << static_cast<long>(most) << " on one), " << static_cast<long>(sums[1])
         << " contact nodes, " << name_of(problem.increment.law);
  if (problem.increment.bilateral) std::cout << ", bilateral";
  std::cout << "; multigrid by PETSc; version " << version << std::endl;
  if (averted > 0)
    line() << static_cast<long>(averted)
           << " nodes face away from the normal given, and cannot touch: left out" << std::endl;
  report_large_friction(mu);
}

/// Of PETSc's and the laws' own so far: in the iteration nothing else is sent.
inline Traffic traffic_so_far(const Domain& domain) {
  Traffic all = petsc_traffic();
  all.reductions += domain.reductions();
  return all;
}

/// What a process sends on average in one iteration, updates of the faces included.   Collective.
inline void report_traffic(const Domain& domain, const Traffic& all, Index iterations, long verb) {
  Real sums[] = {all.messages, all.bytes};
  domain.sum(sums, 2);
  if (verb < 3) return;
  const Real count = std::max<Index>(iterations, 1), each = count * domain.size();
  line() << "traffic of a process in an iteration: " << sums[0] / each << " messages, "
         << sums[1] / each / 1e3 << " kB, " << all.reductions / count << " reductions" << std::endl;
}

/// As in one process, for the mesh as a whole.   Collective.
inline void warn_of_large_displacements(const SharedScene& shared, const Vector& field, long verb) {
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

/// Some nodes of each body, with their displacement: enough to tell what motion it is. Collective.
struct SampledMotion {
  std::vector<NodePlace> nodes;
  Vector u;  ///< `d` values a node

  SampledMotion(const SharedScene& shared, const Vector& field) {
    constexpr Index of_all = 3000, least = 4;
    const Domain& domain = *shared.domain;
    const Scene& scene = *shared.scene;
    std::map<Index, std::vector<NodePlace>> own;
    for (const NodePlace& p : scene.places())
      if (domain.owns(p.dof[0])) own[p.body].push_back(p);
    const Index count = static_cast<Index>(own.size());
    const std::size_t most = std::max(least, of_all / (domain.size() * std::max<Index>(count, 1)));
    std::vector<Real> packed;
    for (const auto& [number, places] : own) {
      const std::size_t stride = 1 + places.size() / most;
      for (std::size_t k = 0; k < places.size(); k += stride) {
        const NodePlace& p = places[k];
        packed.insert(packed.end(), p.x.begin(), p.x.end());
        packed.push_back(number);
        for (int c = 0; c < 3; ++c) packed.push_back(c < scene.d ? field[p.dof[c]] : 0);
      }
    }
    unpack(domain.gathered(Eigen::Map<const Vector>(packed.data(), Index(packed.size()))), scene.d);
  }

 private:
  void unpack(const Vector& all, int d) {
    constexpr Index width = 7;  // place, body, displacement
    u.resize(all.size() / width * d);
    for (Index i = 0; i + width <= all.size(); i += width) {
      NodePlace n;
      for (int c = 0; c < 3; ++c) n.x[c] = all[i + c];
      n.body = static_cast<Index>(all[i + 3]);
      for (int c = 0; c < d; ++c) {
        n.dof[c] = i / width * d + c;
        u[n.dof[c]] = all[i + 4 + c];
      }
      nodes.push_back(n);
    }
  }
};

/// A motion of the own dofs in words.   Collective.
inline std::string describe(const SharedScene& shared, const Vector& motion) {
  const SampledMotion sample(shared, field_of(shared, motion));
  return describe_motion(sample.nodes, shared.scene->d, sample.u);
}

/// As in one process, by the numbers of SampledMotion; what the least gyration rules out needs no
/// sample.   Collective.
inline std::string runaway(SharedScene& shared, const Solution& own, const Vector& field) {
  if (own.status != Status::converged) return "";
  const int d = shared.scene->d;
  if (!shared.gyration) shared.gyration = least_gyration(SampledMotion(shared, field).nodes, d);
  const Real most = shared.domain->largest(largest_displacement(shared.scene->places(), d, field));
  if (!(most > small_turn * *shared.gyration)) return "";
  const SampledMotion sample(shared, field);
  const auto field_in_sample = [&](const Vector& w) {
    return SampledMotion(shared, field_of(shared, w)).u;
  };
  const auto held = [&](const LargeTurn& turn) {
    return held_by_contact(*shared.scene, shared.numbering().own_nodes, own.state, *shared.system,
                           turn);
  };
  return runaway(sample.nodes, d, sample.u, *shared.system, field_in_sample, held);
}

/// The motions that a call leaves open; the first of them that nothing holds, or empty. Collective.
inline std::string report_motions(const SharedScene& shared, const Solution& solution, long verb) {
  std::string unheld;
  if (shared.domain->largest(Real(solution.unheld_motion.size())) > 0) {
    unheld = describe(shared, solution.unheld_motion);
    if (verb > 0) line() << "nothing holds " << unheld << std::endl;
  }
  for (Index k = 0; k < solution.undetermined.cols(); ++k) {
    const std::string motion = describe(shared, solution.undetermined.col(k));
    if (verb > 0)
      line() << "nothing determines " << motion << "; the field has the least of it" << std::endl;
  }
  return unheld;
}

}  // namespace frictioncg
