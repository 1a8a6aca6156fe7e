#pragma once
#include "freefem.h"

#include <memory>

#include "errors.h"
#include "labels.h"
#include "pair_scene.h"

namespace frictioncg {

/// Where a call looks for contact: its arguments between b and the options.
class Site {
 public:
  virtual ~Site() = default;
  virtual int dimension() const = 0;
  virtual bool two_bodies() const { return false; }
  virtual bool is_on_part(Stack stack) const = 0;  ///< of a distributed mesh
  /// The geometry as it is now, moved by `at` where that is not null; obstacle: labels beside pairs
  /// of bodies.
  virtual std::shared_ptr<Scene> scene(Stack stack, const std::vector<long>& obstacle,
                                       const Displacement& at) const = 0;
};

inline void check_at(const Displacement& at, const DofCount& dofs) {
  if (at) check_vector(*at, "at", dofs);
}

/// make(at), which can be made at another displacement, too.
template <class Make>
std::shared_ptr<Scene> scene_at(const Displacement& at, const Make& make) {
  std::shared_ptr<Scene> scene = make(at);
  scene->at = at;
  scene->moved_to = [make](const Displacement& other) { return scene_at(other, make); };
  return scene;
}

/// The space that an expression of the script stands for, made anew where its mesh has changed.
template <class V>
const typename V::FESpace& space_of(Stack stack, Expression e, const char* name) {
  const typename V::FESpace* Vh = evaluated(name, [&] {
    typename V::pfes* p = GetAny<typename V::pfes*>((*e)(stack));
    return p && *p ? static_cast<typename V::FESpace*>(**p) : nullptr;
  });
  if (!Vh) throw IllegalInput(std::string(name) + " is not a finite-element space");
  return *Vh;
}

constexpr long cut = -111111;  ///< macro_ddm's label of what it cuts

/// Under several processes: whether a mesh is the part of one that FreeFEM's macro_ddm.idp has
/// distributed. A mesh that each process has for itself is none.
template <class FESpaceType>
bool is_on_part_of_mesh(const FESpaceType& Vh) {
  return mpisize > 1 && labels_of_boundary(Vh).count(cut) > 0;  // 0 in FreeFem++ itself
}

template <class FESpaceType>
void refuse_part_of_mesh(const FESpaceType& Vh) {
  if (is_on_part_of_mesh(Vh))
    throw IllegalInput(
        "Vh lies on one process's part of a distributed mesh, and its matrix would be taken for "
        "the whole problem; load frictionCG-mpi, and give domain=C, which createMat(Th, C, Pk) "
        "makes");
}

/// Vh, labels: one body, and an obstacle given by gap and normal.
template <class V>
class ObstacleSite final : public Site {
 public:
  ObstacleSite(const basicAC_F0& args, int first, LabelForm form)
      : Vh_(to<typename V::pfes*>(args[first])), labels_(args[first + 1], form) {}
  int dimension() const override { return Dimension<typename V::FESpace>::d; }
  bool is_on_part(Stack stack) const override {
    return is_on_part_of_mesh(space_of<V>(stack, Vh_, "Vh"));
  }
  std::shared_ptr<Scene> scene(Stack stack, const std::vector<long>&,
                               const Displacement& at) const override {
    const auto& Vh = space_of<V>(stack, Vh_, "Vh");
    refuse_part_of_mesh(Vh);
    return scene_at(
        at, [on_mesh = Placement(Vh), labels = labels_(stack, "labels")](const Displacement& U) {
          check_at(U, dofs_of(on_mesh.space().NbOfDF));
          return obstacle_scene(Placement(on_mesh.space(), U), labels);
        });
  }

 private:
  Expression Vh_;
  Labels labels_;
};

/// Vh, slave, master: two bodies in one space.
template <class V>
class OneSpaceSite final : public Site {
 public:
  OneSpaceSite(const basicAC_F0& args, int first, LabelForm slave, LabelForm master)
      : Vh_(to<typename V::pfes*>(args[first])),
        slave_(args[first + 1], slave),
        master_(args[first + 2], master) {}
  int dimension() const override { return Dimension<typename V::FESpace>::d; }
  bool two_bodies() const override { return true; }
  bool is_on_part(Stack stack) const override {
    return is_on_part_of_mesh(space_of<V>(stack, Vh_, "Vh"));
  }
  std::shared_ptr<Scene> scene(Stack stack, const std::vector<long>& obstacle,
                               const Displacement& at) const override {
    const auto& Vh = space_of<V>(stack, Vh_, "Vh");
    refuse_part_of_mesh(Vh);
    return scene_at(at, [on_mesh = Placement(Vh), obstacle,
                         labels = PairLabels(slave_(stack, "slave"), master_(stack, "master"))](
                            const Displacement& U) {
      check_at(U, dofs_of(on_mesh.space().NbOfDF));
      return pair_scene(Placement(on_mesh.space(), U), labels, obstacle);
    });
  }

 private:
  Expression Vh_;
  Labels slave_, master_;
};

/// V1, slave, V2, master: two bodies in spaces of their own.
template <class V>
class TwoSpaceSite final : public Site {
 public:
  TwoSpaceSite(const basicAC_F0& args, int first, LabelForm slave, LabelForm master)
      : V1_(to<typename V::pfes*>(args[first])),
        V2_(to<typename V::pfes*>(args[first + 2])),
        slave_(args[first + 1], slave),
        master_(args[first + 3], master) {}
  int dimension() const override { return Dimension<typename V::FESpace>::d; }
  bool two_bodies() const override { return true; }
  bool is_on_part(Stack stack) const override {
    return is_on_part_of_mesh(space_of<V>(stack, V1_, "V1")) ||
           is_on_part_of_mesh(space_of<V>(stack, V2_, "V2"));
  }
  std::shared_ptr<Scene> scene(Stack stack, const std::vector<long>& obstacle,
                               const Displacement& at) const override {
    const auto &V1 = space_of<V>(stack, V1_, "V1"), &V2 = space_of<V>(stack, V2_, "V2");
    refuse_part_of_mesh(V1);
    refuse_part_of_mesh(V2);
    return scene_at(at, [first = Placement(V1), second = Placement(V2), obstacle,
                         labels = PairLabels(slave_(stack, "slave"), master_(stack, "master"))](
                            const Displacement& U) {
      const Index n = first.space().NbOfDF;
      check_at(U, dofs_of(n, second.space().NbOfDF));
      return pair_scene(Placement(first.space(), U), Placement(second.space(), U, n), labels,
                        obstacle);
    });
  }

 private:
  Expression V1_, V2_;
  Labels slave_, master_;
};

}  // namespace frictioncg
