#pragma once
#include "freefem.h"

#include <cstdlib>

#include "contactproblem.h"
#include "overload.h"
#include "parameters.h"

namespace frictioncg {

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

/// The longest form has six arguments; four bodies with a space each have ten.
constexpr int most_arguments = 10;

/// What a script asks for as a number, frictionCGversion.
inline void add_version() {
  Global.New("frictionCGversion", CConstant<double>(std::strtod(version, nullptr)));
}

/// Registers the refusals, of up to as many arguments as anybody may try.
inline void add_usage() {
  for (int arguments = 0; arguments <= most_arguments; ++arguments) {
    add_refusal(atype<KN_<double>>(), arguments, false);
    add_refusal(atype<ContactProblemVariable*>(), arguments, true);
  }
}

}  // namespace frictioncg
