#pragma once
#include "../freefem/freefem.h"

#include "../freefem/operators.h"
#include "domain.h"
#include "petsc.h"

extern KN<String>* pkarg;  // FreeFEM's: the words of the command line

namespace frictioncg {

/// Runs the body of an operator on all processes of the communicator; its rank 0 alone says what
/// went wrong. What one of them throws where it cannot be agreed upon ends them all.
template <class Body>
AnyType together(const char* name, MPI_Comm communicator, Body body) {
  std::string message;
  try {
    try {
      return body();
    } catch (const IllegalInput& e) {  // agreed upon
      int rank;
      MPI_Comm_rank(communicator, &rank);
      message = rank == 0 ? name + std::string(": ") + e.what() : name;
    }
  } catch (const std::bad_alloc&) {
    end_all(communicator, name, not_enough_memory);
  } catch (const std::exception& e) {
    end_all(communicator, name, e.what());
  } catch (...) {
    end_all(communicator, name, "an expression of the script failed");
  }
  ExecError(message);
  return Nothing;
}

/// What a script's variable of type contactdomain has: null where createMat was not called, on one
/// process.
using DomainPtr = std::shared_ptr<const Domain>;
using ContactDomainVariable = Variable<DomainPtr>;

/// [C1, C2]: the domains of two spaces, whose dofs follow each other in a call.
class JoinedDomains : public E_F0mps {
 public:
  using C = ContactDomainVariable*;
  JoinedDomains(C_F0 first, C_F0 second) : first_(to<C>(first)), second_(to<C>(second)) {}
  AnyType operator()(Stack stack) const override {
    const DomainPtr a = GetAny<C>((*first_)(stack))->value, b = GetAny<C>((*second_)(stack))->value;
    if (!a != !b)
      refuse("domain = [C1, C2]: the ", (a ? "second" : "first"),
             " is a contactdomain that is not set; let createMat(Th, C, Pk) set both");
    return variable(stack, a ? std::make_shared<const Domain>(*a, *b) : DomainPtr());
  }

 private:
  Expression first_, second_;
};

/// The conversion of lists of two domains, at compile time.
class JoinDomains : public E_F1_funcT_Type {
 public:
  JoinDomains() : E_F1_funcT_Type(atype<ContactDomainVariable*>(), atype<E_Array>(), nullptr) {}
  E_F0* code(const basicAC_F0& args) const override {
    const auto* list = dynamic_cast<const E_Array*>(args[0].LeftValue());
    if (!list || list->size() != 2)
      CompileError("domain = [C1, C2]: two contactdomains, of V1 and of V2");
    return new JoinedDomains((*list)[0], (*list)[1]);
  }
};

/// constructor(C, n, intersection, D, communicator=...), as createMat of macro_ddm.idp calls it; n
/// is the size of D.
/// intersection[0]: ranks of the neighbours, then for each of them the dofs shared with it.
class MakeDomain : public E_F0mps {
 public:
  using Result = ContactDomainVariable*;
  using Lists = KN<KN<long>>;
  explicit MakeDomain(const basicAC_F0& args)
      : C_(to<ContactDomainVariable*>(args[0])),
        lists_(to<Lists*>(args[2])),
        D_(to<KN_<double>>(args[3])) {
    args.SetNameParam(1, names, named_);
  }

  AnyType operator()(Stack stack) const override {
    MPI_Comm communicator = MPI_COMM_WORLD;
    translated("createMat", [&]() -> AnyType {
      try {
        std::vector<std::string> words;
        for (long k = 0; pkarg && k < pkarg->N(); ++k) words.push_back(*(*pkarg)[k].getap()[0]);
        start_petsc(words);
        if (named_[0])
          if (const auto* given = static_cast<MPI_Comm*>(GetAny<pcommworld>((*named_[0])(stack))))
            communicator = *given;
      } catch (const std::bad_alloc&) {  // others may wait for this process already
        if (mpisize > 1) end_all(MPI_COMM_WORLD, "createMat", not_enough_memory);
        throw;
      }
      return Nothing;
    });
    return together("createMat", communicator, [&] {
      auto* C = GetAny<ContactDomainVariable*>((*C_)(stack));
      const Lists& lists = *GetAny<Lists*>((*lists_)(stack));
      const KN_<double> D = GetAny<KN_<double>>((*D_)(stack));
      C->value = std::make_shared<const Domain>(communicator, neighbours(lists), copy_of(D));
      return SetAny<ContactDomainVariable*>(C);
    });
  }

 private:
  static std::vector<Domain::Neighbour> neighbours(const Lists& lists) {
    std::vector<Domain::Neighbour> all;
    for (long k = 0; lists.N() > 0 && k < lists[0].N(); ++k) {
      Domain::Neighbour n{static_cast<int>(lists[0][k]), {}};
      for (long s = 0; k + 1 < lists.N() && s < lists[k + 1].N(); ++s)
        n.shared.push_back(static_cast<Index>(lists[k + 1][s]));
      all.push_back(std::move(n));
    }
    return all;
  }
  static inline basicAC_F0::name_and_type names[] = {{"communicator", &typeid(pcommworld)}};

  Expression C_, lists_, D_, named_[1];
};

inline void register_contactdomain() {
  using C = ContactDomainVariable*;
  Dcl_Type<C>(::Initialize<ContactDomainVariable>, ::Destroy<ContactDomainVariable>);
  zzzfff->Add("contactdomain", atype<C>());
  set_type_of_domain(typeid(C));
  atype<C>()->AddCast(new JoinDomains);
  add_form<MakeDomain>("constructor", {atype<C>(), atype<long>(), atype<MakeDomain::Lists*>(),
                                       atype<KN_<double>>()});
}

}  // namespace frictioncg
