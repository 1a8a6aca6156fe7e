#pragma once
#include "freefem.h"

#include "call.h"
#include "contactproblem.h"
#include "errors.h"

namespace frictioncg {

/// u[] = frictionalContactCG(A, b, Vh, labels, ...), for V = v_fes (2D) or v_fes3 (3D).
template <class V, class L>
class SolveOnce : public E_F0mps {
 public:
  using Result = KN_<double>;
  explicit SolveOnce(const basicAC_F0& args)
      : arguments_(args, Dimension<typename V::FESpace>::d),
        A_(to<Matrice_Creuse<double>*>(args[0])),
        b_(to<KN_<double>>(args[1])),
        Vh_(to<typename V::pfes*>(args[2])),
        labels_(args[3]) {}
  static ArrayOfaType typeargs() {
    return ArrayOfaType(atype<Matrice_Creuse<double>*>(), atype<KN_<double>>(),
                        atype<typename V::pfes*>(), atype<L>());
  }
  static E_F0* f(const basicAC_F0& args) { return new SolveOnce(args); }
  AnyType operator()(Stack stack) const override {
    return translated(operator_name, [&] {
      const Call call(stack, arguments_, b_);
      PointLaws laws;
      const auto scene = pose<V>(stack, arguments_, A_, GetAny<typename V::pfes*>((*Vh_)(stack)),
                                 labels_(stack), false, laws);
      return SetAny<KN_<double>>(solve(stack, call, *scene, laws));
    });
  }

 private:
  Arguments arguments_;
  Expression A_, b_, Vh_;
  Labels<L> labels_;
};

/// contactproblem C = contactProblem(A, Vh, labels, ...): FreeFEM's grammar takes no fespace in
/// C(A, Vh, ...).
template <class V, class L>
class Construct : public E_F0mps {
 public:
  using Result = ContactProblemVariable*;
  explicit Construct(const basicAC_F0& args)
      : arguments_(args, Dimension<typename V::FESpace>::d),
        A_(to<Matrice_Creuse<double>*>(args[0])),
        Vh_(to<typename V::pfes*>(args[1])),
        labels_(args[2]) {
    arguments_.allow_only({p_mu, p_mu2, p_direction, p_gap, p_normal, p_slidinglimit, p_bilateral});
  }
  static ArrayOfaType typeargs() {
    return ArrayOfaType(atype<Matrice_Creuse<double>*>(), atype<typename V::pfes*>(), atype<L>());
  }
  static E_F0* f(const basicAC_F0& args) { return new Construct(args); }
  AnyType operator()(Stack stack) const override {
    return translated(constructor_name, [&] {
      PosedProblem posed;
      posed.scene = pose<V>(stack, arguments_, A_, GetAny<typename V::pfes*>((*Vh_)(stack)),
                            labels_(stack), true, posed.laws);
      // a temporary, to the end of the statement; variables take copies
      auto* C = Add2StackOfPtr2Free(stack, new ContactProblemVariable);
      C->set(std::move(posed));
      return SetAny<ContactProblemVariable*>(C);
    });
  }

 private:
  Arguments arguments_;
  Expression A_, Vh_;
  Labels<L> labels_;
};

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
      if (!posed.scene->tangents && (arguments_.has(p_mu) || arguments_.has(p_slidinglimit)))
        throw IllegalInput(
            "C was made without friction; name mu or slidinglimit in contactProblem(...), too");
      const Call call(stack, arguments_, b_);
      const PointLaws laws = read_laws(stack, arguments_, *posed.scene, posed.laws);
      return SetAny<KN_<double>>(solve(stack, call, *posed.scene, laws));
    });
  }

 private:
  Arguments arguments_;
  Expression C_, b_;
};

}  // namespace frictioncg
