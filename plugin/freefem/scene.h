#pragma once
#include "../core/solver.h"
#include "arguments.h"
#include "pairing.h"

namespace frictioncg {

/// A script's matrix A, copied, and beside it A - S: S (n x n) is what forces of contact change by
/// where the geometry turns and moves, between free dofs. Of pairs the symmetric part of d(G'y)/dU;
/// before an obstacle -p dn/dx, p the pressing force of a node: 0 where that is flat.
class Stiffened {
 public:
  Stiffened(const Triplets& A, Matrix of_pairs, Matrix of_obstacles);
  Triplets plain() const { return view(view_.size); }
  Triplets less() const { return view(a_.size()); }
  /// b of A u = b at u = U, for A - S.
  Vector load(const Vector& b, const Vector& U) const {
    return b - of_pairs_ * U - of_obstacles_ * U;
  }
  /// S v of pairs alone: before an obstacle nothing is added in passes.
  Vector force_of_pairs(const Vector& v) const { return of_pairs_ * v; }

 private:
  Triplets view(std::size_t size) const;

  Triplets view_;
  std::vector<Index> i_, j_;
  std::vector<Real> a_;
  Matrix of_pairs_, of_obstacles_;
};

/// The obstacles of a scene that move, each of a label, or one of all labels.
struct MovingObstacles {
  std::vector<long> labels;  ///< empty: one obstacle
  std::vector<Vec3> pivot;   ///< of each
  RigidObstacles rigid;
};

/// The labels of the boundaries that touch: slave and master each other, those of the obstacle
/// that. Where there is no master all is before the obstacle.
struct Sides {
  std::vector<long> slave, master, obstacle;
};

/// One body or more with their contact nodes, as the script posed them, but for what is made of A.
struct Geometry {
  int d = 2;
  DofCount dofs;
  std::vector<BoundaryNode> nodes;    ///< contact points, one per normal of a node
  std::vector<BoundaryNode> on_mesh;  ///< those on an obstacle, with the mesh's own normals
  std::size_t beside_pairs = 0;       ///< the last of them: on an obstacle beside pairs of bodies
  std::vector<BoundaryNode> averted;  ///< left out: they face away from the normal given
  bool given_normals = false;         ///< by the script, in place of the mesh's
  bool given_weight = false;
  bool tangents = false;         ///< some nodes have tangential laws
  int unnamed_radius = -1;       ///< a component, where A looks axisymmetric without a weight
  Spaces spaces;                 ///< which the nodes are of
  std::vector<Index> mesh_node;  ///< of each dof
  /// Where the nodal values of a displacement are.
  std::function<std::vector<NodePlace>()> places;
  std::optional<Pairing> pairing;         ///< of two bodies; none where there is an obstacle alone
  mortar::Options facing;                 ///< of the two bodies, as the script has chosen them
  std::optional<MovingObstacles> moving;  ///< none where all obstacles stand still
  Sides sides;
  Displacement at;  ///< of the geometry (ndof)
  Vector force;     ///< of contact, that turns with it; or empty
  // Found when they are first asked for.
  /// Of its bodies, by the mesh.
  Real least_gyration() const {
    if (!gyration_) gyration_ = frictioncg::least_gyration(places(), d);
    return *gyration_;
  }
  /// Facet by facet.
  const std::vector<LabelledNode>& labelled() const {
    if (labelled_.empty())
      for (const SpacePtr& V : spaces) V->add_labelled(labelled_);
    return labelled_;
  }

 private:
  mutable std::optional<Real> gyration_;
  mutable std::vector<LabelledNode> labelled_;
};

/// A geometry with its system in local frames, and the solver that keeps the factorization.
/// Independent of the script's A and spaces once it is made. The laws are not part of it: they
/// belong to each call.
struct Scene : Geometry {
  std::unique_ptr<LocalSystem> system;
  std::unique_ptr<Solver> solver;
  /// Of the forces of contact that turn with the geometry; null where A is as it is.
  std::unique_ptr<Stiffened> stiffened;
  double copy_seconds = 0;
  /// Space's, of the dofs held; found when it is first asked for.
  const Vector& unit_load() const {
    if (unit_load_.size() > 0) return unit_load_;
    unit_load_ = Vector::Zero(ndof());
    for (const SpacePtr& V : spaces) V->add_unit_load(system->dirichlet(), unit_load_);
    return unit_load_;
  }
  long ndof() const { return dofs.count; }
  bool holds(Index dof) const { return system->dirichlet().holds(dof); }
  const BoundaryNode& contact_point(Index k) const { return nodes[system->node(k).point]; }
  /// Of the contact points, those of pairs come first.
  std::size_t paired() const { return pairing ? nodes.size() - beside_pairs : 0; }
  /// Whether contact node k touches an obstacle, not another body.
  bool on_obstacle(Index k) const { return system->node(k).point >= static_cast<Index>(paired()); }
  /// Whether contact node k is the first at its node of the mesh: a corner has several.
  bool starts_node(Index k) const {
    return k == 0 || contact_point(k).point.dof[0] != contact_point(k - 1).point.dof[0];
  }
  /// Copies A into the local frames; the nodes carry their normals and whether they have friction.
  /// before: a scene of which all that still holds is kept, or null. alone: nobody else has that,
  /// and its solver goes over.
  void assemble(const Triplets& A, Scene* before = nullptr, bool alone = false);
  /// Where friction counts slip from, in local dofs: uold, or empty.
  Vector slip_from(const Vector& u_old) const;
  /// The load of a call, and its laws, in local dofs.
  LocalIncrement increment(const LocalLoad& load, const PointLaws& laws) const;

 private:
  mutable Vector unit_load_;
  /// make(), whose refusals of a contact point get the place of its node.
  template <class Make>
  auto placed(const Make& make) const {
    try {
      return make();
    } catch (const ConflictingObstacles& e) {
      throw ConflictingObstacles(e.point, place(nodes[e.point], d), e.why);
    }
  }
};

/// S of the scene's force, where it has one that turns; or null.
std::unique_ptr<Stiffened> stiffened_by_force(const Triplets& A, const Scene& scene);

/// What bodies and obstacles may do that A does not resist, body by body, for the points of each
/// process on obstacles: motions that their normals let slip, as far as the mesh can tell, they let
/// slip to rounding. places, extent: of the bodies' nodes.   Collective.
void follow_free_motions(const Triplets& A, const std::vector<NodePlace>& places,
                         const Extent& extent, Scene& scene, const Processes& all = Processes());

/// Whether the mesh tells the normals of a curved obstacle.
inline bool has_curved_obstacle(const Scene& scene) {
  return !scene.given_normals && any_curved(scene.nodes);
}

/// Slips::told of the points on obstacles, or what is told of pairs, whichever is more.
/// system: sums over the processes.
Real told_by_mesh(const Scene& scene, Real of_pairs, const System& system);

DofCount dofs_of(const Spaces& spaces);

/// Bodies where the spaces have them, with contact points on obstacles.
std::shared_ptr<Scene> scene_on(const Spaces& spaces, std::vector<BoundaryNode> points);
void check_stage(const Stage& stage, const DofCount& dofs);

/// The geometry of these sides where the stage says, in one process.
std::shared_ptr<Scene> scene_at(const Stage& stage, const Spaces& any_stage, const Sides& sides);

}  // namespace frictioncg
