#include "assembly/mortar/cover.h"

#include "assembly/mortar/search.h"
#include "assembly/mortar/self_contact.h"
#include "assembly/mortar/sheets.h"

namespace frictioncg::mortar {

namespace {

/// A cell of a smaller extent, in reference coordinates, is what rounding makes of a common edge.
constexpr Real vanishing = 1e-14;
/// Neighbours overlap by rounding up to this share of the smaller one; more than that, one of them
/// hides the other.
constexpr Real overlapping = 1e-11;
/// A point lies in a facet where no barycentric coordinate is below this: a point on the edge of
/// two facets is to lie in one of them at least.
constexpr Real inside_facet = -1e-9;
/// A facet of a surface that touches itself lies this near to itself, over its size: rounding.
constexpr Real on_itself = 1e-6;

/// Overlaps up to this share of a facet are looked at no further: no body is so thin.
constexpr Real thinnest = 1e-3;
/// What leans by more than 45 degrees, before less of a facet than this, is the tip of a corner:
/// its plane is far from the rest of the facet.
constexpr Real tip = 1e-3, leaning = -0.7;
/// Where more of a facet than this is behind a master, bodies overlap.
constexpr Real overlapped = 0.5;

/// A master facet before a slave facet.
struct Candidate {
  Index master;
  Projection projection;
  Polygon part;
  Real extent;
  Real distance;    ///< at the centroid [length]
  Real left, right; /* of the part, along xi_1 */
};

/// By so much a node has moved since, at most [length]
Real moved_since(const Earlier& earlier, const std::vector<Vec3>& X) {
  Real moved = 0;
  for (const Side* side : {&earlier.slave, &earlier.master})
    for (const Facet& facet : side->surface.facets)
      for (int v = 0; v < side->d; ++v)
        moved = std::max(moved, (X[facet.node[v]] - earlier.X[facet.node[v]]).norm());
  return moved;
}

class Covering {
 public:
  Covering(const Nodes& nodes, bool itself, const Side& slave, const Side& master, Real maxgap,
           const std::optional<Earlier>& earlier)
      : slave_(slave),
        master_(master),
        X_(nodes.X),
        maxgap_(maxgap),
        d_(slave.d),
        own_(slave, nodes, itself),
        earlier_(earlier),
        moved_(earlier ? moved_since(*earlier, X_) : 0),
        tree_(d_, master.surface.facets, master.planes, X_) {}

  Cover run() {
    Cover result;
    result.cells.resize(slave_.facets());
    result.fraction.assign(slave_.facets(), 0);
    const Real whole = extent(reference_facet(d_));
    bool faced = false;
    for (Index f = 0; f < slave_.facets(); ++f) {
      std::vector<Cell>& cells = result.cells[f];
      find(f, maxgap_);
      separate();
      for (std::size_t k = 0; k < candidates_.size(); ++k) cut_behind(k, nearer_[k], cells);
      Real deep = 0;
      const auto is_none = [&](const Cell& cell) { return is_no_partner(f, cell, deep); };
      cells.erase(std::remove_if(cells.begin(), cells.end(), is_none), cells.end());
      const auto distance = [&](const Cell& cell) {
        const std::optional<Begun> begun = before(f, cell.master);
        return (begun && begun->faced ? begun->projection : onto(cell.master, f)).distance;
      };
      keep_nearest_sheet(master_, slave_.planes[f].size, distance, cells);
      for (const Cell& cell : cells) result.fraction[f] += extent(cell.part) / whole;
      if (!earlier_ && result.fraction[f] <= tip && leans(f, cells)) {
        cells.clear();
        result.fraction[f] = 0;
      }
      faced = faced || !cells.empty();
    }
    result.visited = tree_.visited() + pairs_;
    if (!faced) result.nearest = nearest_facing();
    return result;
  }

 private:
  Projection onto(Index master, Index f) const {
    return project(d_, slave_.planes[f], master_.facet(master), X_);
  }
  /// Fills candidates_.
  void find(Index f, Real maxgap) {
    const Plane& base = slave_.planes[f];
    const Real reach = maxgap + 2 * moved_;
    tree_.find({base, -reach, reach, true}, found_);
    candidates_.clear();
    for (Index m : found_) {
      ++pairs_;
      Candidate c;
      c.master = m;
      c.projection = onto(m, f);
      if (!c.projection.inverts) continue;
      c.part = inside(d_, reference_facet(d_), c.projection);
      if (c.part.empty()) continue;
      c.extent = extent(c.part);
      if (c.extent <= vanishing) continue;
      const Vec2 middle = centroid(c.part);
      c.distance = c.projection.distance(middle);
      const std::optional<Begun> begun = before(f, m);
      const Real apart =
          begun && begun->faced ? begun->projection.distance(centroid(begun->part)) : c.distance;
      if (std::abs(apart) > maxgap) continue;
      const Real deepest = std::max(base.size, master_.planes[m].size);
      if (earlier_ && c.distance < -deepest && !begun) continue;  // it has come past its end
      if (own_.excludes(slave_, f, master_.facet(m), middle, c.distance, deepest)) continue;
      if (apart < -thinnest * deepest && looks_better_beyond_edge(f, m)) continue;
      c.left = infinity, c.right = -infinity;
      for (const Vec2& xi : c.part)
        c.left = std::min(c.left, xi[0]), c.right = std::max(c.right, xi[0]);
      candidates_.push_back(std::move(c));
    }
  }
  /// A corner that overlaps a face does so with both of its sides: it is before the one that looks
  /// at the face, not before one that hardly does and would be pushed along it.
  bool looks_better_beyond_edge(Index f, Index m) {
    const Side& slave = earlier_ ? earlier_->slave : slave_;
    const Vec3& normal = (earlier_ ? earlier_->master : master_).planes[m].normal;
    const Real own = normal.dot(slave.planes[f].normal);
    const auto does = [&](Index g) {
      return normal.dot(slave.planes[g].normal) < leaning &&
             slave.planes[f].normal.dot(slave.planes[g].normal) < sharp;
    };
    const auto at_vertex = [&](Index i) {
      const std::vector<Index>& facets = facets_at(i);
      return std::any_of(facets.begin(), facets.end(), does);
    };
    const auto& node = slave_.facet(f).node;
    return own > hardly && std::any_of(node.begin(), node.begin() + d_, at_vertex);
  }
  /// Of the slave, at a node; found when a corner first overlaps.
  const std::vector<Index>& facets_at(Index i) {
    if (facets_at_.empty())
      for (Index f = 0; f < slave_.facets(); ++f)
        for (int v = 0; v < d_; ++v) facets_at_[slave_.facet(f).node[v]].push_back(f);
    return facets_at_.at(i);
  }
  /// A master's facet, where it was decided what faces what.
  struct Begun {
    Projection projection;
    Polygon part;  ///< of the slave facet, not empty
    bool faced;    ///< it decides whether it does
  };
  /// None where no part of the slave facet was before it, but their planes alone: a plane far from
  /// its facet tells nothing, and the place of now decides.
  std::optional<Begun> before(Index f, Index master) const {
    if (!earlier_) return {};
    const Plane& base = earlier_->slave.planes[f];
    const Projection p = project(d_, base, earlier_->master.facet(master), earlier_->X);
    if (!p.inverts) return {};
    const Polygon part = inside(d_, reference_facet(d_), p);
    if (part.empty()) return {};
    return Begun{p, part, earlier_->master.planes[master].normal.dot(base.normal) < facing};
  }
  /// Fills nearer_: pairs whose parts overlap, found by a sweep along xi_1.
  void separate() {
    std::sort(candidates_.begin(), candidates_.end(),
              [](const Candidate& a, const Candidate& b) { return a.left < b.left; });
    nearer_.assign(candidates_.size(), {});
    std::vector<std::size_t> open;
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      const Candidate& c = candidates_[k];
      const auto passed = [&](std::size_t q) { return candidates_[q].right <= c.left; };
      open.erase(std::remove_if(open.begin(), open.end(), passed), open.end());
      for (std::size_t q : open) {
        const Candidate& o = candidates_[q];
        ++pairs_;
        const Polygon common = inside(d_, c.part, o.projection);
        if (common.empty() || extent(common) <= overlapping * std::min(c.extent, o.extent))
          continue;
        const Vec2 xi = centroid(common);
        const bool o_nearer =
            std::abs(o.projection.distance(xi)) < std::abs(c.projection.distance(xi));
        if (o_nearer)
          nearer_[k].push_back(q);
        else
          nearer_[q].push_back(k);
      }
      open.push_back(k);
    }
  }
  /// Adds what the nearer candidates leave of candidate k.
  void cut_behind(std::size_t k, const std::vector<std::size_t>& before, std::vector<Cell>& cells) {
    std::vector<Polygon> parts{candidates_[k].part};
    for (std::size_t q : before) {
      std::vector<Polygon> left;
      for (const Polygon& part : parts)
        for (Polygon& piece : outside(d_, part, candidates_[q].projection))
          left.push_back(std::move(piece));
      parts = std::move(left);
    }
    for (Polygon& part : parts)
      if (extent(part) > vanishing) cells.push_back({candidates_[k].master, std::move(part)});
  }
  /// A cell deeper behind the slave than a facet is long lies past the other side of the master, or
  /// of the slave's own body, or at a corner that overlaps the face beside it: no partner at all.
  /// Where most of the facet is so deep, which deep adds up, bodies overlap.
  bool is_no_partner(Index f, const Cell& cell, Real& deep) {
    const Plane& base = slave_.planes[f];
    const Vec2 xi = centroid(cell.part);
    const Projection p = onto(cell.master, f);
    const Real depth = -p.distance(xi);
    const Real size = std::max(base.size, master_.planes[cell.master].size);
    if (depth <= thinnest * size) return false;
    if (shielded(f, xi, depth)) return true;
    if (depth <= size) return false;
    deep += extent(cell.part) / extent(reference_facet(d_));
    if (deep <= overlapped) return true;
    const Vec3 lambda = slave_coordinates(d_, xi);
    Vec3 x = Vec3::Zero();
    for (int v = 0; v < d_; ++v) x += lambda[v] * X_[slave_.facet(f).node[v]];
    refuse(
        "slave and master overlap by ", depth, " at ", place(d_, x),
        ", deeper than their facets are long (", size,
        "); move the bodies apart, and give what a fit is pressed by as gap < 0, or, where this is "
        "no overlap, give maxgap below ",
        depth);
  }
  bool leans(Index f, const std::vector<Cell>& cells) const {
    return std::all_of(cells.begin(), cells.end(), [&](const Cell& cell) {
      return master_.planes[cell.master].normal.dot(slave_.planes[f].normal) > leaning;
    });
  }
  /// Does a master facet that faces away, or the other face of the slave's body, lie between the
  /// slave and what is `depth` behind it?
  bool shielded(Index f, const Vec2& xi, Real depth) {
    const Plane& base = slave_.planes[f];
    tree_.find({base, -depth, 0, false}, found_);
    for (Index m : found_) {
      ++pairs_;
      const Projection p = onto(m, f);
      if (!p.inverts) continue;
      const Real distance = p.distance(xi);
      const bool away = master_.planes[m].normal.dot(base.normal) >= facing;
      if (!away && !own_.is_through_body(slave_, f, master_.facet(m), xi)) continue;
      if (p.at(xi).head(d_).minCoeff() >= inside_facet && distance < -on_itself * base.size &&
          distance > -depth)
        return true;
    }
    return false;
  }
  Real nearest_facing() {
    Real nearest = infinity;
    for (Index f = 0; f < slave_.facets(); ++f) {
      find(f, infinity);
      for (const Candidate& c : candidates_)
        if (std::abs(c.distance) > maxgap_) nearest = std::min(nearest, std::abs(c.distance));
    }
    return nearest;
  }

  const Side &slave_, &master_;
  const std::vector<Vec3>& X_;
  Real maxgap_;
  int d_;
  const OwnSurface own_;
  const std::optional<Earlier>& earlier_;
  const Real moved_;
  FacetTree tree_;
  std::map<Index, std::vector<Index>> facets_at_;
  std::vector<Index> found_;
  std::vector<Candidate> candidates_;
  std::vector<std::vector<std::size_t>> nearer_;  ///< per candidate: those that hide parts of it
  std::size_t pairs_ = 0;
};

}  // namespace

Cover cover(const Nodes& nodes, bool itself, const Side& slave, const Side& master, Real maxgap,
            const std::optional<Earlier>& earlier) {
  return Covering(nodes, itself, slave, master, maxgap, earlier).run();
}

}  // namespace frictioncg::mortar
