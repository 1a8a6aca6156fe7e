#pragma once
#include "freefem.h"

#include "scene.h"

namespace frictioncg {

struct SharedScene;  // of frictionCG-mpi alone

/// What a script's variable of type contactproblem stands for. Copies share the scene with its
/// factorization, and have laws of their own.
struct PosedProblem {
  std::shared_ptr<Scene> scene;
  PointLaws laws;  ///< as given to contactProblem(...); a call's own hold for that call
  std::shared_ptr<SharedScene> shared = {};  ///< of several processes, in place of the scene
};

/// The variable itself. FreeFEM allots its bytes without a constructor, calls init() and destroy(),
/// and never a destructor; arrays of it are made by `new`, and deleted.
class ContactProblemVariable {
 public:
  ContactProblemVariable() = default;
  ContactProblemVariable(const ContactProblemVariable& from) { *this = from; }
  ContactProblemVariable& operator=(const ContactProblemVariable& from) {
    if (this == &from) return *this;
    auto* copy = from.problem_ ? new PosedProblem(*from.problem_) : nullptr;
    delete problem_;
    problem_ = copy;
    return *this;
  }
  ~ContactProblemVariable() { destroy(); }

  void init() { problem_ = nullptr; }
  void destroy() {
    delete problem_;
    problem_ = nullptr;
  }
  void set(PosedProblem problem) {
    destroy();
    problem_ = new PosedProblem(std::move(problem));
  }
  /// A copy, so that what the script assigns meanwhile takes nothing away from a call.
  PosedProblem get() const {
    if (!is_set()) throw IllegalInput(not_set);
    return *problem_;
  }
  bool is_set() const { return problem_ != nullptr; }
  static constexpr const char* not_set =
      "the contactproblem is not set; write contactproblem C = contactProblem(A, Vh, labels, ...)";

 private:
  PosedProblem* problem_ = nullptr;
};

/// C = ..., at the declaration: the bytes hold nothing yet.
inline ContactProblemVariable* first_assignment(ContactProblemVariable* C,
                                                ContactProblemVariable* from) {
  C->init();
  *C = *from;
  return C;
}

inline ContactProblemVariable* assignment(ContactProblemVariable* C, ContactProblemVariable* from) {
  *C = *from;
  return C;
}

inline AnyType init_variable(Stack, const AnyType& x) {
  GetAny<ContactProblemVariable*>(x)->init();
  return x;
}

/// return C: a function's variables end with it, so what it returns is a copy that lives to the end
/// of the statement.
inline AnyType copy_on_return(Stack stack, const AnyType& x) {
  return SetAny<ContactProblemVariable*>(
      Add2StackOfPtr2Free(stack, new ContactProblemVariable(*GetAny<ContactProblemVariable*>(x))));
}

using ContactProblemArray = KN<ContactProblemVariable>;

inline ContactProblemArray* init_array(ContactProblemArray* const& a, const long& n) {
  a->init(n);
  return a;
}

inline ContactProblemVariable* element(ContactProblemArray* const& a, const long& k) {
  if (k < 0 || k >= a->N())
    ExecError("contactproblem[int]: index " + std::to_string(k) + " of an array of " +
              std::to_string(a->N()));
  return &(*a)[k];
}

/// Registers the type, its assignments, and arrays of it: contactproblem[int] C(n).
inline void register_contactproblem() {
  using C = ContactProblemVariable*;
  Dcl_Type<C>(init_variable, ::Destroy<ContactProblemVariable>, copy_on_return);
  zzzfff->Add("contactproblem", atype<C>());
  TheOperators->Add("<-", new OneOperator2<C, C, C>(first_assignment));
  TheOperators->Add("=", new OneOperator2<C, C, C>(assignment));

  using Array = ContactProblemArray*;
  Dcl_Type<Array>(0, ::Destroy<ContactProblemArray>, NotReturnOfthisType);
  TheOperators->Add("<-", new OneOperator2_<Array, Array, long>(init_array));
  atype<Array>()->Add("[", "", new OneOperator2_<C, Array, long>(element));
  map_type_of_map[std::make_pair(atype<long>(), atype<C>())] = atype<Array>();
}

}  // namespace frictioncg
