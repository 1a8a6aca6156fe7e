#pragma once
// Functions of a script on the contact problem that the operator would solve.
#include "../../plugin/freefem/freefem.h"

#include "../../plugin/core/clock.h"
#include "../../plugin/freefem/call.h"
#include "../../plugin/freefem/operators.h"

namespace frictioncg {

/// A scene under its load.
struct PosedScene {
  HashMatrix<int, double>& A;  ///< as the script has it
  Scene& scene;
  const Increment& increment;
  const Vector& u0;
  const System& system() const { return *scene.system->system(); }
  Vector local(const KN_<double>& u) const {
    const Vector field = copy_of(u);
    check_vector(field, "u", scene.dofs);
    return scene.system->to_local(field);
  }
};

/// name(A, b, site, extra ..., mu=.., gap=..): poses the contact problem, and hands it to
/// Body::run(stack, posed, extra ...).
template <class Body, class... Extra>
class OnScene : public E_F0mps {
 public:
  using Result = typename Body::Result;
  /// next: the first of the extra arguments
  OnScene(const basicAC_F0& args, int next)
      : site_(args, 2, next - 2),
        arguments_(args, site_.d, site_.two_bodies()),
        A_(to<Matrice_Creuse<double>*>(args[0])),
        b_(to<KN_<double>>(args[1])) {
    (extra_.push_back(to<Extra>(args[next++])), ...);
  }
  AnyType operator()(Stack stack) const override {
    return translated(Body::name, [&] {
      const Call call{stack, arguments_, b_};
      PointLaws laws;
      const auto scene = read_scene(stack, arguments_, A_, site_, true, laws);
      const LocalIncrement now = increment(Vectors(call, *scene), *scene, laws);
      return SetAny<Result>(run(
          stack,
          {*GetAny<Matrice_Creuse<double>*>((*A_)(stack))->pHM(), *scene, now.increment, now.u0},
          std::index_sequence_for<Extra...>()));
    });
  }

 private:
  template <std::size_t... k>
  Result run(Stack stack, const PosedScene& posed, std::index_sequence<k...>) const {
    return Body::run(stack, posed, GetAny<Extra>((*extra_[k])(stack))...);
  }

  Site site_;
  Arguments arguments_;
  Expression A_, b_;
  std::vector<Expression> extra_;
};

template <class Body, class... Extra>
void add_on_scene() {
  for_each_site({atype<Matrice_Creuse<double>*>(), atype<KN_<double>>()}, [](auto types) {
    const int next = static_cast<int>(types.size());
    (types.push_back(atype<Extra>()), ...);
    Global.Add(Body::name, "(",
               new Overload(atype<typename Body::Result>(), types, [=](const basicAC_F0& args) {
                 return new OnScene<Body, Extra...>(args, next);
               }));
  });
}

}  // namespace frictioncg
