#pragma once
#include "../freefem/freefem.h"

#include "shared_site.h"

namespace frictioncg {

/// Laws at the contact points of own nodes, with those of ghosts, which follow: their gaps, as
/// their owners have them; friction is the owner's matter.   Collective.
inline PointLaws with_ghosts(PointLaws laws, const SharedScene& shared) {
  constexpr Index most = 3;  // points of a node
  const std::vector<BoundaryNode>& nodes = shared.scene->nodes;
  const Index all = static_cast<Index>(nodes.size());
  std::map<Index, std::vector<Index>> points;
  for (Index k = 0; k < all; ++k) points[nodes[k].point.dof[0]].push_back(k);
  laws.gap.conservativeResize(all);
  const auto each = [&](Index dof, const auto& take) {
    const auto found = points.find(dof);
    if (found == points.end()) return;
    for (std::size_t k = 0; k < found->second.size(); ++k) take(k, laws.gap[found->second[k]]);
  };
  shared.domain->update(
      most,
      [&](Index dof, Real* out) {
        std::fill(out, out + most, 0);
        each(dof, [&](std::size_t k, Real& gap) { out[k] = gap; });
      },
      [&](Index dof, const Real* in) {
        each(dof, [&](std::size_t k, Real& gap) { gap = in[k]; });
      });
  if (laws.law == Law::frictionless) return laws;
  laws.friction.conservativeResize(all);
  laws.friction.tail(all - static_cast<Index>(shared.own_points)).setZero();
  return laws;
}

/// u[] = frictionalContactCG(A, b, Vh, labels, ..., domain=C).
class SharedSolveOnce : public E_F0mps {
 public:
  using Result = KN_<double>;
  SharedSolveOnce(const basicAC_F0& args, std::shared_ptr<const Site> site,
                  std::shared_ptr<const SharedSite> shared)
      : arguments_(args, site->dimension(), site->two_bodies()),
        once_(args, std::move(site)),
        A_(to<Matrice_Creuse<double>*>(args[0])),
        b_(to<KN_<double>>(args[1])),
        shared_(std::move(shared)) {}
  static std::vector<aType> before_site() { return SolveOnce::before_site(); }

  AnyType operator()(Stack stack) const override {
    const auto domain = required_domain(operator_name, stack, arguments_);
    if (!domain) return once_(stack);
    return together(operator_name, domain->communicator(), [&] {
      std::unique_ptr<Call> call;
      domain->agree([&] {
        if (!shared_) throw IllegalInput(two_bodies);
        refuse_options(arguments_);
        call = std::make_unique<Call>(stack, arguments_, b_);
        set_method(call->settings);
      });
      PointLaws laws;
      const auto shared = read_shared(stack, arguments_, A_, *shared_, domain, false, laws);
      return SetAny<KN_<double>>(solve_together(stack, *call, *shared, with_ghosts(laws, *shared)));
    });
  }
  static constexpr const char* two_bodies =
      "contact of two bodies is of one process: facets that face each other may lie on different "
      "ones; leave domain out, or give the obstacle by gap and normal";

 private:
  Arguments arguments_;
  SolveOnce once_;
  Expression A_, b_;
  std::shared_ptr<const SharedSite> shared_;  ///< null with two bodies
};

/// contactproblem P = contactProblem(A, Vh, labels, ..., domain=C).
class SharedConstruct : public E_F0mps {
 public:
  using Result = ContactProblemVariable*;
  SharedConstruct(const basicAC_F0& args, std::shared_ptr<const Site> site,
                  std::shared_ptr<const SharedSite> shared)
      : arguments_(args, site->dimension(), site->two_bodies()),
        once_(args, std::move(site)),
        A_(to<Matrice_Creuse<double>*>(args[0])),
        shared_(std::move(shared)) {}
  static std::vector<aType> before_site() { return Construct::before_site(); }

  AnyType operator()(Stack stack) const override {
    const auto domain = required_domain(constructor_name, stack, arguments_);
    if (!domain) return once_(stack);
    return together(constructor_name, domain->communicator(), [&] {
      if (!shared_) throw IllegalInput(SharedSolveOnce::two_bodies);
      PosedProblem posed;
      posed.shared = read_shared(stack, arguments_, A_, *shared_, domain, true, posed.laws);
      posed.scene = posed.shared->scene;
      posed.laws = with_ghosts(posed.laws, *posed.shared);
      auto* C = Add2StackOfPtr2Free(stack, new ContactProblemVariable);
      C->set(std::move(posed));
      return SetAny<ContactProblemVariable*>(C);
    });
  }

 private:
  Arguments arguments_;
  Construct once_;
  Expression A_;
  std::shared_ptr<const SharedSite> shared_;  ///< null with two bodies
};

/// u[] = frictionalContactCG(P, b, ...), on a contactproblem of one process or of all.
class SharedSolveIncrement : public E_F0mps {
 public:
  explicit SharedSolveIncrement(const basicAC_F0& args)
      : arguments_(Arguments::of_increment(args)),
        once_(args),
        P_(to<ContactProblemVariable*>(args[0])),
        b_(to<KN_<double>>(args[1])) {}
  static ArrayOfaType typeargs() { return SolveIncrement::typeargs(); }
  static E_F0* f(const basicAC_F0& args) { return new SharedSolveIncrement(args); }
  using Result = SolveIncrement::Result;

  AnyType operator()(Stack stack) const override {
    PosedProblem posed;
    beforehand(operator_name, [&] {
      const auto* P = GetAny<ContactProblemVariable*>((*P_)(stack));
      // whether the others wait for this process, their P says, not this one's
      if (mpisize > 1 && !P->is_set())
        end_all(MPI_COMM_WORLD, operator_name, ContactProblemVariable::not_set);
      posed = P->get();
      return AnyType(Nothing);
    });
    if (!posed.shared) return once_(stack);
    SharedScene& shared = *posed.shared;
    return together(operator_name, shared.domain->communicator(), [&] {
      std::unique_ptr<Call> call;
      PointLaws laws;
      shared.domain->agree([&] {
        refuse_options(arguments_);
        if (!shared.scene->tangents && (arguments_.has(p_mu) || arguments_.has(p_slidinglimit)))
          throw IllegalInput(
              "P was made without friction; name mu or slidinglimit in contactProblem(...), too");
        call = std::make_unique<Call>(stack, arguments_, b_);
        set_method(call->settings);
        laws = read_increment_laws(stack, shared, posed.laws);
      });
      return SetAny<KN_<double>>(solve_together(stack, *call, shared, with_ghosts(laws, shared)));
    });
  }

 private:
  /// Expressions of the call at the own points alone: ghosts have no place.
  PointLaws read_increment_laws(Stack stack, SharedScene& shared, const PointLaws& given) const {
    Scene& scene = *shared.scene;
    std::vector<BoundaryNode> all = scene.nodes;
    scene.nodes.resize(shared.own_points);
    PointLaws laws;
    try {
      laws = read_laws(stack, arguments_, scene, given);
    } catch (...) {
      scene.nodes = std::move(all);
      throw;
    }
    scene.nodes = std::move(all);
    return laws;
  }

  Arguments arguments_;
  SolveIncrement once_;
  Expression P_, b_;
};

}  // namespace frictioncg
