#pragma once
#include "../freefem/freefem.h"

#include "../freefem/operators.h"
#include "opening.h"
#include "shared_call.h"
#include "shared_surface.h"

namespace frictioncg {

/// Vh, labels, of which a process may have none.
class SharedSite {
 public:
  virtual ~SharedSite() = default;
  virtual int dimension() const = 0;
  virtual std::vector<long> labels(Stack stack) const = 0;
  /// labels: the same on all processes.   Collective.
  virtual std::shared_ptr<Scene> scene(Stack stack, const std::vector<long>& labels,
                                       const Domain& domain) const = 0;
};

template <class V>
class SharedObstacleSite final : public SharedSite {
 public:
  SharedObstacleSite(const basicAC_F0& args, int first, LabelForm form)
      : Vh_(to<typename V::pfes*>(args[first])), labels_(args[first + 1], form) {}
  int dimension() const override { return Dimension<typename V::FESpace>::d; }

  std::vector<long> labels(Stack stack) const override { return labels_(stack, "labels"); }

  std::shared_ptr<Scene> scene(Stack stack, const std::vector<long>& labels,
                               const Domain& domain) const override {
    const typename V::FESpace* Vh = nullptr;
    std::set<long> boundary;
    domain.agree([&] {
      Vh = &space_of<V>(stack, Vh_, "Vh");
      check_size(domain, Vh->NbOfDF);
      boundary = labels_of_boundary(*Vh);
    });
    std::vector<long> present;
    for (long label : labels) {
      if (label == cut)
        throw IllegalInput("label " + std::to_string(label) +
                           " is what macro_ddm.idp gives to the cuts between processes, which "
                           "touch nothing; name labels of the whole mesh's boundary");
      const bool here = boundary.count(label) > 0;
      if (here) present.push_back(label);
      if (domain.largest(here) == 0)
        throw IllegalInput("label " + std::to_string(label) +
                           " is not on the boundary of any part of the mesh");
    }
    Boundary surface;
    std::vector<NodePlace> places;
    domain.agree([&] {
      surface = boundary_of(*Vh, present);
      places = node_places(*Vh);
    });
    refuse_other_domain(domain, places);
    const std::size_t own = surface.nodes.size();
    add_facets_of_others(domain, dimension(), surface);
    std::shared_ptr<Scene> scene;
    domain.agree([&] { scene = obstacle_scene(*Vh, contact_points(dimension(), surface, own)); });
    keep_own_points(domain, *scene);
    follow_motions_of_all(domain, places, *scene);
    return scene;
  }

 private:
  static void check_size(const Domain& domain, long ndof) {
    if (ndof == domain.dofs()) return;
    throw IllegalInput("Vh has " + std::to_string(ndof) + " degrees of freedom but the domain " +
                       std::to_string(domain.dofs()) +
                       "; make it by createMat(Th, C, Pk) with the mesh and the elements of Vh");
  }
  Expression Vh_;
  Labels labels_;
};

/// The domain of a call of this operator; null on a process that solves alone. Without domain=
/// every process would take its own matrix for the whole problem.
inline std::shared_ptr<const Domain> domain_of(Stack stack, const Arguments& args,
                                               const Site& site) {
  if (mpisize > 1 && !args.has(p_domain))  // 0 in FreeFem++ itself
    throw IllegalInput(
        "there are " + std::to_string(mpisize) +
        " processes, and each would take its own matrix for the whole problem; give domain=C, "
        "which createMat(Th, C, Pk) makes, or, for a problem of its own on each process, a "
        "contactdomain that is not set");
  if (!args.has(p_domain)) return nullptr;
  auto domain = args.value<ContactDomainVariable*>(stack, p_domain)->get();
  if (!domain && site.is_on_part(stack))
    throw IllegalInput(
        "domain is a contactdomain that is not set, but the mesh is one process's part of a "
        "distributed one; let createMat(Th, C, Pk) set it");
  return domain;
}

/// Reads the problem of all processes: geometry, laws, the matrix.   Collective.
inline std::shared_ptr<SharedScene> read_shared(Stack stack, const Arguments& args,
                                                const Expression A, const SharedSite& site,
                                                std::shared_ptr<const Domain> domain,
                                                bool everywhere, const Opening& opening,
                                                PointLaws& laws) {
  const Timed timed(Phase::pose);
  auto shared = std::make_shared<SharedScene>();
  shared->domain = std::move(domain);
  shared->number = shared->domain->meeting().next_number();
  shared->scene = site.scene(stack, opening.labels, *shared->domain);
  Scene& scene = *shared->scene;
  Triplets matrix;
  shared->domain->agree([&] {
    set_weights(stack, args, scene);
    set_normals(stack, args, scene);
    laws = read_point_laws(stack, args, everywhere, scene, opening.laws);
    matrix = read_matrix(stack, A, scene);
  });
  const Real counts[] = {Real(scene.nodes.size()), Real(scene.averted.size())};
  if (shared->domain->largest(counts[0]) == 0 && shared->domain->largest(counts[1]) > 0)
    shared->domain->agree([&] {
      if (!scene.averted.empty()) refuse_inward(scene);
    });
  scene.tangents = shared->domain->largest(scene.tangents) > 0;
  if (!scene.tangents) laws.law = Law::frictionless;
  share(matrix, *shared);
  return shared;
}

}  // namespace frictioncg
