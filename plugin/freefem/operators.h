#pragma once
#include "freefem.h"

#include "call.h"
#include "contactproblem.h"
#include "errors.h"
#include "overload.h"
#include "renewal.h"
#include "usage.h"

namespace frictioncg {

/// u[] = frictionalContactCG(A, b, site, ...).
class SolveOnce : public E_F0mps {
 public:
  using Result = KN_<double>;
  SolveOnce(const basicAC_F0& args, std::shared_ptr<const Site> site)
      : arguments_(args, site->dimension(), site->two_bodies()),
        A_(to<Matrice_Creuse<double>*>(args[0])),
        b_(to<KN_<double>>(args[1])),
        site_(std::move(site)) {}
  static std::vector<aType> before_site() {
    return {atype<Matrice_Creuse<double>*>(), atype<KN_<double>>()};
  }
  AnyType operator()(Stack stack) const override {
    return translated(operator_name, [&] {
      const Call call(stack, arguments_, b_);
      PointLaws laws;
      const auto scene = read_scene(stack, arguments_, A_, *site_, false, laws);
      return SetAny<KN_<double>>(solve(stack, call, *scene, laws));
    });
  }

 protected:
  Arguments arguments_;
  Expression A_, b_;
  std::shared_ptr<const Site> site_;
};

/// A temporary, to the end of the statement; variables take copies.
inline AnyType variable(Stack stack, PosedProblem posed) {
  auto* C = Add2StackOfPtr2Free(stack, new ContactProblemVariable);
  C->set(std::move(posed));
  return SetAny<ContactProblemVariable*>(C);
}

/// contactproblem C = contactProblem(A, site, ...): FreeFEM's grammar takes no fespace in
/// C(A, Vh, ...).
class Construct : public E_F0mps {
 public:
  using Result = ContactProblemVariable*;
  Construct(const basicAC_F0& args, std::shared_ptr<const Site> site)
      : arguments_(args, site->dimension(), site->two_bodies()),
        A_(to<Matrice_Creuse<double>*>(args[0])),
        site_(std::move(site)) {
    arguments_.allow_only({p_mu,        p_mu2,       p_direction,   p_gap,
                           p_normal,    p_cohesion,  p_shearmax,    p_slidinglimit,
                           p_bilateral, p_maxgap,    p_smooth,      p_weight,
                           p_domain,    p_obstacle,  p_obstaclegap, p_obstaclenormal,
                           p_pivot,     p_obstacles, p_motionfree,  p_at,
                           p_forceold});
  }
  static std::vector<aType> before_site() { return {atype<Matrice_Creuse<double>*>()}; }
  AnyType operator()(Stack stack) const override {
    return translated(constructor_name, [&] {
      PosedProblem posed;
      posed.scene = read_scene(stack, arguments_, A_, *site_, true, posed.laws);
      return variable(stack, std::move(posed));
    });
  }

 protected:
  Arguments arguments_;
  Expression A_;
  std::shared_ptr<const Site> site_;
};

/// What a call names that the scene of its contactproblem does not have.
inline void refuse_what_C_lacks(const Arguments& args, const Scene& scene) {
  refuse_friction_of_none("C", args, scene);
  if (!scene.pairing && args.has(p_distance))
    throw IllegalInput("distance is that of two bodies; C has one, and an obstacle");
  refuse_motions(args, scene);
  for (Parameter p : {p_obstaclegap, p_obstaclenormal, p_obstacleforce})
    if (scene.beside_pairs == 0 && args.has(p))
      throw IllegalInput(std::string(parameters[p].name) +
                         " is that of an obstacle beside pairs; C was made without obstacle=");
}

/// u[] = frictionalContactCG(C, b, ...)
class SolveIncrement : public E_F0mps {
 public:
  using Result = KN_<double>;
  explicit SolveIncrement(const basicAC_F0& args)
      : arguments_(Arguments::of_increment(args)),
        C_(to<ContactProblemVariable*>(args[0])),
        b_(to<KN_<double>>(args[1])) {}
  static ArrayOfaType typeargs() {
    return ArrayOfaType(atype<ContactProblemVariable*>(), atype<KN_<double>>());
  }
  static E_F0* f(const basicAC_F0& args) { return new SolveIncrement(args); }
  AnyType operator()(Stack stack) const override {
    return translated(operator_name, [&] {
      const PosedProblem posed = GetAny<ContactProblemVariable*>((*C_)(stack))->get();
      refuse_what_C_lacks(arguments_, *posed.scene);
      const Call call(stack, arguments_, b_);
      const PointLaws laws = read_laws(stack, arguments_, *posed.scene,
                                       begun_laws(stack, arguments_, posed.laws), posed.laws.gap);
      return SetAny<KN_<double>>(solve(stack, call, *posed.scene, laws));
    });
  }

 protected:
  Arguments arguments_;
  Expression C_, b_;
};

/// u[] = frictionalContactCG(C, A, b, ...): C has the matrix A from here on.
class Renew : public E_F0mps {
 public:
  using Result = KN_<double>;
  explicit Renew(const basicAC_F0& args)
      : arguments_(Arguments::of_renewal(args)),
        C_(to<ContactProblemVariable*>(args[0])),
        A_(to<Matrice_Creuse<double>*>(args[1])),
        b_(to<KN_<double>>(args[2])) {}
  static ArrayOfaType typeargs() {
    return ArrayOfaType(atype<ContactProblemVariable*>(), atype<Matrice_Creuse<double>*>(),
                        atype<KN_<double>>());
  }
  static E_F0* f(const basicAC_F0& args) { return new Renew(args); }
  AnyType operator()(Stack stack) const override {
    return translated(operator_name, [&] {
      ContactProblemVariable* const C = GetAny<ContactProblemVariable*>((*C_)(stack));
      PosedProblem posed = C->get();
      refuse_shared(posed);
      refuse_what_C_lacks(arguments_, *posed.scene);
      check_normals(posed.scene->d);
      const Call call(stack, arguments_, b_);
      check_vectors(call, posed.scene->dofs);
      validate(call.settings);
      PointLaws laws;
      constexpr long own = 2;  // that of C, and the present one
      posed = renewed(stack, arguments_, A_, posed, posed.scene.use_count() == own, laws);
      C->set(posed);
      return SetAny<KN_<double>>(solve(stack, call, *posed.scene, laws));
    });
  }

 private:
  static void refuse_shared(const PosedProblem& posed) {
    if (posed.shared)
      throw IllegalInput(
          "the contactproblem belongs to several processes, where a matrix is not renewed; make it "
          "anew, with contactProblem(A, Vh, labels, ..., domain=C)");
  }
  /// FreeFEM's compiler does not know the dimension of C.
  void check_normals(int d) const {
    for (Parameter p : {p_normal, p_obstaclenormal})
      if (arguments_.has(p) && (arguments_.vector(p)[2] != nullptr) != (d == 3))
        throw IllegalInput(std::string(parameters[p].name) + " has " + (d == 3 ? "2" : "3") +
                           " components, and C is of dimension " + std::to_string(d));
  }
  Arguments arguments_;
  Expression C_, A_, b_;
};

/// Registers an operator on a site, whose types these are: make(args, first) makes it of the
/// arguments from `first` on.
template <class Operator, class Make>
void add_operator(const char* name, const std::vector<aType>& site, const Make& make) {
  std::vector<aType> types = Operator::before_site();
  const int first = static_cast<int>(types.size());
  types.insert(types.end(), site.begin(), site.end());
  Global.Add(name, "(",
             new Overload(atype<typename Operator::Result>(), types, [=](const basicAC_F0& args) {
               return new Operator(args, make(args, first));
             }));
}

/// Calls add(types, make) for one space and for two, and for labels in each form.
template <class SiteType, class Add>
void for_each_site(const Add& add) {
  const auto add_types = [&](const std::vector<aType>& types) {
    add(types, [count = types.size()](const basicAC_F0& args, int first) {
      return std::make_shared<const SiteType>(args, first, count);
    });
  };
  const aType space = atype<typename SiteType::Space*>();
  for (aType a : label_types()) {
    add_types({space, a});
    for (aType b : label_types()) {
      add_types({space, a, b});
      add_types({space, a, space, b});
    }
  }
}

/// Registers all that a script may call.
template <class Once, class Constructor, class Increment, class... Sites>
void add_operators() {
  const auto add = [](const std::vector<aType>& site, const auto& make) {
    add_operator<Once>(operator_name, site, make);
    add_operator<Constructor>(constructor_name, site, make);
  };
  (for_each_site<Sites>(add), ...);
  Global.Add(operator_name, "(", new OneOperatorCode<Increment>());
  Global.Add(operator_name, "(", new OneOperatorCode<Renew>());
  add_usage();
  add_version();
}

}  // namespace frictioncg
