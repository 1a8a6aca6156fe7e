#include "assembly/smooth_normals.h"

namespace frictioncg {

namespace {

/// A jump of the curvature begins to count from the first share of the curvature on, and counts in
/// full from the second. Vertices that lie off an arc by a hundredth of its sagitta, as buildmesh
/// moves them, make jumps of a tenth.
constexpr Real jump = 0.3, clear_jump = 0.35;
/// A jump begins to count less where a side's own curvature changes by the first share of it, and
/// is none from the second on: at a joint of flat faces and arcs such changes are rounding, on a
/// coarse ellipse they are 0.1 of the jump and more.
constexpr Real smooth = 0.02, rough = 0.06;
/// Two sides change alike where their changes differ by less than this share of the jump. Sides of
/// one curvature differ by 1e-10 of it.
constexpr Real alike = 1e-5;

/// From 0 at `from` to 1 at `to`.
Real ramp(Real x, Real from, Real to) { return std::clamp<Real>((x - from) / (to - from), 0, 1); }

class Estimator {
 public:
  explicit Estimator(const Faceted& surface)
      : s_(surface), fan_at_(surface.facets.size(), {-1, -1, -1}) {
    for (std::size_t p = 0; p < s_.fans.size(); ++p)
      for (Index f : s_.fans[p].facets)
        for (int v = 0; v < s_.d; ++v)
          if (s_.facets[f].vertex[v] == s_.fans[p].vertex) fan_at_[f][v] = static_cast<Index>(p);
    for (std::size_t p = 0; p < s_.fans.size(); ++p) {
      next_.push_back(neighbours(s_.fans[p]));
      rim_.push_back(at_rim(s_.fans[p]));
      plane_.push_back(is_plane(s_.fans[p], s_.fans[p].mean));
    }
    for (std::size_t p = 0; p < s_.fans.size(); ++p) flat_.push_back(is_flat(p));
    for (std::size_t p = 0; p < s_.fans.size(); ++p) quadric_.push_back(fit(p));
  }
  FanNormal operator()(std::size_t p) const {
    FanNormal found;
    const Vec3& mean = s_.fans[p].mean;
    found.normal = flat_[p] ? mean : across_generatrix(p, with_sides(p));
    for (std::size_t k = 0; k < s_.fans[p].facets.size() && !flat_[p]; ++k) {
      const Vec3& n = s_.facets[s_.fans[p].facets[k]].normal;
      found.turn =
          std::max(found.turn, std::atan2(n.cross(found.normal).norm(), n.dot(found.normal)));
    }
    return found;
  }

 private:
  const Vec3& at(Index fan) const { return s_.X[s_.fans[fan].vertex]; }

  /// The fans at the other vertices of its facets, of which a facet is in the fan.
  std::vector<Index> neighbours(const Fan& fan) const {
    std::vector<Index> next;
    for (Index f : fan.facets)
      for (int v = 0; v < s_.d; ++v)
        if (s_.facets[f].vertex[v] != fan.vertex && fan_at_[f][v] >= 0)
          next.push_back(fan_at_[f][v]);
    sort_once(next);
    return next;
  }
  /// Ridges of a fan with one facet of it.
  bool at_rim(const Fan& fan) const {
    if (s_.d == 2) return fan.facets.size() < 2;
    std::vector<Index> ends;
    for (Index f : fan.facets)
      for (Index i : s_.facets[f].vertex)
        if (i != fan.vertex) ends.push_back(i);
    return std::any_of(ends.begin(), ends.end(),
                       [&](Index i) { return std::count(ends.begin(), ends.end(), i) == 1; });
  }
  bool is_plane(const Fan& fan, const Vec3& n) const {
    return std::all_of(fan.facets.begin(), fan.facets.end(),
                       [&](Index f) { return same_direction(s_.facets[f].normal, n); });
  }
  /// Inside of a surface the facets there decide. At a rim those of a strip on a cylinder are
  /// parallel, too; it is flat if a vertex inside of the plane says so, or all facets around it do.
  bool is_flat(std::size_t p) const {
    const Vec3& n = s_.fans[p].mean;
    if (!plane_[p]) return n.squaredNorm() == 0;
    if (!rim_[p]) return true;
    bool all = true;
    for (Index q : next_[p]) {
      const bool same = plane_[q] && same_direction(s_.fans[q].mean, n);
      if (same && !rim_[q]) return true;
      all = all && is_plane(s_.fans[q], n);
    }
    return all;
  }
  /// Fits a quadric to the vertices of the fan's facets and of the next ones. A vertex with few
  /// facets would leave it nearly open in 3D; in 2D only the ends do.
  std::optional<Quadric> fit(std::size_t p) const {
    const Vec3& mean = s_.fans[p].mean;
    if (mean.squaredNorm() == 0) return {};
    Quadric plane;
    plane.normal = mean;
    if (flat_[p]) return plane;
    const Index i = s_.fans[p].vertex;
    const bool wide = s_.d == 3 || rim_[p];
    std::vector<Index> vertices;
    for (Index q : next_[p]) {
      vertices.push_back(s_.fans[q].vertex);
      for (Index r : next_[q])
        if (wide && s_.fans[r].vertex != i) vertices.push_back(s_.fans[r].vertex);
    }
    sort_once(vertices);
    std::vector<Vec3> around;
    for (Index j : vertices) around.push_back(s_.X[j] - s_.X[i]);
    return osculating_quadric(s_.d, around, mean, {s_.is_moved, is_strip(p)});
  }

  /// Whether all vertices that tell of its curvature lie at rims, as those of one layer do.
  bool is_strip(std::size_t p) const {
    const auto at_rims = [&](Index q) {
      return rim_[q] &&
             std::all_of(next_[q].begin(), next_[q].end(), [&](Index r) { return rim_[r]; });
    };
    return rim_[p] && std::all_of(next_[p].begin(), next_[p].end(), at_rims);
  }
  /// How much the curvatures at p and q differ, once the normal of q is turned to that of p.
  Real difference(Index p, Index q) const {
    const Quadric &a = *quadric_[p], &b = *quadric_[q];
    if (a.normal == b.normal) return (a.curvature - b.curvature).norm();
    const Vec3 axis = b.normal.cross(a.normal);
    const Eigen::Matrix3d turn =
        Eigen::Quaterniond(1 + b.normal.dot(a.normal), axis.x(), axis.y(), axis.z())
            .normalized()
            .toRotationMatrix();
    return (a.curvature - turn * b.curvature * turn.transpose()).norm();
  }
  /// The largest jump of curvature at a fan, and how much it counts: 0 where it is none.
  std::pair<Real, Real> jump_at(std::size_t p) const {
    std::vector<Index> here = next_[p];
    here.push_back(static_cast<Index>(p));
    Real most = 0, curvature = 0;
    for (std::size_t k = 0; k < here.size(); ++k) {
      if (!quadric_[here[k]]) continue;
      curvature = std::max(curvature, quadric_[here[k]]->curvature.norm());
      for (std::size_t l = 0; l < k; ++l)
        if (quadric_[here[l]]) most = std::max(most, difference(here[k], here[l]));
    }
    return {most, most > 0 ? ramp(most / curvature, jump, clear_jump) : 0};
  }
  /// By how much the curvature at q, seen from p, changes beyond it: the median of the vertices
  /// there, of which some may lie at the joint again. Infinite where there are none.
  Real change_beyond(std::size_t p, Index q) const {
    std::vector<Real> changes;
    for (Index r : next_[q]) {
      const auto& near = next_[p];
      if (r == static_cast<Index>(p) || std::binary_search(near.begin(), near.end(), r)) continue;
      if (s_.d == 2 && rim_[r] && !flat_[r])
        continue;  // at a free end the circle is its neighbour's
      changes.push_back(quadric_[q] && quadric_[r] ? difference(q, r) : infinity);
    }
    if (changes.empty()) return infinity;
    const auto middle = changes.begin() + static_cast<long>(changes.size() / 2);
    std::nth_element(changes.begin(), middle, changes.end());
    return *middle;
  }
  /// The normal of its own quadric, but next to a jump of curvature that of its sides, the
  /// smoothest first: a mean with weights (change^2 + (alike jump)^2)^-2. All of it is continuous
  /// in the vertices: surfaces that move have normals that do.
  Vec3 with_sides(std::size_t p) const {
    const Vec3 own = quadric_[p] ? quadric_[p]->normal : s_.fans[p].mean;
    if (s_.is_moved) return own;
    const auto [most, counts] = jump_at(p);
    if (counts == 0) return own;
    Real least = infinity, sum = 0;
    Vec3 sides = Vec3::Zero();
    for (Index q : next_[p]) {
      const Real change = change_beyond(p, q) / most;
      if (!(change < rough)) continue;
      least = std::min(least, change);
      const Real weight =
          ramp(change, rough, smooth) * std::pow(change * change + alike * alike, -2);
      sum += weight;
      sides += weight * quadric_[q]->normal_at(at(static_cast<Index>(p)) - at(q));
    }
    if (!(sum > 0)) return own;
    return (own + counts * ramp(least, rough, smooth) * (sides / sum - own)).normalized();
  }

  /// A normal at right angles to the direction that all facets around have in common: of a profile
  /// that is pulled along it they tell that exactly, the vertices of a quadric but for its errors.
  Vec3 across_generatrix(std::size_t p, const Vec3& n) const {
    constexpr Real common = 1e-9, rounding = 1e-15;
    if (s_.d == 2 || s_.is_moved) return n;
    const Vec3& first = s_.facets[s_.fans[p].facets.front()].normal;
    Vec3 along = Vec3::Zero();
    const auto for_each_facet = [&](const auto& visit) {
      for (Index f : s_.fans[p].facets) visit(s_.facets[f].normal);
      for (Index q : next_[p])
        for (Index f : s_.fans[q].facets) visit(s_.facets[f].normal);
    };
    for_each_facet([&](const Vec3& m) {
      const Vec3 edge = first.cross(m);
      if (edge.squaredNorm() > along.squaredNorm()) along = edge;
    });
    const Real turn = along.norm();
    if (!(turn > 0)) return n;
    along /= turn;
    Real most = 0;
    for_each_facet([&](const Vec3& m) { most = std::max(most, std::abs(along.dot(m))); });
    return most > common * turn + rounding / turn ? n : (n - n.dot(along) * along).normalized();
  }

  const Faceted& s_;
  std::vector<std::array<Index, 3>> fan_at_;  ///< of each facet, at its vertices
  std::vector<std::vector<Index>> next_;      ///< of each fan, as numbers of fans
  std::vector<char> rim_, plane_, flat_;
  std::vector<std::optional<Quadric>> quadric_;
};

}  // namespace

bool same_direction(const Vec3& m, const Vec3& n) {
  constexpr Real parallel = 1 - 1e-14;  // rounding makes the rest
  return m.dot(n) > parallel;
}

std::vector<FanNormal> smooth_normals(const Faceted& surface) {
  const Estimator estimate(surface);
  std::vector<FanNormal> normals;
  for (std::size_t p = 0; p < surface.fans.size(); ++p) normals.push_back(estimate(p));
  return normals;
}

Vec3 arc_normal(const Vec3& n_a, const Vec3& n_b, const Vec3& edge, const Vec3& mean) {
  if (same_direction(n_a, mean) && same_direction(n_b, mean)) return mean;
  const Vec3 sum = n_a + n_b, n = sum - sum.dot(edge) / edge.squaredNorm() * edge;
  return n.dot(mean) > leaning * n.norm() ? n.normalized() : mean;
}

}  // namespace frictioncg
