#pragma once
#include "assembly/basis.h"
#include <Eigen/Geometry>

#include "assembly/dirichlet.h"

namespace frictioncg {

/// A further obstacle of a contact node: what Dirichlet conditions leave free of the node's own
/// normal is factor times what they leave of this one's.
struct Rival {
  Index point = 0;  ///< contact point
  Real factor = 1;  ///< > 0
};

/// A contact node as the laws see it: one normal, and the tangents where it has friction.
struct ContactNode {
  Index point = 0;      ///< contact point
  bool shared = false;  ///< its mesh node has several normals: it slides without friction
  std::vector<Rival> rivals = {};  ///< the nearest of all its obstacles counts
};

/// What is wrong with the obstacles at a node.
constexpr const char* dependent_normals =
    " have linearly dependent normals on what is free to move there; give one normal for all of "
    "them, or labels that leave one of these faces out; facets of one curved face meet by less "
    "than 30 degrees";
constexpr const char* different_gaps =
    " are at different gaps along the one direction that is free to move there, and bilateral "
    "contact can follow one alone; give one gap, or labels that leave one of these faces out";

/// The obstacles at one mesh node ask for what its free directions cannot give.
struct ConflictingObstacles : IllegalInput {
  ConflictingObstacles(Index point_, const std::string& where, const char* why_)
      : IllegalInput("the obstacles at " + where + why_), point(point_), why(why_) {}
  Index point;      ///< contact point: the last of the mesh node
  const char* why;  ///< dependent_normals, different_gaps, or of obstacles that move
};

/// Local frames at the contact points.
///
/// One normal: w_N = n.u, and tangents, orthonormal among the free components and orthogonal to
/// what Dirichlet conditions leave free of the normal: the body gives way along its projection, and
/// r_N is the force along the whole of n. A point whose normal is held is no contact node.
/// Orthotropic friction turns the tangents to its principal directions and scales them.
///
/// Several normals at one node (a corner): w_j = n_j.u for each, and the rest of an orthonormal
/// basis of what is orthogonal to them all: rows of W are the normals, columns of T their dual
/// basis. Where Dirichlet conditions leave two of them parallel (the tip of a groove held along it)
/// they are rivals for one direction. Throws ConflictingObstacles where they depend on each
/// other otherwise.
class Frames {
 public:
  /// n dofs in all.
  Frames(int dimension, Index n, const std::vector<ContactPoint>& points,
         const Dirichlet& dirichlet);

  std::shared_ptr<const Basis> basis() const { return shared_; }
  const std::vector<ContactNode>& nodes() const { return nodes_; }

 private:
  using Square = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
  /// The frame of a mesh node: rows of to_local are the directions, w = to_local u over its
  /// components; the columns of from_local their dual basis, zero on held components.
  struct Frame {
    std::array<Index, 3> dof{};
    Square to_local, from_local;
    std::vector<ContactNode> nodes;  ///< of its normals, the first directions
    int free = 0;                    ///< directions in all
    bool friction = false;           ///< one normal, and a tangential law
    std::vector<Index> local;        ///< local dof of each direction
  };

  std::vector<std::vector<Index>> points_by_node(Index n) const;
  void add_frame(const std::vector<Index>& points);
  bool add_normal(Frame& frame, Index point) const;
  bool add_rival(Frame& frame, Index point, const Vec3& free) const;
  Vec3 free_part(const ContactPoint& point) const;
  void complete(Frame& frame) const;
  Square on_free_components(const Frame& frame) const;
  void orient(Frame& frame) const;
  void dualize(Frame& frame) const;
  void number(Index n);
  void fill(Index n);

  const int d_;
  const std::vector<ContactPoint>& points_;
  const Dirichlet& dirichlet_;
  std::vector<Frame> frames_;
  std::vector<ContactNode> nodes_;
  Index unframed_ = 0;  ///< local dofs that are dofs of the script
  std::shared_ptr<Basis> shared_ = std::make_shared<Basis>();
  Basis& basis_ = *shared_;
};

}  // namespace frictioncg
