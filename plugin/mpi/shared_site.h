#pragma once
#include "../freefem/freefem.h"

#include "../freefem/operators.h"
#include "opening.h"
#include "shared_call.h"
#include "shared_surface.h"

namespace frictioncg {

/// Where a call looks for contact; of its labels a process may have none.
class SharedSite {
 public:
  virtual ~SharedSite() = default;
  virtual int dimension() const = 0;
  virtual bool two_bodies() const { return false; }
  virtual std::vector<long> labels(Stack stack) const = 0;
  virtual std::vector<long> masters(Stack) const { return {}; }
  /// The part of this process, moved by `at`; the labels of the opening are the same on all.
  /// Collective.
  virtual std::shared_ptr<Scene> scene(Stack stack, const Opening& opening, const Domain& domain,
                                       const Displacement& at) const = 0;
};

/// Those of the labels that are on this part's boundary; each is on that of some.   Collective.
inline std::vector<long> labels_here(const Domain& domain, const std::set<long>& boundary,
                                     const std::vector<long>& labels, const std::string& mesh) {
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
                         " is not on the boundary of any part of " + mesh);
  }
  return present;
}

inline void check_size(const Domain& domain, long ndof) {
  if (ndof == domain.dofs() && domain.first() == 0) return;
  throw IllegalInput("Vh has " + std::to_string(ndof) + " degrees of freedom but the domain " +
                     std::to_string(domain.dofs()) +
                     "; make it by createMat(Th, C, Pk) with the mesh and the elements of Vh");
}

/// As owners of nodes have it.   Collective.
inline Displacement with_ghosts(const Displacement& at, const DofCount& dofs,
                                const Domain& domain) {
  domain.agree([&] { check_at(at, dofs); });
  if (!at) return at;
  Vector of_owners = *at;
  domain.update(of_owners);
  return std::make_shared<const Vector>(std::move(of_owners));
}

template <class V>
class SharedObstacleSite final : public SharedSite {
 public:
  SharedObstacleSite(const basicAC_F0& args, int first, LabelForm form)
      : Vh_(to<typename V::pfes*>(args[first])), labels_(args[first + 1], form) {}
  int dimension() const override { return Dimension<typename V::FESpace>::d; }

  std::vector<long> labels(Stack stack) const override { return labels_(stack, "labels"); }

  std::shared_ptr<Scene> scene(Stack stack, const Opening& opening, const Domain& domain,
                               const Displacement& given) const override {
    const typename V::FESpace* Vh = nullptr;
    std::set<long> boundary;
    domain.agree([&] {
      Vh = &space_of<V>(stack, Vh_, "Vh");
      check_size(domain, Vh->NbOfDF);
      boundary = labels_of_boundary(*Vh);
    });
    const std::vector<long> present = labels_here(domain, boundary, opening.labels, "the mesh");
    const Displacement at = with_ghosts(given, dofs_of(Vh->NbOfDF), domain);
    Boundary surface;
    std::vector<NodePlace> places;
    domain.agree([&] {
      surface = boundary_of(Placement(*Vh, at), present);
      places = node_places(Placement(*Vh, at));
    });
    refuse_other_domain(domain, places);
    const std::size_t own = surface.nodes.size();
    add_facets_of_others(domain, dimension(), surface);
    std::shared_ptr<Scene> scene;
    domain.agree([&] {
      scene = obstacle_scene(Placement(*Vh, at), contact_points(dimension(), surface, own));
    });
    scene->at = at;
    keep_own_points(domain, *scene);
    follow_motions_of_all(domain, name_bodies(domain, std::move(places), *scene), *scene);
    return scene;
  }

 private:
  Expression Vh_;
  Labels labels_;
};

}  // namespace frictioncg
