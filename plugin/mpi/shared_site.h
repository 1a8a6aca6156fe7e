#pragma once
#include "../freefem/freefem.h"

#include "../freefem/operators.h"
#include "contact_domain.h"
#include "shared_call.h"
#include "together.h"

namespace frictioncg {

/// Vh, labels, of which a process may have none.
class SharedSite {
 public:
  virtual ~SharedSite() = default;
  virtual int dimension() const = 0;
  /// Collective.
  virtual std::shared_ptr<Scene> scene(Stack stack, const Domain& domain) const = 0;
};

template <class V>
class SharedObstacleSite final : public SharedSite {
 public:
  SharedObstacleSite(const basicAC_F0& args, int first, LabelForm form)
      : Vh_(to<typename V::pfes*>(args[first])), labels_(args[first + 1], form) {}
  int dimension() const override { return Dimension<typename V::FESpace>::d; }

  std::shared_ptr<Scene> scene(Stack stack, const Domain& domain) const override {
    const typename V::FESpace* Vh = nullptr;
    std::vector<long> labels;
    std::set<long> boundary;
    domain.agree([&] {
      Vh = &space_of<V>(stack, Vh_, "Vh");
      labels = labels_(stack, "labels");
      check_size(domain, Vh->NbOfDF);
      boundary = labels_of_boundary(*Vh);
    });
    domain.require_same("the number of labels", static_cast<Real>(labels.size()));
    std::vector<long> present;
    for (long label : labels) {
      domain.require_same("a label", static_cast<Real>(label));
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
    std::shared_ptr<Scene> scene;
    domain.agree([&] { scene = obstacle_scene(*Vh, present); });
    refuse_other_domain(domain, scene->places());
    keep_own_points(domain, *scene);
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

/// The domain of a call; null where it names none, or one that is not set.
inline std::shared_ptr<const Domain> domain_of(Stack stack, const Arguments& args) {
  if (!args.has(p_domain)) return nullptr;
  return GetAny<ContactDomainVariable*>((*args.expression(p_domain))(stack))->get();
}

/// Without domain= every process would take its own matrix for the whole problem.
inline void refuse_without_domain(const Arguments& args) {
  if (mpisize <= 1 || args.has(p_domain)) return;  // 0 in FreeFem++ itself
  throw IllegalInput(
      "there are " + std::to_string(mpisize) +
      " processes, and each would take its own matrix for the whole problem; give domain=C, which "
      "createMat(Th, C, Pk) makes, or, for a problem of its own on each process, a contactdomain "
      "that is not set");
}

/// The domain of a call of this operator; null on a process that solves alone.
inline std::shared_ptr<const Domain> required_domain(const char* name, Stack stack,
                                                     const Arguments& args) {
  std::shared_ptr<const Domain> domain;
  beforehand(name, [&] {
    refuse_without_domain(args);
    domain = domain_of(stack, args);
    return AnyType(Nothing);
  });
  return domain;
}

/// What several processes do not do is refused by name.
inline void refuse_options(const Arguments& args) {
  const auto refuse = [&](Parameter p, const char* why) {
    if (args.has(p)) throw IllegalInput(std::string(parameters[p].name) + " " + why);
  };
  const char* const own =
      "belongs to methods of one process; with domain= there is multigrid alone";
  for (Parameter p : {p_newton, p_polish, p_reg, p_regeps, p_precon, p_omega, p_step, p_memory})
    refuse(p, own);
  refuse(p_distance, "is that of two bodies; there is one, and an obstacle");
  refuse(p_times, "is of one process; measure around the call, by mpiWtime()");
}

/// Multigrid is what method="auto" stands for.
inline void set_method(Settings& settings) {
  if (settings.method != Method::automatic && settings.method != Method::multigrid)
    throw IllegalInput(std::string("method=\"") + name_of(settings.method, methods) +
                       "\" is of one process; with domain= there is method=\"multigrid\" alone: "
                       "leave it out");
  settings.method = Method::multigrid;
}

/// Reads the problem of all processes: geometry, laws, the matrix.   Collective.
inline std::shared_ptr<SharedScene> read_shared(Stack stack, const Arguments& args,
                                                const Expression A, const SharedSite& site,
                                                std::shared_ptr<const Domain> domain,
                                                bool everywhere, PointLaws& laws) {
  auto shared = std::make_shared<SharedScene>();
  shared->domain = std::move(domain);
  shared->scene = site.scene(stack, *shared->domain);
  Scene& scene = *shared->scene;
  Triplets matrix;
  shared->domain->agree([&] {
    set_normals(stack, args, scene);
    laws = read_point_laws(stack, args, everywhere, scene);
    matrix = triplets(GetAny<Matrice_Creuse<double>*>((*A)(stack)), scene.dofs);
  });
  scene.tangents = shared->domain->largest(scene.tangents) > 0;
  if (!scene.tangents) laws.law = Law::frictionless;
  share(matrix, *shared);
  return shared;
}

}  // namespace frictioncg
