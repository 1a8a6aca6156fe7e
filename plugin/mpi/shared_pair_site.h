#pragma once
#include "../freefem/freefem.h"

#include "shared_site.h"

namespace frictioncg {

/// Two bodies: their labels, and their part of this process.
template <class V>
class SharedPairSite : public SharedSite {
 public:
  SharedPairSite(Labels slave, Labels master)
      : slave_(std::move(slave)), master_(std::move(master)) {}
  int dimension() const override { return Dimension<typename V::FESpace>::d; }
  bool two_bodies() const override { return true; }
  std::vector<long> labels(Stack stack) const override { return slave_(stack, "slave"); }
  std::vector<long> masters(Stack stack) const override { return master_(stack, "master"); }

 protected:
  using FESpaceType = typename V::FESpace;
  /// V2: the master's space; null where it is V1.   Collective.
  std::shared_ptr<Scene> scene_of(const FESpaceType& V1, const FESpaceType* V2,
                                  const Opening& opening, const Domain& domain,
                                  const Displacement& given) const {
    const Displacement at =
        with_ghosts(given, V2 ? dofs_of(V1.NbOfDF, V2->NbOfDF) : dofs_of(V1.NbOfDF), domain);
    std::shared_ptr<Scene> scene;
    std::vector<NodePlace> places;
    const auto here = [&](const FESpaceType& Vh, const std::vector<long>& labels,
                          const char* name) {
      return labels_here(domain, labels_of_boundary(Vh), labels,
                         V2 ? std::string("the mesh of ") + name : "the mesh");
    };
    const std::vector<long> slave = here(V1, opening.labels, "V1"),
                            master = here(V2 ? *V2 : V1, opening.masters, "V2");
    domain.agree([&] {
      if (!V2 && opening.labels == opening.masters)
        throw IllegalInput("slave and master have the same labels " + in_brackets(opening.labels) +
                           ": what touches itself is of one process; with domain= name two labels");
      PairLabels labels(opening.labels, opening.masters);
      labels.slave = slave;
      labels.master = master;
      labels.of_part = true;
      scene = V2 ? pair_scene(Placement(V1, at), Placement(*V2, at, V1.NbOfDF), labels)
                 : pair_scene(Placement(V1, at), labels);
      scene->at = at;
      places = scene->places();
    });
    refuse_other_domain(domain, places);
    name_bodies(domain, std::move(places), *scene);
    return scene;
  }

 private:
  Labels slave_, master_;
};

/// Vh, slave, master.
template <class V>
class SharedOneSpaceSite final : public SharedPairSite<V> {
 public:
  SharedOneSpaceSite(const basicAC_F0& args, int first, LabelForm slave, LabelForm master)
      : SharedPairSite<V>(Labels(args[first + 1], slave), Labels(args[first + 2], master)),
        Vh_(to<typename V::pfes*>(args[first])) {}

  std::shared_ptr<Scene> scene(Stack stack, const Opening& opening, const Domain& domain,
                               const Displacement& at) const override {
    const typename V::FESpace* Vh = nullptr;
    domain.agree([&] {
      Vh = &space_of<V>(stack, Vh_, "Vh");
      check_size(domain, Vh->NbOfDF);
    });
    return this->scene_of(*Vh, nullptr, opening, domain, at);
  }

 private:
  Expression Vh_;
};

/// V1, slave, V2, master.
template <class V>
class SharedTwoSpaceSite final : public SharedPairSite<V> {
 public:
  SharedTwoSpaceSite(const basicAC_F0& args, int first, LabelForm slave, LabelForm master)
      : SharedPairSite<V>(Labels(args[first + 1], slave), Labels(args[first + 3], master)),
        V1_(to<typename V::pfes*>(args[first])),
        V2_(to<typename V::pfes*>(args[first + 2])) {}

  std::shared_ptr<Scene> scene(Stack stack, const Opening& opening, const Domain& domain,
                               const Displacement& at) const override {
    const typename V::FESpace *V1 = nullptr, *V2 = nullptr;
    domain.agree([&] {
      V1 = &space_of<V>(stack, V1_, "V1");
      V2 = &space_of<V>(stack, V2_, "V2");
      check_sizes(domain, V1->NbOfDF, V2->NbOfDF);
    });
    return this->scene_of(*V1, V2, opening, domain, at);
  }

 private:
  static void check_sizes(const Domain& domain, Index first, Index second) {
    if (first + second == domain.dofs() && (domain.first() == 0 || domain.first() == first)) return;
    throw IllegalInput(dofs_of(first, second).in_words() + " but the domain " +
                       std::to_string(domain.dofs()) +
                       "; give domain=[C1, C2], made by createMat(Th1, C1, Pk) and "
                       "createMat(Th2, C2, Pk) with the meshes of V1 and V2");
  }
  Expression V1_, V2_;
};

}  // namespace frictioncg
