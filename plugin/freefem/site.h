#pragma once
#include "freefem.h"

#include "errors.h"
#include "labels.h"
#include "pair_scene.h"

namespace frictioncg {

/// Where a call looks for contact: its arguments between b and the options.
class Site {
 public:
  virtual ~Site() = default;
  virtual int dimension() const = 0;
  virtual bool two_bodies() const = 0;
  virtual bool is_on_part(Stack stack) const = 0;            ///< of a distributed mesh
  virtual std::vector<long> labels(Stack stack) const = 0;   ///< of the slave, of two bodies
  virtual std::vector<long> masters(Stack stack) const = 0;  ///< none where there is one body
  /// The geometry as it is now, moved where the stage says so; obstacle: labels beside pairs of
  /// bodies.
  virtual std::shared_ptr<Scene> scene(Stack stack, const std::vector<long>& obstacle,
                                       const Stage& stage) const = 0;
};

inline void check_stage(const Stage& stage, const DofCount& dofs) {
  if (stage.at) check_vector(*stage.at, "at", dofs);
  if (stage.begun) check_vector(*stage.begun, "uold", dofs);
}

/// make(stage), which can be made at another one, too.
template <class Make>
std::shared_ptr<Scene> scene_at(const Stage& stage, const Make& make) {
  std::shared_ptr<Scene> scene = make(stage);
  scene->at = stage.at;
  scene->moved_to = [make](const Stage& other) { return scene_at(other, make); };
  return scene;
}

/// The geometry of one body before an obstacle, of two bodies in one space, or in spaces of their
/// own, moved where the stage says so, and to be moved elsewhere later.
template <class FESpaceType>
std::shared_ptr<Scene> scene_on(const FESpaceType& Vh, const std::vector<long>& labels,
                                const Stage& stage) {
  return scene_at(stage, [on_mesh = Placement(Vh), labels](const Stage& U) {
    check_stage(U, dofs_of(on_mesh.space().NbOfDF));
    return obstacle_scene(Placement(on_mesh.space(), U), labels);
  });
}

template <class FESpaceType>
std::shared_ptr<Scene> scene_on(const FESpaceType& Vh, const PairLabels& labels,
                                const std::vector<long>& obstacle, const Stage& stage) {
  return scene_at(stage, [on_mesh = Placement(Vh), labels, obstacle](const Stage& U) {
    check_stage(U, dofs_of(on_mesh.space().NbOfDF));
    return pair_scene(Placement(on_mesh.space(), U), labels, obstacle);
  });
}

template <class FESpaceType>
std::shared_ptr<Scene> scene_on(const FESpaceType& V1, const FESpaceType& V2,
                                const PairLabels& labels, const std::vector<long>& obstacle,
                                const Stage& stage) {
  return scene_at(
      stage, [first = Placement(V1), second = Placement(V2), labels, obstacle](const Stage& U) {
        const Index n = first.space().NbOfDF;
        check_stage(U, dofs_of(n, second.space().NbOfDF));
        return pair_scene(Placement(first.space(), U), Placement(second.space(), U, n), labels,
                          obstacle);
      });
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

/// Vh, labels: one body, and an obstacle given by gap and normal. Vh, slave, master: two bodies in
/// one space; V1, slave, V2, master: in spaces of their own.
template <class V, class Base = Site>
class SiteOf : public Base {
 public:
  using Space = typename V::pfes;
  /// count: of the arguments from `first` on.
  SiteOf(const basicAC_F0& args, int first, std::size_t count) : slave_(args[first + 1]) {
    spaces_.push_back(to<Space*>(args[first]));
    if (count > 3) spaces_.push_back(to<Space*>(args[first + 2]));
    if (count > 2) master_.emplace(args[first + static_cast<int>(count) - 1]);
  }
  int dimension() const override { return Dimension<typename V::FESpace>::d; }
  bool two_bodies() const override { return master_.has_value(); }
  bool is_on_part(Stack stack) const override {
    bool on_part = false;
    for (std::size_t k = 0; k < spaces_.size(); ++k)
      on_part = is_on_part_of_mesh(space(stack, k)) || on_part;
    return on_part;
  }
  std::vector<long> labels(Stack stack) const override {
    return slave_(stack, master_ ? "slave" : "labels");
  }
  std::vector<long> masters(Stack stack) const override {
    return master_ ? (*master_)(stack, "master") : std::vector<long>();
  }
  std::shared_ptr<Scene> scene(Stack stack, const std::vector<long>& obstacle,
                               const Stage& stage) const override {
    if (is_on_part(stack))
      throw IllegalInput(
          "Vh lies on one process's part of a distributed mesh, and its matrix would be taken for "
          "the whole problem; load frictionCG-mpi, and give domain=C, which createMat(Th, C, Pk) "
          "makes");
    const std::vector<long> slave = labels(stack), master = masters(stack);
    const auto& V1 = space(stack, 0);  // last: what an expression does may make it anew
    if (!master_) return scene_on(V1, slave, stage);
    const PairLabels pair(slave, master);
    return in_two_spaces() ? scene_on(V1, space(stack, 1), pair, obstacle, stage)
                           : scene_on(V1, pair, obstacle, stage);
  }

 protected:
  bool in_two_spaces() const { return spaces_.size() > 1; }
  const typename V::FESpace& space(Stack stack, std::size_t k) const {
    return space_of<V>(stack, spaces_[k], !in_two_spaces() ? "Vh" : k == 0 ? "V1" : "V2");
  }

 private:
  std::vector<Expression> spaces_;
  Labels slave_;
  std::optional<Labels> master_;
};

}  // namespace frictioncg
