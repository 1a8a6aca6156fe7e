#pragma once
#include "freefem.h"

#include <cstdlib>

#include "call.h"
#include "node_values.h"

namespace frictioncg {

/// A script's variable. FreeFEM allots its bytes without a constructor, copies an empty one there,
/// and calls destroy() in place of the destructor; arrays of it are made by `new`, and deleted.
template <class T>
struct Variable {
  T value{};
  void destroy() { value = T(); }
};
using ContactProblemVariable = Variable<PosedProblem>;

/// A copy, so that what the script assigns meanwhile takes nothing away from a call.
inline PosedProblem posed_by(const ContactProblemVariable* C) {
  if (!C->value.scene)
    throw IllegalInput(
        "the contactproblem is not set; write contactproblem C = contactProblem(A, Vh, labels, "
        "...)");
  return C->value;
}

/// Registers the type, its assignments, and arrays of it: contactproblem[int] C(n).
inline void register_contactproblem() {
  using C = ContactProblemVariable*;
  // a function's variables end with it: what it returns is a copy to the end of the statement
  const auto copy_on_return = [](Stack stack, const AnyType& x) -> AnyType {
    return SetAny<C>(Add2StackOfPtr2Free(stack, new ContactProblemVariable(*GetAny<C>(x))));
  };
  Dcl_Type<C>(::Initialize<ContactProblemVariable>, ::Destroy<ContactProblemVariable>,
              copy_on_return);
  zzzfff->Add("contactproblem", atype<C>());
  TheOperators->Add("<-", new OneOperator2<C, C, C>([](C to, C from) {
                      return new (to) ContactProblemVariable(*from);  // the bytes hold nothing yet
                    }));
  TheOperators->Add("=", new OneOperator2<C, C, C>([](C to, C from) {
                      *to = ContactProblemVariable(*from);  // all of it, or nothing
                      return to;
                    }));

  using Array = KN<ContactProblemVariable>*;
  Dcl_Type<Array>(0, ::Destroy<KN<ContactProblemVariable>>, NotReturnOfthisType);
  TheOperators->Add("<-", new OneOperator2_<Array, Array, long>([](Array const& a, const long& n) {
                      a->init(n);
                      return a;
                    }));
  const auto element = [](Array const& a, const long& k) {
    if (k < 0 || k >= a->N())
      ExecError("contactproblem[int]: index " + std::to_string(k) + " of an array of " +
                std::to_string(a->N()));
    return &(*a)[k];
  };
  atype<Array>()->Add("[", "", new OneOperator2_<C, Array, long>(element));
  map_type_of_map[std::make_pair(atype<long>(), atype<C>())] = atype<Array>();
}

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

/// Registers an operator, Form, for arguments of these types.
template <class Form>
void add_form(const char* name, const std::vector<aType>& types) {
  Global.Add(name, "(",
             new Overload(atype<typename Form::Result>(), types,
                          [](const basicAC_F0& args) { return new Form(args); }));
}

/// What a script calls an argument of this type.
inline std::string words(aType type) {
  const std::pair<aType, const char*> known[] = {
      {atype<Matrice_Creuse<double>*>(), "matrix"},
      {atype<Matrice_Creuse<Complex>*>(), "matrix<complex>"},
      {atype<KN<double>*>(), "real[int]"},
      {atype<KN_<double>>(), "real[int]"},
      {atype<KN<Complex>*>(), "complex[int]"},
      {atype<KN_<Complex>>(), "complex[int]"},
      {atype<KN<long>*>(), "int[int]"},
      {atype<KN_<long>>(), "int[int]"},
      {atype<long>(), "int"},
      {atype<long*>(), "int"},
      {atype<double>(), "real"},
      {atype<double*>(), "real"},
      {atype<string*>(), "string"},
      {atype<E_Array>(), "[ ]"},
      {atype<v_fes::pfes*>(), "fespace on a mesh"},
      {atype<v_fes3::pfes*>(), "fespace on a mesh3"},
      {atype<v_fesS::pfes*>(), "fespace on a meshS"},
      {atype<v_fesL::pfes*>(), "fespace on a meshL"},
      {atype<std::pair<FEbase<double, v_fes>*, int>>(), "function"},
      {atype<std::pair<FEbase<double, v_fes3>*, int>>(), "function"},
      {atype<ContactProblemVariable*>(), "contactproblem"}};
  for (const auto& [one, word] : known)
    if (one == type) return word;
  if (std::string(type->name()) == typeid(char).name()) return "string";  // a literal
  return "something else";
}

inline std::string usage(bool constructs) {
  const std::string name = constructs ? constructor_name : operator_name,
                    b = constructs ? "" : "b, ";
  return "\n  " + name + "(A, " + b + "Vh, labels, ...)               a rigid obstacle" +  //
         "\n  " + name + "(A, " + b + "Vh, slave, master, ...)        two bodies in one space" +
         "\n  " + name + "(A, " + b + "V1, slave, V2, master, ...)    two bodies in two spaces" +
         (constructs ? ""
                     : "\n  " + name +
                           "(C, b, ...)                           C = contactProblem(A, Vh, "
                           "labels, ...)\n  " +
                           name + "(C, A, b, ...)                        C, with another matrix") +
         "\n  A: a matrix" + (constructs ? "" : "; b: a real[int]") +
         "; Vh: a fespace such as [P1,P1], [P2,P2] on a mesh, [P1,P1,P1] on a mesh3"
         "\n  labels, slave, master: 1, [1, 2] or an int[int]; all else by name, as in mu=0.3";
}

/// Registers a form of any arguments of a given number, which refuses them with the list of forms.
/// FreeFEM prefers a form that needs fewer casts, and this one needs a cast of each.
inline void add_refusal(aType result, int arguments, bool constructs) {
  const char* const name = constructs ? constructor_name : operator_name;
  const auto refuse = [=](const basicAC_F0& args) -> E_F0* {
    std::string given;
    for (int k = 0; k < args.size(); ++k)
      given += (given.empty() ? "" : ", ") + words(args[k].left());
    CompileError(std::string(name) + ": no form takes the arguments (" + given +
                 "). The forms are" + usage(constructs) + "\n ");
    return nullptr;
  };
  Global.Add(name, "(",
             new Overload(result, std::vector<aType>(arguments, atype<AnyType>()), refuse));
}

/// The field of a call, a temporary to the end of the statement.
inline AnyType result(Stack stack, const Vector& field) {
  KN<double>* const u = Add2StackOfPtr2Free(stack, new KN<double>(0L));
  write(field, u);
  return SetAny<KN_<double>>(*u);
}

/// Of an operator on a site: what a script wrote, A first.
class OnSite : public E_F0mps {
 protected:
  /// first: of the site, the arguments from there on
  OnSite(const basicAC_F0& args, int first)
      : site_(args, first, args.size() - first),
        arguments_(args, site_.d, site_.two_bodies()),
        A_(to<Matrice_Creuse<double>*>(args[0])) {}
  Site site_;
  Arguments arguments_;
  Expression A_;
};

/// u[] = frictionalContactCG(A, b, site, ...).
class SolveOnce : public OnSite {
 public:
  using Result = KN_<double>;
  explicit SolveOnce(const basicAC_F0& args) : OnSite(args, 2), b_(to<KN_<double>>(args[1])) {}
  AnyType operator()(Stack stack) const override {
    return translated(operator_name, [&] {
      const Call call{stack, arguments_, b_};
      PointLaws laws;
      const auto scene = read_scene(stack, arguments_, A_, site_, false, laws);
      return result(stack, solve(stack, call, *scene, laws));
    });
  }

 protected:
  Expression b_;
};

/// A temporary, to the end of the statement; variables take copies.
template <class T>
AnyType variable(Stack stack, T value) {
  return SetAny<Variable<T>*>(Add2StackOfPtr2Free(stack, new Variable<T>{std::move(value)}));
}

/// contactproblem C = contactProblem(A, site, ...): FreeFEM's grammar takes no fespace in
/// C(A, Vh, ...).
class Construct : public OnSite {
 public:
  using Result = ContactProblemVariable*;
  explicit Construct(const basicAC_F0& args) : OnSite(args, 1) {
    arguments_.allow_only({p_mu,        p_mu2,       p_direction,   p_gap,
                           p_normal,    p_cohesion,  p_shearmax,    p_slidinglimit,
                           p_bilateral, p_maxgap,    p_smooth,      p_weight,
                           p_domain,    p_obstacle,  p_obstaclegap, p_obstaclenormal,
                           p_pivot,     p_obstacles, p_motionfree,  p_at,
                           p_forceold});
  }
  AnyType operator()(Stack stack) const override {
    return translated(constructor_name, [&] {
      PosedProblem posed;
      posed.scene = read_scene(stack, arguments_, A_, site_, true, posed.laws);
      return variable(stack, std::move(posed));
    });
  }
};

/// What a call names that the scene of its contactproblem does not have.
inline void refuse_what_C_lacks(const Arguments& args, const Scene& scene) {
  refuse_friction_of_none("C", args, scene);
  if (!scene.pairing && args.has(p_distance))
    throw IllegalInput("distance is that of two bodies; C has one, and an obstacle");
  if (!scene.moving)
    args.refuse(of_moving_obstacle,
                "is of an obstacle that moves, and C was made with none; name pivot or "
                "motionfree in contactProblem(...)");
  if (scene.beside_pairs == 0)
    args.refuse({p_obstaclegap, p_obstaclenormal, p_obstacleforce},
                "is that of an obstacle beside pairs; C was made without obstacle=");
}

/// u[] = frictionalContactCG(C, b, ...)
class SolveIncrement : public E_F0mps {
 public:
  using Result = KN_<double>;
  explicit SolveIncrement(const basicAC_F0& args, bool renews = false)
      : arguments_(Arguments::of_contactproblem(args, renews)),
        C_(to<ContactProblemVariable*>(args[0])),
        b_(to<KN_<double>>(args[renews ? 2 : 1])) {}
  AnyType operator()(Stack stack) const override {
    return translated(operator_name, [&] {
      const PosedProblem posed = posed_by(GetAny<ContactProblemVariable*>((*C_)(stack)));
      refuse_what_C_lacks(arguments_, *posed.scene);
      const Call call{stack, arguments_, b_};
      const PointLaws laws = read_laws(stack, arguments_, *posed.scene,
                                       begun_laws(stack, arguments_, posed.laws), posed.laws.gap);
      return result(stack, solve(stack, call, *posed.scene, laws));
    });
  }

 protected:
  Arguments arguments_;
  Expression C_, b_;
};

/// u[] = frictionalContactCG(C, A, b, ...): C has the matrix A from here on.
class Renew : public SolveIncrement {
 public:
  explicit Renew(const basicAC_F0& args)
      : SolveIncrement(args, true), A_(to<Matrice_Creuse<double>*>(args[1])) {}
  AnyType operator()(Stack stack) const override {
    return translated(operator_name, [&] {
      ContactProblemVariable* const C = GetAny<ContactProblemVariable*>((*C_)(stack));
      PosedProblem posed = posed_by(C);
      if (posed.shared)
        throw IllegalInput(
            "the contactproblem belongs to several processes, where a matrix is not renewed; make "
            "it anew, with contactProblem(A, Vh, labels, ..., domain=C)");
      refuse_what_C_lacks(arguments_, *posed.scene);
      const int d = posed.scene->d;  // which FreeFEM's compiler does not know
      for (Parameter p : {p_normal, p_obstaclenormal})
        if (arguments_.has(p) && arguments_.dimension(p) != d)
          refuse(name_of(p), " has ", 5 - d, " components, and C is of dimension ", d);
      const Call call{stack, arguments_, b_};
      check_vectors(call, posed.scene->dofs);
      PointLaws laws;
      constexpr long own = 2;  // that of C, and the present one
      posed = renewed(stack, arguments_, A_, posed, posed.scene.use_count() == own, laws);
      C->value = posed;
      return result(stack, solve(stack, call, *posed.scene, laws));
    });
  }

 private:
  Expression A_;
};

/// Calls add(types) for one space and for two, on a mesh and on a mesh3, and for labels in each
/// form, after the types of the arguments before the site.
template <class Add>
void for_each_site(const std::vector<aType>& before, const Add& add) {
  const auto add_types = [&](std::initializer_list<aType> site) {
    std::vector<aType> types = before;
    types.insert(types.end(), site);
    add(types);
  };
  const aType labels[] = {atype<long>(), atype<KN_<long>>(), atype<E_Array>()};
  for (aType space : {atype<v_fes::pfes*>(), atype<v_fes3::pfes*>()})
    for (aType a : labels) {
      add_types({space, a});
      for (aType b : labels) {
        add_types({space, a, b});
        add_types({space, a, space, b});
      }
    }
}

/// Registers all that a script may call.
template <class Once, class Constructor, class Increment>
void add_operators() {
  const aType A = atype<Matrice_Creuse<double>*>(), b = atype<KN_<double>>(),
              C = atype<ContactProblemVariable*>();
  for_each_site({A, b}, [](const auto& types) { add_form<Once>(operator_name, types); });
  for_each_site({A}, [](const auto& types) { add_form<Constructor>(constructor_name, types); });
  add_form<Increment>(operator_name, {C, b});
  add_form<Renew>(operator_name, {C, A, b});
  constexpr int most = 10;  // the longest form has six arguments; four bodies with spaces have ten
  for (int arguments = 0; arguments <= most; ++arguments) {
    add_refusal(b, arguments, false);
    add_refusal(C, arguments, true);
  }
  Global.New("frictionCGversion", CConstant<double>(std::strtod(version, nullptr)));
}

}  // namespace frictioncg
