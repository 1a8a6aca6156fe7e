#pragma once
#include "boundary.h"
#include "../core/statics/nearest_motion.h"

class E_F0;           // FreeFEM's
using Stack = void*;  // FreeFEM's

namespace frictioncg {

/// A displacement by the dofs of a call, or null.
using Displacement = std::shared_ptr<const Vector>;

/// The displacement at which the geometry of a call is, and that where its increment began, which
/// decides what is chosen; null: the same.
struct Stage {
  Displacement at, begun;
  const char* name = "at";  ///< of the argument that `at` is
};

/// What a label inside a body is told.
constexpr const char* obstacle_inside = "an obstacle touches the outer boundary only";

/// A finite-element space of a mesh or a mesh3, and where its nodes are: on the mesh, or moved from
/// there by a displacement. Elements stay straight between their vertices, as those of a mesh that
/// movemesh moves. All dofs are those of the call, of two spaces those of the first before those of
/// the second, and so is what is added to that of spaces before this one.
class Space {
 public:
  virtual ~Space() = default;
  /// The same at another displacement.
  virtual std::shared_ptr<const Space> at(const Stage& stage) const = 0;
  virtual Index dofs() const = 0;      ///< how many it has
  virtual Index vertices() const = 0;  ///< of the mesh
  virtual Index elements() const = 0;
  virtual std::array<Index, 4> element(Index k) const = 0;  ///< its vertices; in 2D the last is -1
  virtual std::set<long> labels() const = 0;                ///< that the mesh's boundary has
  /// The contact boundary of the labels. Throws IllegalInput where there is none, or the space is
  /// not one of those for which the laws are written.
  virtual Boundary boundary(const std::vector<long>& labels,
                            const char* inside = obstacle_inside) const = 0;
  virtual SharedNode node_at_vertex(Index element, int vertex) const = 0;
  /// How far it is from the middle of a facet through the mesh as given, along its normal, to where
  /// the body ends, or to beyond four times the facet's size; infinite where rounding hides it.
  virtual double thickness(Index element, int facet) const = 0;
  /// Which node of the mesh each dof belongs to.
  virtual void add_mesh_nodes(std::vector<Index>& node) const = 0;
  /// The nodes that carry values of every component of the displacement.
  virtual void add_places(std::vector<NodePlace>& places) const = 0;
  /// Facet by facet, by all its labels.
  virtual void add_labelled(std::vector<LabelledNode>& nodes) const = 0;
  /// What a load of 1 per content makes of each dof, up to a common factor: the integral of its
  /// function. of: which dofs are wanted.
  virtual void add_unit_load(const Dirichlet& of, Vector& load) const = 0;
  /// Makes a node the point at which expressions are evaluated: where it has been moved to, and in
  /// its element, by which functions on the mesh are read. Returns the place.
  virtual Vec3 go_to(Stack stack, const BoundaryNode& node) const = 0;
  bool is_moved() const { return stage.at != nullptr; }
  /// Where the increment began; null: here.
  const Space* begun() const;
  /// Which part of the mesh each element belongs to: parts share no vertex.
  std::vector<Index> body_of_element() const;
  std::string mesh_in_words() const;

  const int d;             ///< dimension
  const char* const name;  ///< Vh; of two spaces V1 or V2
  const Index offset;      ///< its first dof
  const Stage stage;

 protected:
  Space(int dimension, const char* word, Index first, const Stage& where)
      : d(dimension), name(word), offset(first), stage(where) {}

 private:
  mutable std::shared_ptr<const Space> begun_;  ///< once it is asked for
};
using SpacePtr = std::shared_ptr<const Space>;
using Spaces = std::vector<SpacePtr>;  ///< of a call: one, or two

/// The space that an expression of the script stands for, on its mesh: made anew where the mesh has
/// changed. offset: its first dof.
SpacePtr space_of(Stack stack, int d, E_F0* expression, const char* name, Index offset);

Spaces at(const Stage& stage, const Spaces& spaces);

/// The body of each of n dofs; -1 where it is none of these nodes.
std::vector<Index> body_of_dofs(const std::vector<NodePlace>& nodes, int d, Index n);

/// Those of some nodes.
std::vector<Index> body_of_nodes(const NodeDofs& some, const std::vector<NodePlace>& all, int d,
                                 Index n);

/// The vertex at a place of the reference simplex, or -1.
int corner_at(const Vec3& hat, int d);

/// Where expressions are evaluated is restored when what this returns goes, whatever happens until
/// then.
std::shared_ptr<const void> point_guard(Stack stack);

}  // namespace frictioncg
