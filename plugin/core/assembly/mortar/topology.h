#pragma once
#include "assembly/mortar/surface.h"
#include "assembly/smooth_normals.h"
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
  std::array<Vec3, 2> normal;   ///< of the facets, by which the cosine is
  bool goes_on = false;         ///< the surface, over the ridge; else that is an edge of the body
};

/// The ends of ridge k of a facet, from its vertex k on, the lower one first; 2D: the same twice.
std::array<Index, 2> ridge_of(int d, const Facet& facet, int k);

/// Of the facets of a surface whose nodes have gone from X, which their outward vectors are of, to
/// Y: outside stays outside.
std::vector<Plane> planes_at(int d, const Surface& surface, const std::vector<Vec3>& X,
                             const std::vector<Vec3>& Y);

/// A surface with what is derived from it.
struct Side {
  /// reference: where the nodes are when the angles between facets tell the edges of the body from
  /// what is smooth; empty: X.
  Side(int dimension, const Surface& surface_, const std::vector<Vec3>& X,
       const std::vector<Vec3>& reference = {});
  int d;
  bool is_moved = false;  ///< from the reference
  const Surface& surface;
  std::vector<Plane> planes;  ///< one per facet
  std::vector<Joint> joints;  ///< sorted by their ridges
  /// With the planes where its nodes go from X to the reference.
  Side at_rest(const std::vector<Vec3>& X, const std::vector<Vec3>& reference) const;
  Index facets() const { return static_cast<Index>(planes.size()); }
  const Facet& facet(Index f) const { return surface.facets[f]; }

 private:
  void find_joints(const std::vector<Plane>& at);
};

/// Whether the facets of joint k have common normals at it. smooth: of each joint, or empty: where
/// the surface goes on.
inline bool is_smooth(const Side& side, std::size_t k, const std::vector<char>& smooth) {
  return smooth.empty() ? side.joints[k].goes_on : smooth[k] != 0;
}

/// The normals of the smooth surface, or of several, that the facets of a side stand for.
class SmoothSide {
 public:
  /// smooth: as in is_smooth.
  SmoothSide(const Side& side, const std::vector<Vec3>& X, const std::vector<char>& smooth = {});

  const FanNormal& at(Index facet, int vertex) const { return normal_[fan_at_[facet][vertex]]; }
  /// A number of the surface at a vertex of a facet: facets around a vertex have the same one.
  Index fan(Index facet, int vertex) const { return fan_at_[facet][vertex]; }
  /// The node that a surface of this number is at, and its facets there.
  Index node(Index fan) const { return node_[fan]; }
  const std::vector<Index>& facets(Index fan) const { return facets_[fan]; }
  const Vec3& normal(Index fan) const { return normal_[fan].normal; }

 private:
  std::vector<std::array<Index, 3>> fan_at_;
  std::vector<FanNormal> normal_;
  std::vector<Index> node_;
  std::vector<std::vector<Index>> facets_;
};

/// How many groups of elements around a node hang together by their facets: two where meshes were
/// merged, one at the tip of a crack. elements: the vertices of each simplex around it.
Index facet_connected_groups(int d, const std::vector<std::array<Index, 4>>& elements);

}  // namespace frictioncg::mortar
