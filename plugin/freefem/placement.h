#pragma once
#include "freefem.h"

#include "dimension.h"

namespace frictioncg {

/// A displacement by the dofs of a call, or null.
using Displacement = std::shared_ptr<const Vector>;

/// The displacement at which the geometry of a call is, and that where its increment began, which
/// decides what is chosen; null: the same.
struct Stage {
  Displacement at, begun;
  const char* name = "at";  ///< of the argument that `at` is
};

/// A space, and where its nodes are: on its mesh, or moved from there by a displacement. Elements
/// stay straight between their vertices, as those of a mesh that movemesh moves.
template <class FESpaceType>
class Placement {
  using D = Dimension<FESpaceType>;

 public:
  /// Among the dofs of the call those of this space begin at `offset`.
  explicit Placement(const FESpaceType& Vh, const Stage& stage = {}, Index offset = 0)
      : keep_(const_cast<FESpaceType*>(&Vh)), stage_(stage), offset_(offset) {
    if (is_moved()) move_vertices();
  }

  const FESpaceType& space() const { return *keep_; }
  const typename D::Mesh& mesh() const { return space().Th; }
  bool is_moved() const { return stage_.at != nullptr; }
  std::string moved_by() const { return stage_.name; }  ///< the argument
  /// Where the increment began; null: here.
  const Placement* begun() const {
    if (!begun_ && is_moved() && stage_.begun)
      begun_ =
          std::make_shared<const Placement>(space(), Stage{stage_.begun, nullptr, "uold"}, offset_);
    return begun_.get();
  }

  /// A point of element k, by its place in the reference element.
  Fem2D::R3 operator()(int k, const Fem2D::R3& hat) const {
    Fem2D::R3 x = D::position(mesh(), k, hat);
    if (!is_moved()) return x;
    const double lambda[4] = {1 - hat.x - hat.y - hat.z, hat.x, hat.y, hat.z};
    for (int v = 0; v <= D::d; ++v) x += lambda[v] * (*of_vertex_)[mesh()(k, v)];
    return x;
  }
  Vertices vertices(int k) const {
    Vertices x;
    for (int v = 0; v <= D::d; ++v) x[v] = (*this)(k, corner(v));
    return x;
  }
  /// The displacement of the node that has these dofs.
  Fem2D::R3 moved(const std::array<Index, 3>& dof) const {
    Fem2D::R3 u;
    for (int c = 0; c < D::d && is_moved(); ++c) u[c] = (*stage_.at)[offset_ + dof[c]];
    return u;
  }
  /// A node of element k itself: that of a P2 edge may have left the edge's middle.
  Fem2D::R3 node(int k, const Fem2D::R3& hat, const std::array<Index, 3>& dof) const {
    return D::position(mesh(), k, hat) + moved(dof);
  }

  /// Whether the displacement turns element k inside out, or flattens it.
  bool is_inverted(int k) const {
    constexpr double flat = 1e-9;
    if (!is_moved()) return false;
    Vertices X;
    for (int v = 0; v <= D::d; ++v) X[v] = D::position(mesh(), k, corner(v));
    return !(D::content(vertices(k)) > flat * D::content(X));
  }

 private:
  static Fem2D::R3 corner(int v) { return Fem2D::R3(v == 1, v == 2, v == 3); }

  /// Elements with no new vertex are passed over.
  void move_vertices() {
    const auto displacement = std::make_shared<std::vector<Fem2D::R3>>(mesh().nv);
    std::vector<char> known(mesh().nv, 0);
    Interpolation ip;
    for (int k = 0; k < mesh().nt; ++k) {
      bool news = false;
      for (int v = 0; v <= D::d; ++v) news = news || !known[mesh()(k, v)];
      if (!news) continue;
      const typename D::Element K(space()[k]);
      D::interpolate(K, ip);
      for (std::size_t e = 0; e < ip.dof.size(); ++e) {
        const int v = corner_at(ip.hat[ip.point[e]], D::d), c = ip.component[e];
        if (v < 0 || c >= D::d || ip.coefficient[e] != 1) continue;
        (*displacement)[mesh()(k, v)][c] = (*stage_.at)[offset_ + K(ip.dof[e])];
        known[mesh()(k, v)] = 1;
      }
    }
    of_vertex_ = displacement;
  }

  CountPointer<FESpaceType> keep_;
  Stage stage_;
  mutable std::shared_ptr<const Placement> begun_;  ///< once it is asked for
  Index offset_;
  std::shared_ptr<const std::vector<Fem2D::R3>> of_vertex_;  ///< of the mesh; null: none
};

}  // namespace frictioncg
