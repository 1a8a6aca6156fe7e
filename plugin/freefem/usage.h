#pragma once
#include "freefem.h"

#include <algorithm>
#include <cstdlib>
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

inline bool is_space(const std::string& word) { return word.rfind("fespace", 0) == 0; }

/// Whether A, b, Vh or labels are there, but not in their places. number: of the arguments before
/// the space.
inline bool exchanged(const std::vector<std::string>& given, std::size_t number) {
  const auto count = [&](const std::string& word) {
    return std::count(given.begin(), given.end(), word);
  };
  if (given.size() < number + 2 || count("matrix") != 1) return false;
  if (std::none_of(given.begin(), given.end(), is_space)) return false;
  if (number == 2 && count("real[int]") != 1) return false;
  return given[0] != "matrix" || (number == 2 && given[1] != "real[int]") ||
         !is_space(given[number]);
}

constexpr long most_spaces = 2;  ///< of a call

/// What is amiss with a call of such arguments, where it is one of the frequent slips.
inline std::string hint(const std::vector<std::string>& given, bool constructs) {
  if (given.size() > 2 && given[0] == "contactproblem")
    return "a contactproblem has its space and its labels already; after b all goes by name, as in "
           "uold=u[]";
  if (constructs && given.size() > 1 && given[1] == "real[int]")
    return "a load belongs to each call, frictionalContactCG(C, b, ...)";
  if (exchanged(given, constructs ? 1 : 2))
    return std::string("they stand in another order than ") + (constructs ? "A" : "A, b") +
           ", Vh, labels";
  if (std::count_if(given.begin(), given.end(), is_space) > most_spaces)
    return "two spaces at most; more bodies are parts of one mesh, in one space, and slave and "
           "master lists, as in (A, b, Vh, [1, 2], [3, 4])";
  const std::size_t space = constructs ? 1 : 2;
  if (given.size() > space && given[space] == "[ ]") return "a list stands where a fespace should";
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
                           "labels, ...)\n  " +
                           name + "(C, A, b, ...)                        C, with another matrix") +
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
    const std::string why = hint(given, constructs_);
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

/// The longest form has six arguments; four bodies with a space each have ten.
constexpr int most_arguments = 10;

/// What a script asks for as a number, frictionCGversion.
inline void add_version() {
  Global.New("frictionCGversion", CConstant<double>(std::strtod(version, nullptr)));
}

/// Registers the refusals, of up to as many arguments as anybody may try.
inline void add_usage() {
  for (int arguments = 0; arguments <= most_arguments; ++arguments) {
    Global.Add(operator_name, "(", new RefusedForm(atype<KN_<double>>(), arguments, false));
    Global.Add(constructor_name, "(",
               new RefusedForm(atype<ContactProblemVariable*>(), arguments, true));
  }
}

}  // namespace frictioncg
