#pragma once
#include "freefem.h"

#include "arguments.h"
#include "scene.h"

namespace frictioncg {

/// Reads the law and the gap of this call; what it does not name stays as the scene has it.
inline void set_laws(Stack stack, const Arguments& args, Scene& scene) {
  if (args.has(p_mu) && args.has(p_slidinglimit))
    throw IllegalInput(
        "mu and slidinglimit are both given; Coulomb friction takes mu, a given limit "
        "slidinglimit");
  if (args.has(p_gap) || scene.gap.size() == 0) scene.gap = args.at_nodes(stack, p_gap, scene);
  scene.bilateral = args.value(stack, p_bilateral, scene.bilateral);
  if (args.has(p_mu)) {
    scene.mu = args.at_nodes(stack, p_mu, scene);
    scene.law = Law::coulomb;
  }
  if (args.has(p_slidinglimit)) {
    scene.limit = args.at_nodes(stack, p_slidinglimit, scene);
    for (std::size_t k = 0; k < scene.nodes.size(); ++k) scene.limit[k] *= scene.nodes[k].weight;
    scene.law = Law::tresca;
  }
}

/// Poses the problem: geometry, laws, and the matrix in local frames. A node gets tangential laws
/// where `everywhere` or its own mu or limit asks for them.
template <class V>
std::shared_ptr<Scene> pose(Stack stack, const Arguments& args, Matrice_Creuse<double>* A,
                            typename V::pfes* pVh, const std::vector<long>& labels,
                            bool everywhere) {
  std::shared_ptr<Scene> scene = make_scene<V>(pVh, labels);
  const Triplets t = triplets(A, scene->ndof);
  args.set_normals(stack, *scene);
  set_laws(stack, args, *scene);
  args.set_orthotropy(stack, *scene);
  const bool friction = scene->law != Law::frictionless;
  const Vector* strength = scene->law == Law::coulomb ? &scene->mu : &scene->limit;
  bool any = false;
  for (std::size_t k = 0; k < scene->nodes.size(); ++k)
    any |= scene->nodes[k].point.friction = friction && (everywhere || (*strength)[k] > 0);
  if (!any) scene->law = Law::frictionless;
  scene->assemble(t);
  return scene;
}

/// Translates the errors of a body into FreeFEM's, with their message.
template <class Body>
AnyType translated(const char* name, Body body) {
  try {
    return body();
  } catch (const IllegalInput& e) {
    ExecError(std::string(name) + ": " + e.what());
  } catch (const std::bad_alloc&) {
    ExecError(std::string(name) + ": not enough memory for this problem");
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    ExecError(std::string(name) + ": internal error: " + e.what());
  }
  return Nothing;
}

/// The labels argument: an int, an int[int], or [1, 2].
template <class LabelArgument>
class Labels {
 public:
  explicit Labels(const C_F0& argument) {
    if constexpr (std::is_same_v<LabelArgument, E_Array>) {
      const E_Array* list = dynamic_cast<const E_Array*>(argument.LeftValue());
      for (int k = 0; list && k < list->size(); ++k) expressions_.push_back(to<long>((*list)[k]));
    } else {
      expressions_.push_back(to<LabelArgument>(argument));
    }
  }
  std::vector<long> operator()(Stack stack) const {
    std::vector<long> all;
    if constexpr (std::is_same_v<LabelArgument, KN_<long>>) {
      const KN_<long> list = GetAny<KN_<long>>((*expressions_[0])(stack));
      for (long k = 0; k < list.N(); ++k) all.push_back(list[k]);
    } else {
      for (Expression e : expressions_) all.push_back(GetAny<long>((*e)(stack)));
    }
    if (all.empty()) throw IllegalInput("labels is empty; name the boundary that may touch");
    return all;
  }

 private:
  std::vector<Expression> expressions_;
};

}  // namespace frictioncg
