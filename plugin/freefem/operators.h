#pragma once
#include "freefem.h"

#include "call.h"
#include "contactproblem.h"
#include "errors.h"
#include "renewal.h"

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

 private:
  Arguments arguments_;
  Expression A_, b_;
  std::shared_ptr<const Site> site_;
};

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
      // a temporary, to the end of the statement; variables take copies
      auto* C = Add2StackOfPtr2Free(stack, new ContactProblemVariable);
      C->set(std::move(posed));
      return SetAny<ContactProblemVariable*>(C);
    });
  }

 private:
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

 private:
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

/// One form of the arguments of an operator: FreeFEM chooses among them by their types.
class Overload : public OneOperator {
 public:
  using Make = std::function<E_F0*(const basicAC_F0&)>;
  Overload(aType result, const std::vector<aType>& types, Make make)
      : OneOperator(result, Types(types)), make_(std::move(make)) {}
  E_F0* code(const basicAC_F0& args) const override { return make_(args); }

 private:
  struct Types : ArrayOfaType {
    explicit Types(const std::vector<aType>& types) {
      n = static_cast<int>(types.size());
      t = new aType[n];  // ArrayOfaType deletes it
      std::copy(types.begin(), types.end(), t);
    }
  };
  Make make_;
};

/// Makes a site of the arguments from `first` on.
using MakeSite = std::function<std::shared_ptr<const Site>(const basicAC_F0& args, int first)>;

template <class Operator>
void add_operator(const char* name, const std::vector<aType>& site, const MakeSite& make) {
  std::vector<aType> types = Operator::before_site();
  const int first = static_cast<int>(types.size());
  types.insert(types.end(), site.begin(), site.end());
  Global.Add(name, "(",
             new Overload(atype<typename Operator::Result>(), types, [=](const basicAC_F0& args) {
               return new Operator(args, make(args, first));
             }));
}

/// Registers the operator and the constructor for arguments of these types.
inline void add_site(const std::vector<aType>& site, const MakeSite& make) {
  add_operator<SolveOnce>(operator_name, site, make);
  add_operator<Construct>(constructor_name, site, make);
}

/// Calls add(types, make) for one space and for two, and for labels in each form, V = v_fes (2D) or
/// v_fes3 (3D).
template <class V, class Add>
void for_each_site(Add add) {
  const aType space = atype<typename V::pfes*>();
  for (LabelForm a : label_forms) {
    add({space, type_of(a)}, [a](const basicAC_F0& args, int first) {
      return std::make_shared<ObstacleSite<V>>(args, first, a);
    });
    for (LabelForm b : label_forms) {
      add({space, type_of(a), type_of(b)}, [a, b](const basicAC_F0& args, int first) {
        return std::make_shared<OneSpaceSite<V>>(args, first, a, b);
      });
      add({space, type_of(a), space, type_of(b)}, [a, b](const basicAC_F0& args, int first) {
        return std::make_shared<TwoSpaceSite<V>>(args, first, a, b);
      });
    }
  }
}

}  // namespace frictioncg
