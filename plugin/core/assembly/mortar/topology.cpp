#include "assembly/mortar/topology.h"

namespace frictioncg::mortar {

std::array<Index, 2> ridge_of(int d, const Facet& facet, int k) {
  const Index a = facet.node[k], b = d == 2 ? a : facet.node[(k + 1) % 3];
  return {std::min(a, b), std::max(a, b)};
}

namespace {

/// A surface goes on over a joint of 30 degrees and a little (their cosine): 12 edges are the
/// coarsest circle that counts as one.
constexpr Real arc_step = 0.86;

/// Finds the least cosine of the joints at each vertex; edges of the body do not count.
std::map<Index, Real> bends_of(const Side& side) {
  std::map<Index, Real> bends;
  for (const Joint& joint : side.joints)
    for (Index i : joint.vertex)
      if (joint.cosine >= arc_step) {
        Real& bend = bends.emplace(i, joint.cosine).first->second;
        bend = std::min(bend, joint.cosine);
      }
  return bends;
}

/// Whether the surface turns half as much beyond both facets of a joint: labels split an arc there.
bool on_an_arc(const Side& side, const Joint& joint, const std::map<Index, Real>& bends) {
  const Real half = std::sqrt((1 + joint.cosine) / 2);
  return std::all_of(joint.facet.begin(), joint.facet.end(), [&](Index f) {
    const auto begin = side.facet(f).node.begin();
    const Index beyond = *std::find_if(begin, begin + side.d, [&](Index i) {
      return i != joint.vertex[0] && i != joint.vertex[1];
    });
    const auto bend = bends.find(beyond);
    return bend != bends.end() && bend->second <= half;
  });
}

}  // namespace

std::vector<Plane> planes_at(int d, const Surface& surface, const std::vector<Vec3>& X,
                             const std::vector<Vec3>& Y) {
  std::vector<Plane> there;
  for (Facet turning : surface.facets) {
    const Vec3 outward = std::exchange(turning.outward, Vec3::Zero());
    const bool flipped = plane_of(d, turning, X).normal.dot(outward) < 0;
    there.push_back(plane_of(d, turning, Y));
    if (flipped) there.back().normal *= -1;
  }
  return there;
}

Side::Side(int dimension, const Surface& surface_, const std::vector<Vec3>& X,
           const std::vector<Vec3>& reference)
    : d(dimension), is_moved(!reference.empty()), surface(surface_) {
  planes.reserve(surface.facets.size());
  for (const Facet& f : surface.facets) planes.push_back(plane_of(d, f, X));
  find_joints(reference.empty() ? planes : planes_at(d, surface, X, reference));
}

Side Side::at_rest(const std::vector<Vec3>& X, const std::vector<Vec3>& reference) const {
  Side rest = *this;
  rest.planes = planes_at(d, surface, X, reference);
  rest.is_moved = false;
  return rest;
}

void Side::find_joints(const std::vector<Plane>& at) {
  std::vector<std::pair<std::array<Index, 2>, Index>> ridges;  // and a facet of each
  for (Index f = 0; f < facets(); ++f)
    for (int k = 0; k < d; ++k) ridges.emplace_back(ridge_of(d, facet(f), k), f);
  std::sort(ridges.begin(), ridges.end());
  for (std::size_t k = 0, next; k < ridges.size(); k = next) {
    const std::array<Index, 2>& vertex = ridges[k].first;
    for (next = k + 1; next < ridges.size() && ridges[next].first == vertex;) ++next;
    for (std::size_t q = k + 1; q < next; ++q) {
      const Index f = ridges[q - 1].second, g = ridges[q].second;
      const Real cosine = next == k + 2 ? at[f].normal.dot(at[g].normal) : -1;
      joints.push_back({{f, g}, vertex, cosine, {at[f].normal, at[g].normal}});
    }
  }
  std::map<Index, Real> bends;  // once some joint asks for them
  for (Joint& joint : joints) {
    const bool one_label = facet(joint.facet[0]).label == facet(joint.facet[1]).label;
    joint.goes_on = joint.cosine >= (one_label ? sharp : one_surface);
    if (joint.goes_on || joint.cosine < arc_step) continue;
    if (bends.empty()) bends = bends_of(*this);
    joint.goes_on = on_an_arc(*this, joint, bends);
  }
}

/// A fan: corners of facets at a vertex, joined over the ridges between them.
SmoothSide::SmoothSide(const Side& side, const std::vector<Vec3>& X,
                       const std::vector<char>& smooth)
    : fan_at_(side.facets(), {-1, -1, -1}) {
  const int d = side.d;
  Groups corners(d * side.facets());
  for (std::size_t k = 0; k < side.joints.size(); ++k) {
    const auto [f, g] = side.joints[k].facet;
    for (Index i : side.joints[k].vertex)
      if (is_smooth(side, k, smooth))
        corners.join(d * f + position(side.facet(f), i), d * g + position(side.facet(g), i));
  }
  Faceted surface;
  surface.d = d;
  surface.is_moved = side.is_moved;
  std::map<Index, Index> number, fan_of_root;  // number: of the vertices of the side alone
  for (Index f = 0; f < side.facets(); ++f) {
    Faceted::Facet& facet = surface.facets.emplace_back();
    facet.normal = side.planes[f].normal;
    for (int v = 0; v < d; ++v) {
      const Index i = side.facet(f).node[v], next = static_cast<Index>(surface.X.size());
      facet.vertex[v] = number.emplace(i, next).first->second;
      if (facet.vertex[v] == next) surface.X.push_back(X[i]);
      const auto [at, is_new] =
          fan_of_root.emplace(corners.of(d * f + v), static_cast<Index>(surface.fans.size()));
      if (is_new) {
        surface.fans.emplace_back().vertex = facet.vertex[v];
        node_.push_back(i);
      }
      Fan& fan = surface.fans[at->second];
      fan.facets.push_back(f);
      fan.mean += side.planes[f].measure * side.planes[f].normal;
      fan_at_[f][v] = at->second;
    }
  }
  for (Fan& fan : surface.fans) fan.mean.normalize();
  normal_ = smooth_normals(surface);
  for (Fan& fan : surface.fans) facets_.push_back(std::move(fan.facets));
}

Index facet_connected_groups(int d, const std::vector<std::array<Index, 4>>& elements) {
  const Index n = static_cast<Index>(elements.size());
  Groups groups(n);
  for (Index p = 0; p < n; ++p)
    for (Index q = p + 1; q < n; ++q) {
      int shared = 0;
      for (int k = 0; k <= d; ++k)
        shared += static_cast<int>(
            std::count(elements[q].begin(), elements[q].begin() + d + 1, elements[p][k]));
      if (shared >= d) groups.join(p, q);
    }
  std::set<Index> roots;
  for (Index p = 0; p < n; ++p) roots.insert(groups.of(p));
  return static_cast<Index>(roots.size());
}

}  // namespace frictioncg::mortar
