#include "assembly/mortar/normals.h"

#include "assembly/slippable.h"
#include "linear_algebra.h"

namespace frictioncg::mortar {

namespace {

/// A node with the surfaces that meet there.
struct Meeting {
  Index fan = -1;  ///< the first of them
  bool several = false;
  PointNormal point;
  Vec3 sum = Vec3::Zero();  ///< of their normals, weighted
};
using Meetings = std::map<Index, Meeting>;

Meetings meetings(const Sides& of, std::size_t p, const Owns& owns) {
  const Side& slave = of.slaves[p];
  const SmoothSide smooth(slave, of.nodes.X);
  Meetings found;
  for (Index f = 0; f < slave.facets(); ++f)
    for (int v = 0; v < slave.d; ++v) {
      const Index i = slave.facet(f).node[v];
      if (!owns(p, f, i)) continue;
      const Index fan = smooth.fan(f, v);
      const FanNormal& here = smooth.at(f, v);
      const Real measure = slave.planes[f].measure;
      Meeting& at = found[i];
      at.point.x = of.nodes.X[i];
      if (at.fan < 0) at.fan = fan, at.point.normal = here.normal;
      at.several = at.several || at.fan != fan;
      at.point.weight += measure;
      at.point.turn = std::max(at.point.turn, here.turn);
      at.sum += measure * here.normal;
      if (at.several) at.point.normal = at.sum.normalized();
    }
  return found;
}

bool any_curved(const Meetings& all) {
  return std::any_of(all.begin(), all.end(), [](const auto& m) { return m.second.point.turn > 0; });
}

/// Makes the motions of each body tangential by themselves: other bodies have other motions.
/// body: of each node; empty: all are one
void follow_motions(int d, Index pair, const std::vector<Index>& body, Meetings& all,
                    Slipping& slipping) {
  std::map<Index, std::vector<Index>> of_body;
  for (const auto& [i, at] : all) of_body[body.empty() ? 0 : body[i]].push_back(i);
  for (const auto& [number, own] : of_body) {
    std::vector<PointNormal> points;
    for (Index i : own) points.push_back(all[i].point);
    const auto [count, is_new] = slipping.try_emplace({pair, number}, Slips());
    count->second =
        follow_slippable_motions(d, points, is_new ? DecidedSlips() : DecidedSlips(count->second));
    for (std::size_t k = 0; k < own.size(); ++k) all[own[k]].point = points[k];
  }
}

}  // namespace

Vec3 held_part(const Nodes& nodes, Index i, const Vec3& direction) {
  Vec3 held = Vec3::Zero();
  for (int c = 0; c < nodes.dimension && !nodes.held.empty(); ++c)
    if (nodes.held[i] >> c & 1) held[c] = direction[c];
  return held;
}

bool can_press(const Nodes& nodes, Index i, const Vec3& normal) {
  const bool taken = !nodes.taken.empty() && nodes.taken[i];
  return !taken && held_part(nodes, i, normal).norm() <= mostly_free;
}

std::vector<Vec3> slave_normals(const Sides& of, const Options& options, const Owns& owns,
                                Slipping& slipping) {
  std::vector<Meetings> all;
  for (std::size_t p = 0; p < of.slaves.size(); ++p) all.push_back(meetings(of, p, owns));
  std::vector<Index> body;
  if (options.bodies && std::any_of(all.begin(), all.end(), any_curved)) body = options.bodies();
  std::vector<Vec3> normal(of.nodes.X.size(), Vec3::Zero());
  for (Index p = 0; p < static_cast<Index>(all.size()); ++p) {
    Meetings& found = all[p];
    if (!found.empty() && !any_curved(found)) slipping.try_emplace({p, -1}, Slips());
    if (slipping.count({p, -1}) == 0) follow_motions(of.nodes.dimension, p, body, found, slipping);
    for (const auto& [i, at] : found) normal[i] = at.point.normal;
  }
  return normal;
}

namespace {

/// Mean square of n.w over that of w, up to which a motion is tangential to flats: rounding.
constexpr Real of_flats = 1e-12;
/// Cosine of 45 degrees: what a curved master has before a flat slave at a steeper angle is far
/// away; the motion alone tells the normal there, which turns by up to 60 degrees.
constexpr Real steep = M_SQRT1_2;
constexpr Tangential to_masters{0.05, 0.5};

/// What faces a node, by its measure.
struct Facing {
  PointNormal own;             ///< of the slave; its turn is 0 where that is flat
  Vec3 theirs = Vec3::Zero();  ///< of the master, where it may count
  Real same = 0;               ///< before what the slave's normal counts in any case
  Real other_turn = 0;         ///< from the facets; 0 of what is flat
  bool other_first = false;    ///< of two sides that let as many motions slip
  /// Before the flat that the chamfer keeps off: along its own normal it would wedge what slides,
  /// along the flat's it never does.
  bool at_chamfer = false;

  /// The normal of the slave that the master's means, where that may count. Beside a chamfer the
  /// own one leans over the kink, once bodies have been deformed.
  Vec3 of_master() const {
    return at_chamfer ? Vec3(-theirs.normalized()) : (same * own.normal - theirs).normalized();
  }
};

/// Nodes of one body before one other.
struct Group {
  std::map<Index, Facing> nodes;
  /// The surfaces, the master's where one is flat and one is not, or where flats lean.
  std::vector<PointNormal> other;
  std::vector<PointNormal> own() const {
    std::vector<PointNormal> points;
    for (const auto& [i, here] : nodes) {
      points.push_back(here.own);
      if (!here.at_chamfer) continue;
      points.back().normal = here.of_master();
      points.back().turn = 0;
    }
    return points;
  }
};

/// The normals of a bore come together.
std::vector<FacetShape> shapes_of(const Side& side, const std::vector<Vec3>& X,
                                  const SmoothSide& smooth) {
  std::vector<FacetShape> shapes;
  for (Index f = 0; f < side.facets(); ++f) {
    const Facet& facet = side.facet(f);
    const Vec3& n = side.planes[f].normal;
    bool flat = true;
    Real spread = 0;
    for (int v = 0; v < side.d; ++v) {
      const Vec3& at_vertex = smooth.at(f, v).normal;
      flat = flat && same_direction(at_vertex, n);
      spread += (at_vertex - n).dot(X[facet.node[v]] - X[facet.node[(v + 1) % side.d]]);
    }
    shapes.push_back({flat, !flat && spread < 0});
  }
  return shapes;
}

/// Between the vertices of a facet.
FanNormal normal_at(const SmoothSide& smooth, int d, Index f, const Vec3& lambda) {
  FanNormal here;
  for (int v = 0; v < d; ++v) {
    here.normal += lambda[v] * smooth.at(f, v).normal;
    here.turn = std::max(here.turn, smooth.at(f, v).turn);
  }
  here.normal.normalize();
  return here;
}

/// Whether facets of a side lean against those beside them.
bool is_curved(const Side& side) {
  return std::any_of(side.joints.begin(), side.joints.end(), [&](const Joint& j) {
    const auto [a, b] = j.facet;
    return j.cosine > sharp && !same_direction(side.planes[a].normal, side.planes[b].normal);
  });
}

/// Sine of the angle up to which what was flat before bodies were deformed still lies.
constexpr Real still_flat = 0.1;

bool lies_flat(const Side& slave, Index f, const Side& master, const Cell& before) {
  const Vec3 &n = slave.planes[f].normal, m = -master.planes[before.master].normal;
  if (!slave.is_moved) return same_direction(m, n);
  return n.dot(m) > 0 && n.cross(m).norm() <= still_flat;
}

/// Whether some, and all, of what a pair covers lies flat.
struct Lies {
  bool some = false, all = true;
};
Lies lies_flat(const Sides& of, std::size_t p) {
  Lies lies;
  for (Index f = 0; f < of.slaves[p].facets(); ++f)
    for (const Cell& cell : of.covers[p].cells[f]) {
      const bool flat = lies_flat(of.slaves[p], f, of.masters[p], cell);
      lies.some = lies.some || flat;
      lies.all = lies.all && flat && !of.slaves[p].is_moved;  // where all may lean a little
    }
  return lies;
}

/// What of the slaves leans on the plane on which a face of the same two bodies lies flat, and is
/// further away: a chamfer, which the face keeps off the plane. What is nearer, or leans on
/// something else, is a wedge: its own normals hold. Faces are flat, and planes the same, as they
/// are where bodies are not deformed.
class Chamfers {
 public:
  Chamfers(const Sides& of, const std::vector<Index>& body)
      : of_(of),
        X_(of.nodes.reference.empty() ? of.nodes.X : of.nodes.reference),
        body_(body),
        slaves_(faces(of.slaves)),
        masters_(faces(of.masters)) {
    for (std::size_t p = 0; p < of.slaves.size(); ++p)
      for_each_cell(p, [&](Index f, const Cell& cell, const TwoBodies& bodies, Real distance) {
        const Faces &slave = slaves_[p], &master = masters_[p];
        const bool flat = slave.shapes[f].flat && master.shapes[cell.master].flat;
        if (!flat || !lies_flat(of.slaves[p], f, of.masters[p], cell)) return;
        Flat& nearest = flats_[bodies];
        if (!(distance < nearest.distance)) return;
        const Real lean =
            of.slaves[p].planes[f].normal.cross(of.masters[p].planes[cell.master].normal).norm();
        nearest = {distance, lean, slave.side.planes[f].normal, master.side.planes[cell.master]};
      });
  }
  /// Tells which facets of a pair they are, and those of the master that are in the flats' planes.
  void mark(std::size_t p, PairShapes& shapes) const {
    shapes.leaning.assign(of_.slaves[p].facets(), 0);
    for_each_cell(p, [&](Index f, const Cell& cell, const TwoBodies& bodies, Real distance) {
      const auto flat = flats_.find(bodies);
      if (flat == flats_.end() || !is_level(masters_[p], cell.master, flat->second)) return;
      const bool plain = slaves_[p].shapes[f].flat;  // else beside another, as at a chamfer's kink
      const bool lean = leans(slaves_[p].side.planes[f].normal, flat->second);
      if (lean ? !(distance > flat->second.distance) : plain) return;
      shapes.leaning[f] = 1;
      if (lean && plain) shapes.chamfered.insert(bodies);
    });
    shapes.level.assign(of_.masters[p].facets(), 0);
    for (const TwoBodies& bodies : shapes.chamfered)
      for (Index m = 0; m < of_.masters[p].facets(); ++m)
        if (body_[of_.masters[p].facet(m).node[0]] == bodies.second)
          shapes.level[m] |= is_level(masters_[p], m, flats_.at(bodies));
  }

 private:
  /// Of a side where its body is not deformed.
  struct Faces {
    Side side;
    std::vector<FacetShape> shapes;
  };
  /// The nearest cell that lies.
  struct Flat {
    Real distance = infinity;  ///< [length]
    Real lean = 0;             ///< sine of the angle between the facets
    Vec3 normal;               ///< of the slave, not deformed, and the plane of the master
    Plane plane;
  };
  std::vector<Faces> faces(const std::vector<Side>& sides) const {
    std::vector<Faces> found;
    for (const Side& side : sides) {
      Faces& here =
          found.emplace_back(Faces{side.is_moved ? side.at_rest(of_.nodes.X, X_) : side, {}});
      here.shapes = shapes_of(here.side, X_, SmoothSide(here.side, X_));
    }
    return found;
  }
  template <class Visit>
  void for_each_cell(std::size_t p, const Visit& visit) const {
    const Side &slave = of_.slaves[p], &master = of_.masters[p];
    for (Index f = 0; f < slave.facets(); ++f)
      for (const Cell& cell : of_.covers[p].cells[f]) {
        const Facet& before = master.facet(cell.master);
        const Projection chi = project(slave.d, slave.planes[f], before, of_.nodes.X);
        const TwoBodies bodies{body_[slave.facet(f).node[0]], body_[before.node[0]]};
        visit(f, cell, bodies, chi.distance(centroid(cell.part)));
      }
  }
  bool is_level(const Faces& master, Index m, const Flat& flat) const {
    constexpr Real level = 1e-6;  // sine of the angle up to which facets are in one plane
    const Vec3 apart = X_[master.side.facet(m).node[0]] - flat.plane.origin;
    return master.shapes[m].flat &&
           same_direction(master.side.planes[m].normal, flat.plane.normal) &&
           std::abs(flat.plane.normal.dot(apart)) <= level * apart.norm();
  }
  /// More than twice as much as what lies, and less than upright.
  static bool leans(const Vec3& normal, const Flat& flat) {
    constexpr Real upright = 0.1;  // cosine of the angle to what lies, of which it is another side
    return !same_direction(normal, flat.normal) && normal.dot(flat.normal) > upright &&
           normal.cross(flat.normal).norm() > 2 * flat.lean;
  }

  const Sides& of_;
  const std::vector<Vec3>& X_;
  const std::vector<Index>& body_;
  std::vector<Faces> slaves_, masters_;
  std::map<TwoBodies, Flat> flats_;
};

/// The nodes of a pair that are before something, by the bodies of both sides.
std::map<TwoBodies, Group> facing_nodes(const Sides& of, std::size_t p, const Owns& owns,
                                        const std::vector<Index>& body,
                                        const std::vector<Vec3>& normal, PairShapes& shapes) {
  const Side &slave = of.slaves[p], &master = of.masters[p];
  const std::vector<Vec3>& X = of.nodes.X;
  const SmoothSide own(slave, X), theirs(master, X);
  if (shapes.slave.empty())
    shapes.slave = shapes_of(slave, X, own), shapes.master = shapes_of(master, X, theirs);
  std::map<TwoBodies, Group> groups;
  for (Index f = 0; f < slave.facets(); ++f) {
    const auto [own_is_flat, bore] = shapes.slave[f];
    for (const Cell& cell : of.covers[p].cells[f]) {
      const Facet& before = master.facet(cell.master);
      const Projection chi = project(slave.d, slave.planes[f], before, X);
      const Vec3 lambda = chi.at(centroid(cell.part));
      const FanNormal n = normal_at(theirs, slave.d, cell.master, lambda);
      const auto [flat, their_bore] = shapes.master[cell.master];
      const TwoBodies bodies{body[slave.facet(f).node[0]], body[before.node[0]]};
      const bool chamfer = shapes.at_chamfer(f, cell.master, bodies);
      const bool differs = own_is_flat != flat || chamfer || (bore && !their_bore);
      const Real measure = extent(cell.part) * slave.planes[f].measure;
      for (int v = 0; v < slave.d; ++v) {
        const Index i = slave.facet(f).node[v];
        if (!owns(p, f, i)) continue;
        Group& group = groups[bodies];
        Facing& here = group.nodes[i];
        here.at_chamfer = here.at_chamfer || chamfer;
        here.own.x = X[i];
        here.own.normal = normal[i];
        here.own.turn = std::max(here.own.turn, own_is_flat ? 0 : own.at(f, v).turn);
        here.own.weight += measure;
        here.other_turn = std::max(here.other_turn, differs && !flat ? n.turn : 0);
        here.other_first = here.other_first || (differs && (flat || bore));
        if (differs)
          here.theirs += measure * n.normal;
        else
          here.same += measure;
        const FanNormal& other = differs ? theirs.at(cell.master, v) : own.at(f, v);
        group.other.push_back({X[differs ? before.node[v] : i], other.normal, measure, other.turn});
      }
    }
  }
  return groups;
}

/// Of the relative motions of two bodies those that normals let slip.
DenseMatrix slipping(const Freedom& freedom, const DenseMatrix& relative,
                     const std::vector<PointNormal>& points, DecidedSlips decided = {}) {
  Real total = 0, allowed = 0;
  for (const PointNormal& p : points) {
    total += p.weight;
    allowed += p.weight * untold(p.turn);
  }
  return tangential_motions(freedom.generators, relative, points,
                            std::max(allowed / total, of_flats), decided);
}

/// By how much more A has to resist one motion for another to count as the softer one. What the
/// side that counts does not see is wrong by the contact's pressure over A's stiffness.
constexpr Real clearly_stiffer = 10;

/// Whether V and W have a motion in common that is no translation.
bool turn_as_one(int d, const DenseMatrix& V, const DenseMatrix& W) {
  constexpr Real alike = 1e-5;
  if (V.cols() == 0 || W.cols() == 0) return false;
  DenseMatrix both(V.rows(), V.cols() + W.cols());
  both << V, W;
  both.colwise().normalize();
  const DenseMatrix common = both.leftCols(V.cols()) * null_space(both, alike).topRows(V.cols());
  return common.bottomRows(common.rows() - d).norm() > alike * common.norm();
}

DenseMatrix motions_of(const Freedom& freedom) {
  return DenseMatrix::Identity(freedom.generators.count(), freedom.generators.count());
}

/// Of a relative motion of two bodies, each of which does its part of it: K (K + L)^-1 L.
DenseMatrix in_series(const DenseMatrix& K, const DenseMatrix& L) {
  return K * least_squares(K + L, L);
}

/// Whether, motion by motion from the softest on, A resists the first ones clearly less.
bool is_softer(const DenseMatrix& stiffness, const DenseMatrix& first, const DenseMatrix& second) {
  const auto sorted = [&](const DenseMatrix& motions) {
    return motions.cols() == 0
               ? Vector()
               : eigenpairs(motions.transpose() * DenseMatrix(stiffness * motions)).values;
  };
  const Vector a = sorted(first), b = sorted(second);
  for (Index i = 0; i < a.size(); ++i) {
    if (i == b.size() || clearly_stiffer * a[i] < b[i]) return true;
    if (clearly_stiffer * b[i] < a[i]) return false;
  }
  return false;
}

/// Whether supports hold both bodies against each of the motions.
bool supports_hold(const Freedom& freedom, Index slave, Index master, const DenseMatrix& motions) {
  constexpr Real share = 1e-3;  // of the stiffness: the rest is that of springs
  for (Index body : {slave, master})
    for (Index j = 0; j < motions.cols(); ++j) {
      const Vector m = motions.col(j);
      if (freedom.support.empty() ||
          m.dot(freedom.support[body] * m) <= share * m.dot(freedom.stiffness[body] * m))
        return false;
    }
  return true;
}

/// free: relative motions that A leaves free. The more of them slip the better; the mesh tells the
/// others up to errors alone, which A may resist. is_moved: energies are those of stresses, too,
/// and normals at X + U are right whichever side has them.
bool master_counts(const Freedom& freedom, const Group& group, Index slave, Index master,
                   const DenseMatrix& free, bool is_moved) {
  const std::vector<PointNormal> own = group.own();
  const auto free_of_other = slipping(freedom, free, group.other).cols(),
             more = free_of_other - slipping(freedom, free, own).cols();
  if (more != 0) return more > 0;
  const bool other_first = std::any_of(group.nodes.begin(), group.nodes.end(),
                                       [](const auto& n) { return n.second.other_first; });
  if (is_moved) return other_first && free_of_other > 0;
  const DenseMatrix all = motions_of(freedom), of_own = slipping(freedom, all, own),
                    of_other = slipping(freedom, all, group.other);
  if (supports_hold(freedom, slave, master, of_own) &&
      supports_hold(freedom, slave, master, of_other))
    return false;
  const DenseMatrix stiffness = in_series(freedom.stiffness[slave], freedom.stiffness[master]);
  return other_first ? !is_softer(stiffness, of_own, of_other)
                     : is_softer(stiffness, of_other, of_own);
}

/// Nodes with the master's normals.
std::vector<PointNormal> with_masters(const Group& group) {
  std::vector<PointNormal> taken;
  for (const auto& [i, here] : group.nodes) {
    const Vec3 theirs = here.of_master();
    const bool far = here.other_turn > 0 && !(theirs.dot(here.own.normal) > steep);
    taken.push_back({here.own.x, far ? here.own.normal : theirs, here.own.weight, here.other_turn});
  }
  return taken;
}

}  // namespace

CommonNormals choose_common_normals(const Sides& of, const Options& options, const Owns& owns,
                                    const CommonNormals* begun, std::vector<Vec3>& normal) {
  const int d = of.nodes.dimension;
  CommonNormals common(of.nodes.X.size());
  if (!options.freedom) return common;
  std::vector<Lies> lies(of.slaves.size());
  for (std::size_t p = 0; p < lies.size() && !begun; ++p) lies[p] = lies_flat(of, p);
  const bool some_lie = std::any_of(lies.begin(), lies.end(), [](const Lies& l) { return l.some; });
  std::optional<Freedom> freedom;
  std::optional<Chamfers> chamfers;
  for (std::size_t p = 0; p < of.slaves.size(); ++p) {
    PairShapes& shapes = common.shapes.emplace_back();
    if (begun) shapes = begun->shapes[p];
    const auto ask_freedom = [&] {
      if (!freedom) freedom = options.freedom();
    };
    if (some_lie && !lies[p].all) {
      ask_freedom();
      if (!chamfers) chamfers.emplace(of, freedom->body);
      chamfers->mark(p, shapes);
    }
    const bool curved =
        !shapes.chamfered.empty() || is_curved(of.slaves[p]) || is_curved(of.masters[p]);
    if (begun ? shapes.slave.empty() : !curved) continue;
    ask_freedom();
    const auto groups = facing_nodes(of, p, owns, freedom->body, normal, shapes);
    for (const auto& [bodies, group] : groups) {
      const auto [slave, master] = bodies;
      if (slave == master) continue;
      const DenseMatrix &V = freedom->of_body[slave], &W = freedom->of_body[master];
      DenseMatrix relative(freedom->generators.count(), V.cols() + W.cols());
      relative << V, W;
      if (turn_as_one(d, V, W))
        for (const auto& [i, here] : group.nodes) common.turns[i] = 1;
      const std::array<Index, 3> key{static_cast<Index>(p), slave, master};
      CommonNormals::Choice& choice = common.choice[key];
      const bool decided = begun && begun->choice.count(key) > 0;
      if (decided)
        choice = begun->choice.at(key);
      else
        choice.master =
            master_counts(*freedom, group, slave, master, relative, !of.nodes.reference.empty());
      const auto slip = [&](const DenseMatrix& all, Slips& slips) {
        const DenseMatrix motions =
            slipping(*freedom, all, choice.master ? group.other : group.own(),
                     decided ? DecidedSlips(slips) : DecidedSlips());
        slips = slips_of(motions);
        return motions;
      };
      const DenseMatrix free = slip(relative, choice.free);
      std::vector<PointNormal> points = choice.master ? with_masters(group) : group.own();
      if (choice.master)
        make_tangential(d, freedom->generators, slip(motions_of(*freedom), choice.motions), points,
                        to_masters);
      make_tangential(d, freedom->generators, free, points,
                      choice.master ? to_masters : to_free_motions);
      std::size_t k = 0;
      for (const auto& [i, here] : group.nodes) {
        normal[i] = points[k++].normal;
        common.of_master[i] |= choice.master || here.at_chamfer;
      }
    }
  }
  return common;
}

namespace {

/// A part reaches a vertex that is this near to one of its own, in reference coordinates: rounding.
constexpr Real on_vertex = 1e-9;
/// Square of the sine of the angle up to which two rims are one.
constexpr Real parallel_to = 1e-12;

bool juts_out(const Side& side, const Joint& joint, const std::vector<Vec3>& X) {
  const auto [f, g] = joint.facet;
  const Vec3 beyond = centre_of(side.d, side.facet(g), X) - X[joint.vertex[0]];
  return side.planes[f].normal.dot(beyond) < 0;
}

/// visit(f, v, outward): the vertices v of each ridge of a facet f that is a rim or juts out.
/// outward: across it, in the plane of f, unit
template <class Visit>
void for_each_end(const Side& side, const std::vector<Vec3>& X, const Visit& visit) {
  std::vector<std::array<Index, 2>> inner;  // sorted, as joints are
  for (const Joint& joint : side.joints)
    if (joint.goes_on || !juts_out(side, joint, X)) inner.push_back(joint.vertex);
  for (Index f = 0; f < side.facets(); ++f)
    for (int v = 0; v < side.d; ++v) {
      const Facet& facet = side.facet(f);
      if (std::binary_search(inner.begin(), inner.end(), ridge_of(side.d, facet, v))) continue;
      Vec3 outward = X[facet.node[v]] - X[facet.node[(v + side.d - 1) % side.d]];
      if (side.d == 3) {
        const Vec3 along = (X[facet.node[(v + 1) % 3]] - X[facet.node[v]]).normalized();
        outward -= outward.dot(along) * along;
      }
      visit(f, v, outward.normalized());
      if (side.d == 3) visit(f, (v + 1) % 3, outward.normalized());
    }
}

/// The point of the cone that plane vectors g span which is nearest to t, in their plane.
Vec3 nearest_in_cone(const Vec3& t, const std::vector<Vec3>& g) {
  Vec3 nearest = Vec3::Zero();
  for (std::size_t p = 0; p < g.size(); ++p) {
    const Vec3 on_ray = std::max<Real>(t.dot(g[p]), 0) * g[p];
    if (on_ray.norm() > nearest.norm()) nearest = on_ray;
    for (std::size_t q = 0; q < p; ++q) {
      const Real c = g[p].dot(g[q]), a = t.dot(g[p]), b = t.dot(g[q]);
      if (1 - c * c > parallel_to && a - c * b >= 0 && b - c * a >= 0) return t;
    }
  }
  return nearest;
}

/// A node at the end of a face, as a vertex of one of its facets there.
struct End {
  Index facet = -1;
  int vertex = 0;
  const Cell* cell = nullptr;  ///< before it; null: none
  std::vector<Vec3> outward;   ///< of the face, in its plane, unit
};

std::map<Index, End> ends_of_faces(const Sides& of, std::size_t p, const Owns& owns) {
  std::map<Index, End> ends;
  for_each_end(of.slaves[p], of.nodes.X, [&](Index f, int v, const Vec3& outward) {
    const Index i = of.slaves[p].facet(f).node[v];
    if (!owns(p, f, i)) return;
    End& end = ends[i];
    // on a plane of symmetry the face goes on, as towards whatever a component is held of
    const Vec3 held = held_part(of.nodes, i, outward);
    if (held.lpNorm<Eigen::Infinity>() <= mostly_free) end.outward.push_back(outward);
    if (end.cell) return;
    end.facet = f, end.vertex = v;
    for (const Cell& cell : of.covers[p].cells[f])
      for (const Vec2& xi : cell.part)
        if ((xi - reference_vertex(v)).norm() < on_vertex) end.cell = &cell;
  });
  return ends;
}

/// From which angle on a face leans, and from which on it does so as a whole: less is what bodies
/// deform by, and errors of a smooth face's normals, which its turn from facet to facet bounds.
constexpr Real leans = 0.02, leans_whole = 0.04, of_turn = 2;

/// How far the facet leans as a whole: 1 where all that it is before leans three quarters as much
/// as the end, 0 where half of that does not lean half as much. Beside a dent the end alone leans,
/// and at the foot of a wall a part.   lean_at(cell, xi): there
template <class LeanAt>
Real leaning_share(const std::vector<Cell>& cells, Real of_end, const LeanAt& lean_at) {
  Real leaning = 0, all = 0;
  for (const Cell& cell : cells) {
    Real least = of_end;
    for (const Vec2& xi : cell.part) least = std::min(least, lean_at(cell, xi).norm());
    all += extent(cell.part);
    leaning += extent(cell.part) * std::clamp<Real>(4 * least / of_end - 2, 0, 1);
  }
  return std::max<Real>(0, 2 * leaning / all - 1);
}

}  // namespace

void take_masters_at_ends(const Sides& of, const Owns& owns, std::vector<Vec3>& normal,
                          std::vector<char>& of_master) {
  const std::vector<Vec3>& X = of.nodes.X;
  for (std::size_t p = 0; p < of.slaves.size(); ++p) {
    const Side &slave = of.slaves[p], &master = of.masters[p];
    if (lies_flat(of, p).all) continue;
    std::optional<SmoothSide> own, theirs;
    for (const auto& [i, end] : ends_of_faces(of, p, owns)) {
      const Vec3 n = normal[i];
      if (!end.cell || of_master[i] || end.outward.empty()) continue;
      if (same_direction(-master.planes[end.cell->master].normal, n)) continue;
      if (!theirs) theirs.emplace(master, X);
      const auto m_at = [&, plane = slave.planes[end.facet]](const Cell& cell, const Vec2& xi) {
        const Projection chi = project(slave.d, plane, master.facet(cell.master), X);
        return Vec3(-normal_at(*theirs, slave.d, cell.master, chi.at(xi)).normal);
      };
      const auto lean = [&n, &outward = end.outward](const Vec3& m) {
        return nearest_in_cone(m - m.dot(n) * n, outward);
      };
      const Vec3 m = m_at(*end.cell, reference_vertex(end.vertex)), t = lean(m);
      if (t.norm() <= leans) continue;
      if (!own) own.emplace(slave, X);
      const Real turn = own->at(end.facet, end.vertex).turn;
      const Real from = std::max(leans, of_turn * turn), whole = leans_whole / leans * from;
      const auto lean_at = [&](const Cell& cell, const Vec2& xi) { return lean(m_at(cell, xi)); };
      const Real share = std::clamp<Real>((t.norm() - from) / (whole - from), 0, 1) *
                         leaning_share(of.covers[p].cells[end.facet], t.norm(), lean_at);
      if (share == 0) continue;
      normal[i] = (m.dot(n) * n + share * t).normalized();
      of_master[i] = 1;
    }
  }
}

}  // namespace frictioncg::mortar
