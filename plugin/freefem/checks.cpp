#include "checks.h"

#include "report.h"

namespace frictioncg {

namespace {

/// What the data of a call may be compared with.
struct Scales {
  Real extent = 0;     ///< of the contact boundary [length]
  Real moved = 0;      ///< what the load would move by the diagonal of A alone; 0 without a load
  Real stiffness = 0;  ///< mean of the diagonal of A on free dofs
  Real stiffest = 0;   ///< the largest of it
};

Scales scales_of(const Scene& scene, const Vector& b, const System& system, Real extent,
                 const Processes& all) {
  const Vector& D = system.D;
  Real load = 0, diagonal[] = {D.sum(), Real(D.size())};
  for (Index i = 0; i < scene.ndof(); ++i)
    if (!scene.holds(i) && all.owns(i)) load = std::max(load, std::abs(b[i]));
  system.sum(diagonal, 2);
  Scales s;
  s.extent = extent;
  s.stiffness = diagonal[0] / diagonal[1];
  s.stiffest = system.largest(D.size() > 0 ? D.maxCoeff() : 0);
  s.moved = system.largest(load) / s.stiffness;
  return s;
}

Real contact_extent(const Scene& scene) {
  if (scene.nodes.empty()) return 2 * extent_of(scene.places()).radius;  // nothing faces
  Real extent = 0;
  for (const BoundaryNode& n : scene.nodes) {
    extent = std::max(extent, length(n.x - scene.nodes.front().x));
    extent = std::max(extent, std::pow(n.weight, 1.0 / (scene.d - 1)));
  }
  return extent;
}

/// A dof in words: u1, and (0, 0.5).
struct DofInWords {
  std::string component = "u", place = "a node";
};
DofInWords in_words(const Scene& scene, long dof) {
  for (const NodePlace& n : scene.places())
    for (int c = 0; c < scene.d; ++c)
      if (n.dof[c] == dof) return {"u" + std::to_string(c + 1), mortar::place(scene.d, n.x)};
  return {};
}

constexpr const char* assemble_both = "assemble A and b by one varf, as in a(Vh, Vh) and a(0, Vh)";

/// Of b, where Dirichlet rows of A have no data.
std::string lacks_data(const std::string& labels, const std::string& component,
                       const std::string& where = "") {
  return "lacks the on(" + labels + ", " + component + "=...)" + where +
         " that A has: " + assemble_both + ", or set to 0 what b has in Dirichlet rows";
}

/// b = tgv u_D against tgv in A: another tgv makes u_D huge (A with -1, b with 1e30) or next to
/// nothing (the other way round), less than the rounding of an expression that should be 0.
constexpr Real tgv_ratio = 1e20;

[[noreturn]] void refuse_data(const Vector& b, const Vector& u0, long i, const std::string& why) {
  refuse("b[", i, "] = ", b[i], " prescribes a displacement of ", u0[i],
         " in the Dirichlet row of A; ", why);
}

constexpr const char* different_tgv =
    "A and b were assembled with different tgv: give both the same, as in a(Vh, Vh, tgv=-1) and "
    "a(0, Vh, tgv=-1)";

/// Nodes that have one value of b in a component, and the labels that they make up.
struct OneValue {
  std::vector<long> labels;
  std::map<Index, Real> share;  ///< of the boundary, per dof
  /// Data of on() have it at the ends, too. Where the shares are alike, as on a closed boundary, a
  /// traction has it as well.
  bool like_data() const {
    if (share.size() < 3) return false;
    const auto less = [](const auto& a, const auto& b) { return a.second < b.second; };
    const auto [least, most] = std::minmax_element(share.begin(), share.end(), less);
    return most->second > 1.5 * least->second;
  }
};

/// Of a component, the labels whose free nodes all have one value of b, but 0, by that value.
std::map<Real, OneValue> labels_of_one_value(const Scene& scene, const Vector& b, int c) {
  std::map<std::pair<int, long>, std::vector<const LabelledNode*>> of_label;
  for (const LabelledNode& n : scene.labelled())
    if (!scene.holds(n.dof[c])) of_label[{n.space, n.label}].push_back(&n);
  std::map<Real, OneValue> found;
  for (const auto& [label, own] : of_label) {
    const Real value = b[own.front()->dof[c]];
    const auto same = [&](const LabelledNode* n) { return b[n->dof[c]] == value; };
    if (value == 0 || !std::all_of(own.begin(), own.end(), same)) continue;
    found[value].labels.push_back(label.second);
    for (const LabelledNode* n : own) found[value].share[n->dof[c]] += n->share;
  }
  return found;
}

/// The number of free dofs of a component at which b is `value`.
std::size_t count_value(const Scene& scene, const Vector& b, int c, Real value) {
  const std::vector<NodePlace> places = scene.places();
  return std::count_if(places.begin(), places.end(), [&](const NodePlace& n) {
    return !scene.holds(n.dof[c]) && b[n.dof[c]] == value;
  });
}

/// The dofs of a component on a boundary that is held, and those of them where it ends at a free
/// one that has a load.
struct HeldDofs {
  std::set<Index> all, ends;
  /// Loads at some of the ends, and 0 at all others.
  bool are_ends(const std::vector<Index>& loaded) const {
    return all.size() > 2 + ends.size() &&
           std::all_of(loaded.begin(), loaded.end(), [&](Index i) { return ends.count(i) > 0; });
  }
};

/// By space and label, where all nodes are held in a component.
std::map<std::pair<int, long>, HeldDofs> held_labels(const Scene& scene, const Vector& b, int c) {
  std::map<std::pair<int, long>, HeldDofs> held;
  std::map<std::pair<int, long>, int> loads;  // of free labels: nodes with one over those without
  for (const LabelledNode& n : scene.labelled()) {
    held[{n.space, n.label}].all.insert(n.dof[c]);
    if (!scene.holds(n.dof[c])) loads[{n.space, n.label}] += b[n.dof[c]] != 0 ? 1 : -1;
  }
  std::set<Index> of_free;
  for (const auto& [label, more] : loads) {
    if (more > 0) of_free.merge(held.at(label).all);
    held.erase(label);
  }
  std::map<Index, int> count;
  for (const auto& [label, dofs] : held)
    for (Index i : dofs.all) ++count[i];
  for (auto& [label, dofs] : held)
    for (Index i : dofs.all)
      if (count[i] == 1 && of_free.count(i)) dofs.ends.insert(i);
  return held;
}

/// Whether b is what one load per content makes of most of the dofs, whose unit loads differ: data
/// of on() are functions of the place alone.
bool are_load(const HeldDofs& held, const Vector& b, const Vector& unit) {
  constexpr Real rounding = 1e-9, differ = 1.4;
  const std::set<Index>& dofs = held.all;
  const auto less = [&](Index i, Index j) { return std::abs(unit[i]) < std::abs(unit[j]); };
  const Index largest = *std::max_element(dofs.begin(), dofs.end(), less);
  const Real most = std::abs(unit[largest]), load = b[largest] / unit[largest];
  if (!(most > 0) || load == 0) return false;
  int alike = 0, others = 0;  // of those of which the load makes something, as of P2 it does not
  Real least = most;
  for (Index i : dofs) {
    if (std::abs(b[i] - load * unit[i]) > rounding * std::abs(load) * most) {
      if (unit[i] == 0 && held.ends.count(i) == 0) return false;  // of a vertex of P2 it is 0
      ++others;
      continue;
    }
    alike += unit[i] != 0;
    least = std::min(least, std::abs(unit[i]));
  }
  return alike > 2 && alike > others && differ * least < most;
}

bool has_equal_blocks(const DofCount& dofs) {
  return dofs.first > 0 && 2 * dofs.first == dofs.count;
}

/// What a block of A is to the nodes of a space: rows that translations leave without a force, and
/// those of them that rotations leave without a force, too: all, but with the places of another
/// mesh.
struct BlockFit {
  Index translated = 0, rotated = 0;
  bool holds() const { return translated > 0 && rotated == translated; }
  bool fails() const { return rotated < translated; }
};

/// The dofs of a call with the places of their nodes, and another order of them: of two spaces, of
/// as many dofs each, the second first; of one, each component of all nodes after the last.
class BlockOrder {
 public:
  BlockOrder(const std::vector<NodePlace>& places, int d, const DofCount& dofs)
      : pair_(dofs.first > 0),
        d_(d),
        first_(pair_ ? dofs.first : dofs.count / 2),
        component_(dofs.count, -1),
        x_(dofs.count) {
    for (const NodePlace& n : places)
      for (int c = 0; c < d; ++c) {
        component_[n.dof[c]] = c;
        x_[n.dof[c]] = n.x;
      }
  }
  /// Whether both halves of A have the other order, and not this one.
  bool exchanged(const Triplets& A) const {
    const std::array<BlockFit, 2> some = fits(A, true, 1 + first_ / 100);  // mostly they tell
    if (some[0].fails() || some[1].fails()) return false;
    const std::array<BlockFit, 2> given = fits(A, false, 1), other = fits(A, true, 1);
    return other[0].holds() && other[1].holds() && !given[0].holds() && !given[1].holds();
  }
  long elsewhere(long dof) const {
    if (pair_) return dof < first_ ? dof + first_ : dof - first_;
    const long nodes = static_cast<long>(component_.size()) / d_;
    return d_ * (dof % nodes) + dof / nodes;
  }

 private:
  struct Row {
    Vec3 force = Vec3::Zero(), moment = Vec3::Zero();
    Real size = 0, arm = 0;  ///< of what was summed
  };
  /// The fits of each `step`-th row of both blocks, which may have the places of the other one.
  std::array<BlockFit, 2> fits(const Triplets& A, bool other, long step) const {
    std::vector<Row> rows(A.n);
    std::vector<char> counts(A.n, 0);
    for (long i = 0; i < A.n; i += step) counts[i] = 1;
    for_each_entry(A, [&](Index i, Index j, Real a) {
      const long p = other ? elsewhere(i) : i, q = other ? elsewhere(j) : j;
      if (!counts[i] || component_[p] < 0 || component_[q] < 0) return;
      const Vec3 e = Vec3::Unit(component_[q]), arm = x_[q] - x_[p];
      Row& row = rows[i];
      row.force += a * e;
      row.moment += a * arm.cross(e);
      row.size += std::abs(a);
      row.arm += std::abs(a) * arm.norm();
    });
    constexpr Real rounding = 1e-9;
    std::array<BlockFit, 2> fit;
    for (long i = 0; i < A.n; ++i) {
      const Row& r = rows[i];
      if (!(r.size > 0) || r.force.norm() > rounding * r.size) continue;
      BlockFit& of = fit[i < first_ ? 0 : 1];
      ++of.translated;
      of.rotated += r.moment.norm() <= rounding * r.arm;
    }
    return fit;
  }

  bool pair_;
  int d_;
  long first_;  ///< the dofs of the first half
  std::vector<int> component_;
  std::vector<Vec3> x_;
};

/// Refuses Dirichlet data in b, tgv u_D, where A has no Dirichlet row: they would be a load that
/// moves the body 1e10 times its own size and more. Larger than tgv makes them is a mere overflow.
void refuse_data_without_row(const Scene& scene, const Vector& b, const Scales& s) {
  constexpr Real absurd = 1e10, overflow = 1e60;
  for (long i = 0; i < scene.ndof(); ++i) {
    const Real size = std::abs(b[i]);
    if (scene.holds(i) || !(size > absurd * s.extent * s.stiffness) || size > overflow) continue;
    const DofInWords dof = in_words(scene, i);
    refuse("b[", i, "] = ", b[i], " is Dirichlet data, tgv times a displacement, where A has ",
           "no Dirichlet row: it lacks the on(..., ", dof.component, "=...) at ", dof.place,
           " that b has; ", assemble_both);
  }
}

bool is_tiny(Real u, const Scales& s) { return u > 0 && u * tgv_ratio < s.extent; }

/// What b has at the Dirichlet dofs of a body, where it is too small to be data of tgv = 1e30: how
/// many nodes have something there, and how many 0.
struct Leftover {
  Real loaded = 0, empty = 0;
  Real most = 0;  ///< the largest of b there [force]
  /// Of each component, the least and the largest.
  Vec3 least = Vec3::Constant(infinity), largest = -least;
  void add(const Scene& scene, const Vector& b, const NodePlace& n) {
    bool held = false, any = false;
    for (int c = 0; c < scene.d; ++c) {
      const Index i = n.dof[c];
      if (!scene.holds(i)) continue;
      held = true;
      if (b[i] == 0) continue;
      any = true;
      most = std::max(most, std::abs(b[i]));
      least[c] = std::min(least[c], b[i]);
      largest[c] = std::max(largest[c], b[i]);
    }
    loaded += any;
    empty += held && !any;
  }
  /// One value for all nodes: forces of a mesh are smaller at the ends of a boundary.
  bool uniform() const { return loaded > 2 && !(least.array() < largest.array()).any(); }
};

/// Of each body.   Collective.
std::vector<Leftover> leftovers(const Scene& scene, const Vector& b, const Processes& all) {
  const std::vector<NodePlace> places = scene.places();
  std::vector<Leftover> left(static_cast<Index>(all.largest(count_bodies(places))));
  for (const NodePlace& n : places)
    if (all.owns(n.dof[0])) left[n.body].add(scene, b, n);
  for (Leftover& of_body : left) {
    Eigen::Vector2d counts(of_body.loaded, of_body.empty);
    Eigen::Matrix<Real, 7, 1> most;
    most << of_body.most, of_body.largest, -of_body.least;
    all.sum(counts.data(), 2);
    all.largest(most.data(), 7);
    of_body = {counts[0], counts[1], most[0], -most.tail<3>(), most.segment<3>(1)};
  }
  return left;
}

/// Data that are next to nothing are 0 where b = A U + r leaves the rest: what the other entries of
/// the row make of a displacement U, at every node, of its own size at each. Refused is what they
/// cannot make (U as large as a thousand bodies), what is the same at all nodes (data of another
/// tgv), and loads at some nodes only, 0 at most of them (b without the on() of A). i: the dof of
/// the largest data.
void refuse_tiny_data(const Scene& scene, const Vector& b, const Vector& u0, long i,
                      const Scales& s, const Leftover& left) {
  constexpr Real bodies = 1e3;
  if (left.uniform() || left.most > bodies * s.stiffest * s.extent)
    refuse_data(b, u0, i, different_tgv);
  if (left.loaded == 0 || left.empty < left.loaded) return;
  const DofInWords dof = in_words(scene, i);
  refuse_data(b, u0, i, "b " + lacks_data("...", dof.component, " at " + dof.place));
}

}  // namespace

Real check_data(const Scene& scene, const Vector& b, const Vector& u0, const System& system,
                Real extent, const Processes& all) {
  const Scales s = scales_of(scene, b, system, extent, all);
  long i = -1;  // the dof held whose data are largest; -1 where all are 0
  for (long k = 0; k < scene.ndof(); ++k)
    if (scene.holds(k) && b[k] != 0 && (i < 0 || std::abs(u0[k]) > std::abs(u0[i]))) i = k;
  all.agree([&] {
    refuse_data_without_row(scene, b, s);
    if (i >= 0 && std::abs(u0[i]) > tgv_ratio * std::max(s.extent, s.moved))
      refuse_data(b, u0, i, different_tgv);
  });
  if (scene.at || !is_tiny(system.largest(i < 0 ? 0 : std::abs(u0[i])), s)) return 0;
  Real most = 0;
  const std::vector<Leftover> bodies = leftovers(scene, b, all);
  all.agree([&] {
    for (const Leftover& left : bodies) {
      if (i >= 0) refuse_tiny_data(scene, b, u0, i, s, left);
      most = std::max(most, left.most);
    }
  });
  return most;
}

Real check_data(const Scene& scene, const Vector& b, const Vector& u0) {
  return check_data(scene, b, u0, *scene.system->system(), contact_extent(scene), Processes());
}

void check_one_value(const Scene& scene, const Vector& b, long verb) {
  const bool refused = scene.system->dirichlet().has_unit_rows();
  if (!refused && verb == 0) return;
  for (int c = 0; c < scene.d; ++c)
    for (const auto& [value, one] : labels_of_one_value(scene, b, c)) {
      if (!one.like_data() || one.share.size() != count_value(scene, b, c, value)) continue;
      std::ostringstream m;
      m << "b is " << value << " at each node of a boundary, its ends included, as on(";
      for (long label : one.labels) m << label << ", ";
      m << "u" << c + 1 << "=" << value
        << ") with tgv = -1 makes it, where A has no Dirichlet row; " << assemble_both
        << "; a load is an integral, int1d or int2d, with less at the ends";
      if (refused) throw IllegalInput(m.str());
      line() << "note: " << m.str() << std::endl;
    }
}

void check_load_for_data(const Scene& scene, const Vector& b, long verb) {
  if (scene.at || !scene.system->dirichlet().has_unit_rows()) return;
  bool any = false;
  for (long i = 0; i < scene.ndof(); ++i) any = any || (scene.holds(i) && b[i] != 0);
  if (!any) return;
  for (int c = 0; c < scene.d; ++c)
    for (const auto& [label, dofs] : held_labels(scene, b, c)) {
      std::vector<Index> loaded;
      std::copy_if(dofs.all.begin(), dofs.all.end(), std::back_inserter(loaded),
                   [&](Index i) { return b[i] != 0; });
      if (loaded.empty()) continue;
      const std::string why = "b has there what a load leaves, and " +
                              lacks_data(std::to_string(label.second), "u" + std::to_string(c + 1));
      if (are_load(dofs, b, scene.unit_load())) refuse_data(b, b, loaded.front(), why);
      if (verb > 0 && dofs.are_ends(loaded))
        line() << "note: b[" << loaded.front() << "] = " << b[loaded.front()]
               << " prescribes a displacement at an end of label " << label.second
               << ", where a load ends too, and 0 elsewhere: if it is none, " << why << std::endl;
    }
}

void refuse_component_blocks(const Scene& scene, const Triplets& A) {
  if (scene.dofs.first > 0 || scene.dofs.count % scene.d != 0) return;
  bool inside = scene.system->dirichlet().size() == 0;
  std::vector<char> on_boundary(scene.dofs.count, 0);
  for (const LabelledNode& n : scene.labelled())
    for (Index dof : n.dof)
      if (dof >= 0) on_boundary[dof] = 1;
  for (Index i = 0; i < scene.dofs.count && !inside; ++i)
    inside = scene.holds(i) && !on_boundary[i];
  if (!inside) return;  // on() holds nodes of labels alone
  if (!BlockOrder(scene.places(), scene.d, scene.dofs).exchanged(A)) return;
  throw IllegalInput(
      "A has the displacements one after the other, as [[A11, A12], [A12', A22]] of scalar spaces "
      "makes it, where the space of the call has those of each node together; assemble A and b "
      "by a varf([u1, u2], [v1, v2]) on that space");
}

/// Large entries of a mortar's slivers are no penalties of A.
void refuse_lost_penalties(const Scene& scene, const Triplets& A) {
  constexpr Real of_penalty = 0.01;
  const System& system = *scene.system->system();
  const std::vector<LostPenalty> lost = lost_penalties(system);
  if (lost.empty()) return;
  Vector diagonal = Vector::Zero(A.n);
  for (std::size_t e = 0; e < A.size; ++e)
    if (A.row(e) == A.col(e)) diagonal[A.row(e)] += A.a[e];
  const std::vector<NodePlace> places = scene.places();
  for (const auto& [k, aslant] : lost) {
    Index i = 0;
    scene.system->to_global(Vector::Unit(system.dofs(), k)).cwiseAbs().maxCoeff(&i);
    std::string at;
    for (const NodePlace& n : places) {
      if (std::find(n.dof.begin(), n.dof.end(), i) == n.dof.end()) continue;
      at = " at " + mortar::place(scene.d, n.x);
      for (Index j : n.dof)
        if (j >= 0 && j < A.n && diagonal[j] > diagonal[i]) i = j;
    }
    if (i >= A.n || diagonal[i] < of_penalty * system.D[k]) continue;
    refuse(
        "A(", i, ",", i, ") = ", diagonal[i], at,
        (aslant ? " is of a penalty along a direction between the axes (at contact nodes, between "
                  "normal and tangents), so large that A has rounded away what the body resists "
                  "across it"
                : " is of a penalty at a node that may touch, so large that the force of the "
                  "contact there is lost in the rounding of its own"),
        "; take 1e8 times the stiffness, which holds as well, or on() along an axis");
  }
}

bool are_exchanged(const Scene& scene, const Triplets& A) {
  return has_equal_blocks(scene.dofs) &&
         BlockOrder(scene.places(), scene.d, scene.dofs).exchanged(A);
}

void refuse_exchanged_blocks(const Scene& scene, const Triplets& A) {
  if (!has_equal_blocks(scene.dofs)) return;
  const BlockOrder order(scene.places(), scene.d, scene.dofs);
  if (order.exchanged(A)) refuse_order(scene.dofs);
  const Dirichlet held(A, scene.pairing->between().dof);
  Index here = 0, there = 0, all = 0;
  for (const BoundaryNode& n : scene.pairing->slave_nodes())
    for (int c = 0; c < scene.d; ++c) {
      if (n.point.normal[c] == 0) continue;
      ++all;
      here += held.holds(n.point.dof[c]);
      there += held.holds(static_cast<Index>(order.elsewhere(n.point.dof[c])));
    }
  if (here < all || there > 0) return;
  throw IllegalInput(
      "Dirichlet conditions hold the normal of every slave node, and of none if the blocks come in "
      "the other order: A = [[A1, 0], [0, A2]] and b = [b1, b2] have those of V1, the space of the "
      "slave, first; exchange them, or, where they are right, swap slave and master");
}

}  // namespace frictioncg
