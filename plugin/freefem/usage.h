#pragma once
#include "freefem.h"

#include <string>
#include <utility>
#include <vector>

#include "contactproblem.h"
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

/// What is amiss with a call of such arguments, where it is one of the frequent slips.
inline std::string hint(const std::vector<std::string>& given) {
  if (given.size() > 2 && given[0] == "contactproblem")
    return "a contactproblem has its space and its labels already; after b all goes by name, as in "
           "uold=u[]";
  for (const std::string& word : given) {
    if (word == "function") return "a function stands where its fespace should";
    if (word == "fespace on a meshS" || word == "fespace on a meshL")
      return "contact is that of a body, whose mesh is a mesh or a mesh3";
    if (word == "matrix<complex>" || word == "complex[int]")
      return "the laws of contact are those of real displacements; A and b are real";
    if (word == "real") return "labels are whole numbers";
    if (word == "string") return "labels are numbers";
  }
  for (std::size_t k = 2; k < given.size(); ++k)
    if (given[k] == "real[int]") return "labels are whole numbers: an int[int]";
  return "";
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
                           "labels, ...)") +
         "\n  A: a matrix" + (constructs ? "" : "; b: a real[int]") +
         "; Vh: a fespace such as [P1,P1], [P2,P2] on a mesh, [P1,P1,P1] on a mesh3"
         "\n  labels, slave, master: 1, [1, 2] or an int[int]; all else by name, as in mu=0.3";
}

/// Takes any arguments of a given number, and refuses them with the list of forms. FreeFEM prefers
/// a form that needs fewer casts, and this one needs a cast of each.
class RefusedForm : public OneOperator {
 public:
  RefusedForm(aType result, int arguments, bool constructs)
      : OneOperator(result, Any(arguments)), constructs_(constructs) {}
  E_F0* code(const basicAC_F0& args) const override {
    std::vector<std::string> given;
    for (int k = 0; k < args.size(); ++k) given.push_back(words(args[k].left()));
    std::string list;
    for (const std::string& word : given) list += (list.empty() ? "" : ", ") + word;
    const std::string why = hint(given);
    CompileError(std::string(constructs_ ? constructor_name : operator_name) +
                 ": no form takes the arguments (" + list + ")" + (why.empty() ? "" : ": " + why) +
                 ". The forms are" + usage(constructs_) + "\n ");
    return nullptr;
  }

 private:
  struct Any : ArrayOfaType {
    explicit Any(int arguments) {
      n = arguments;
      t = new aType[n];  // ArrayOfaType deletes it
      for (int k = 0; k < n; ++k) t[k] = atype<AnyType>();
    }
  };
  bool constructs_;
};

/// Registers the refusals, of up to as many arguments as the longest form has, and one.
inline void add_usage() {
  for (int arguments = 0; arguments <= 7; ++arguments) {
    Global.Add(operator_name, "(", new RefusedForm(atype<KN_<double>>(), arguments, false));
    Global.Add(constructor_name, "(",
               new RefusedForm(atype<ContactProblemVariable*>(), arguments, true));
  }
}

}  // namespace frictioncg
