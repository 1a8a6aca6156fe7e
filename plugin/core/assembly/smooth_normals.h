#pragma once
#include <Eigen/Geometry>

#include "types.h"

namespace frictioncg {

/// The smooth surface near the origin, in axes s1, s2, n:
///   z = (c x^2 + 2 d x y + f y^2 + k z^2)/2,   k = (k1|k1| + k2|k2|)/(|k1| + |k2|),
/// k1, k2 the principal curvatures: circles, spheres and cylinders are among them.
struct Quadric {
  Vec3 normal = Vec3::Zero();  ///< unit, at the origin
  Eigen::Matrix3d curvature =
      Eigen::Matrix3d::Zero();  ///< c s1 s1' + d (s1 s2' + s2 s1') + f s2 s2'
  Real k = 0;

  /// The unit normal at a point of the surface.
  Vec3 normal_at(const Vec3& x) const {
    return (normal - curvature * x - k * normal.dot(x) * normal).normalized();
  }
};

/// A normal further from the mean one than 45 degrees (their cosine) is no normal of a surface.
constexpr Real leaning = M_SQRT1_2;

/// What is known of a surface beside its vertices.
struct Told {
  bool moves = false;
  bool strip = false;  ///< of one layer of facets: across it they are straight
};

/// The quadric through the origin that fits the vertices around it best. Its normal is exact on
/// circles, spheres and cylinders, whatever the facets, and of second order in their size on other
/// smooth surfaces; a mean of the facets' normals is of first order, a wedge at each vertex.
///
/// Where the vertices leave the quadric open (one layer of facets), it is curved no more than it
/// has to be, or, where two lines of vertices tell all curvature but one, as little as a surface
/// that develops: exact on cones. Of one that moves the curvature is the least that they tell
/// clearly. Nothing is returned where no quadric fits within 45 degrees of `mean`.
std::optional<Quadric> osculating_quadric(int d, const std::vector<Vec3>& around, const Vec3& mean,
                                          Told told = {});

/// Whether unit vectors are one but for rounding.
bool same_direction(const Vec3& m, const Vec3& n);

/// The facets at a vertex that count as one smooth surface there: one fan, or on a ridge several.
struct Fan {
  Index vertex = 0;
  std::vector<Index> facets;
  Vec3 mean = Vec3::Zero();  ///< of their normals, unit; 0 where they cancel
};

/// A boundary of flat facets: segments in 2D, triangles in 3D.
struct Faceted {
  struct Facet {
    std::array<Index, 3> vertex{{-1, -1, -1}};
    Vec3 normal = Vec3::Zero();  ///< unit, outward
  };
  int d = 2;
  std::vector<Vec3> X;  ///< 2D: third component 0
  std::vector<Facet> facets;
  /// Of a body that has deformed: what its curvature does is no jump of two faces, and each normal
  /// is that of its own vertices. Weights of sides, which turn over within a few hundredths of a
  /// jump, would let gaps change several times as fast as the bodies move. What the vertices leave
  /// of a curvature open, or not, would jump, and so would what is to develop.
  bool is_moved = false;
  std::vector<Fan> fans;  ///< each facet is in one fan at each of its vertices, or in none
};

struct FanNormal {
  Vec3 normal = Vec3::Zero();  ///< unit; 0 where the mean is
  Real turn = 0;  ///< largest angle to the facets of the fan; exactly 0 where the surface is flat
};

/// The normal of each fan: that of the smooth surface through the vertices around it. Stencils do
/// not leave what the fans say to be smooth. Where the surface is flat it is the mean, bit by bit.
/// Where the curvature jumps (a flat face meets a fillet) it is that of a side, whose curvature
/// does not: exact if a vertex lies on the joint. A lone kink has the bisector of its sides.
std::vector<FanNormal> smooth_normals(const Faceted& surface);

/// The normal in the middle of edge ab, if the edge is the chord of an arc between the normals of
/// its ends. Where both ends have the normal `mean`, so has the middle.
Vec3 arc_normal(const Vec3& n_a, const Vec3& n_b, const Vec3& edge, const Vec3& mean);

}  // namespace frictioncg
