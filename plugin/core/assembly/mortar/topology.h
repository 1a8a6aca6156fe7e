#pragma once
#include "assembly/mortar/surface.h"
#include "model/system.h"

namespace frictioncg::mortar {

/// Cosine of 45 degrees and a little: ridges sharper than that are edges of the body.
constexpr Real sharp = 0.7;
/// Cosine of 10 degrees: labels that meet flatter are one surface, others where they split an arc.
constexpr Real one_surface = 0.985;

/// Two facets that share a ridge: an edge, in 2D a vertex.
struct Joint {
  std::array<Index, 2> facet;
  std::array<Index, 2> vertex;  ///< ridge_of
  Real cosine;                  ///< of the angle between the normals; -1 where more facets meet
  bool goes_on = false;         ///< the surface, over the ridge; else that is an edge of the body
};

/// The ends of ridge k of a facet, from its vertex k on, the lower one first; 2D: the same twice.
std::array<Index, 2> ridge_of(int d, const Facet& facet, int k);

/// Of the facets of a surface whose nodes have gone from X to Y: outside stays outside.
/// planes: those of X
std::vector<Plane> planes_at(int d, const Surface& surface, const std::vector<Plane>& planes,
                             const std::vector<Vec3>& X, const std::vector<Vec3>& Y);

/// A surface with what is derived from it.
struct Side {
  /// reference: where the nodes are when the angles between facets tell the edges of the body from
  /// what is smooth; empty: X.
  Side(int dimension, const Surface& surface_, const std::vector<Vec3>& X,
       const std::vector<Vec3>& reference = {});
  /// The same surface with its nodes at Y in place of X: outside stays outside.
  Side(const Side& side, const std::vector<Vec3>& X, const std::vector<Vec3>& Y);
  int d;
  bool is_moved = false;  ///< from the reference
  const Surface& surface;
  std::vector<Plane> planes;  ///< one per facet
  std::vector<Joint> joints;  ///< sorted by their ridges
  Index facets() const { return static_cast<Index>(planes.size()); }
  const Facet& facet(Index f) const { return surface.facets[f]; }

 private:
  void find_joints(const std::vector<Plane>& at);
};

/// How many groups of elements around a node hang together by their facets: two where meshes were
/// merged, one at the tip of a crack. elements: the vertices of each simplex around it.
Index facet_connected_groups(int d, const std::vector<std::array<Index, 4>>& elements);

}  // namespace frictioncg::mortar
