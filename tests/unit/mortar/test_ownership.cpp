#include <gtest/gtest.h>

#include <random>

#include "core/assembly/mortar/owners.h"
#include "steps.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

/// A facet in the plane, between two nodes.
void add(Surfaces& s, Surface& surface, Index a, Index b, const Vec3& outward, long label) {
  s.add(surface, {a, b}, 1, label);
  surface.facets.back().outward = outward;
}

/// A ring of voussoirs around a shaft, one facet each at the bore, with play there: their joints
/// touch, so that the corner in front of each belongs to the joint, and the one behind to the bore.
/// Pairs: the bore on the shaft, then the joints.
Surfaces ring(int blocks, Real play) {
  Surfaces s(2);
  s.pairs.resize(2);
  const Real step = 2 * std::acos(-1.) / blocks;
  const auto polar = [](Real angle, Real r) {
    return Vec3(r * std::cos(angle), r * std::sin(angle), 0);
  };
  Surface &bore = s.pairs[0].slave, &shaft = s.pairs[0].master;
  Surface &fronts = s.pairs[1].slave, &backs = s.pairs[1].master;
  bore.labels = {1}, shaft.labels = {5}, fronts.labels = {2}, backs.labels = {4};
  for (int k = 0; k < blocks; ++k) {
    const Real from = k * step, to = from + step;
    const Index first = static_cast<Index>(s.nodes.X.size());
    for (Real angle : {from, to})
      for (Real r : {1., 2.}) s.nodes.X.push_back(polar(angle, r));
    for (Real angle : {from, to}) s.nodes.X.push_back(polar(angle, 1 - play));
    add(s, backs, first, first + 1, polar(from - step / 4, -1).cross(Vec3::UnitZ()), 4);
    add(s, fronts, first + 2, first + 3, -polar(to + step / 4, -1).cross(Vec3::UnitZ()), 2);
    add(s, bore, first, first + 2, -polar(from + step / 2, 1), 1);
    add(s, shaft, first + 4, first + 5, polar(from + step / 2, 1), 5);
  }
  return s;
}

/// Three faces of a box, which meet at a corner, and before each a sheet somewhere, at t.
class Box {
 public:
  Box(std::mt19937& random, int n) : random_(random), cells_(n) {
    for (Sheet& sheet : sheets_) {
      sheet.from = {within(-0.2, 1), within(-0.2, 1)};
      sheet.size = {within(0, 1), within(0, 1)};
      sheet.motion = {within(-0.2, 0.2), within(-0.2, 0.2)};
      sheet.gap = within(0, 0.1), sheet.tilt = within(-0.1, 0.1);
    }
  }
  Surfaces surfaces(Real t, bool one_pair) const {
    Surfaces s(3);
    s.pairs.resize(one_pair ? 1 : 3);
    std::map<std::array<int, 3>, Index> node;  // by its place on the grid
    for (int face = 0; face < 3; ++face) {
      Pair& pair = s.pairs[one_pair ? 0 : face];
      // local axes of the face; it is at 0 of the third
      const auto in_space = [face](const Vec3& x) {
        return Vec3(x[(3 - face) % 3], x[(4 - face) % 3], x[(5 - face) % 3]);
      };
      const auto add = [&](Surface& to, int n, int side, const auto& shape, long label) {
        const Index first = static_cast<Index>(s.nodes.X.size());
        for (Facet f : s.sheet(
                            n, side, [&](const Vec3& x) { return in_space(shape(x)); }, label)
                           .facets) {
          f.outward = in_space(Vec3(0, 0, side));
          for (int v = 0; v < 3 && side < 0; ++v) {
            std::array<int, 3> at;
            for (int c = 0; c < 3; ++c)
              at[c] = static_cast<int>(std::lround(n * s.nodes.X[f.node[v]][c]));
            f.node[v] = node.emplace(at, f.node[v]).first->second;
          }
          to.facets.push_back(f);
        }
        if (s.nodes.X.size() > static_cast<std::size_t>(first)) to.labels.push_back(label);
      };
      const Sheet& sheet = sheets_[face];
      add(pair.slave, cells_, -1, same, face + 1);
      add(
          pair.master, 1, 1, [&](const Vec3& x) { return sheet.at(x, t); }, face + 11);
    }
    return s;
  }

 private:
  struct Sheet {
    std::array<Real, 2> from, size, motion;
    Real gap, tilt;
    Vec3 at(const Vec3& x, Real t) const {
      return {from[0] + size[0] * x[0] + t * motion[0], from[1] + size[1] * x[1] + t * motion[1],
              -gap + tilt * (x[0] - x[1])};
    }
  };
  Real within(Real low, Real high) {
    return std::uniform_real_distribution<Real>(low, high)(random_);
  }
  std::mt19937& random_;
  int cells_;
  std::array<Sheet, 3> sheets_;
};

/// The force on the masters under a unit pressure along each node's own normal, sizes added up.
Real pressed(const Mortar& mortar, const Surfaces& s) {
  std::set<Index> on_master;
  for (const Pair& pair : s.pairs)
    for (const Facet& f : pair.master.facets)
      on_master.insert(f.node.begin(), f.node.begin() + s.nodes.dimension);
  Real all = 0;
  for (std::size_t k = 0; k < mortar.nodes().size(); ++k)
    for (Matrix::InnerIterator it(mortar.relative(), static_cast<Index>(k)); it; ++it)
      if (on_master.count(it.col()) > 0) all -= mortar.nodes()[k].weight * it.value();
  return all;
}

/// What of all slaves faces something.
Real covered(const Surfaces& s) {
  const int d = s.nodes.dimension;
  Real all = 0;
  for (const Pair& pair : s.pairs) {
    const Side slave(d, pair.slave, s.nodes.X), master(d, pair.master, s.nodes.X);
    const Cover of = cover(s.nodes, false, slave, master, s.options.maxgap);
    for (Index f = 0; f < slave.facets(); ++f) all += of.fraction[f] * slave.planes[f].measure;
  }
  return all;
}

}  // namespace

TEST(Ownership, AFaceOfOneFacetIsSparedACornerThatCanCarryItsLaw) {
  for (int held = 0; held < 3; ++held) {  // none, the left corner, the right one
    Surfaces s(2);
    s.nodes.X = {Vec3(0, 0, 0), Vec3(1, 0, 0),  Vec3(0, 1, 0), Vec3(1, 1, 0),     Vec3(0, -1, 0),
                 Vec3(0, 2, 0), Vec3(1, -1, 0), Vec3(1, 2, 0), Vec3(-1, -.05, 0), Vec3(2, -.05, 0)};
    Surface &slave = s.pairs[0].slave, &master = s.pairs[0].master;
    slave.labels = {1, 2, 3}, master.labels = {5};
    add(s, slave, 0, 1, -Vec3::UnitY(), 1);
    add(s, slave, 1, 3, Vec3::UnitX(), 2);
    add(s, slave, 0, 2, -Vec3::UnitX(), 3);
    add(s, master, 4, 5, Vec3::UnitX(), 5);
    add(s, master, 6, 7, -Vec3::UnitX(), 5);
    add(s, master, 8, 9, Vec3::UnitY(), 5);
    if (held > 0) {
      s.nodes.held.assign(10, 0);
      s.nodes.held[held - 1] = 2;  // the vertical displacement
    }
    const Mortar mortar = s.mortar();
    std::array<int, 2> down{};  // laws with the ground at the corners
    for (const SlaveNode& node : mortar.nodes())
      if (node.normal[1] < -0.9) ++down[static_cast<std::size_t>(node.node)];
    EXPECT_EQ(down[0] + down[1], 1) << held;
    if (held > 0) {
      EXPECT_EQ(down[static_cast<std::size_t>(held - 1)], 0) << held;
    }
    EXPECT_EQ(mortar.nodes().size(), 4) << held;
  }
}

TEST(Ownership, SparedNodesLeaveNoFacetWithoutANode) {
  std::mt19937 random(3);
  int moved = 0;
  long lacked = 0, lack = 0;
  for (int scene = 0; scene < 3000; ++scene) {
    // the cells of a sheet, or its rows of cells, are patches, and their nodes have random owners
    const int n = 4;
    Surfaces s(3);
    s.pairs[0].slave = s.sheet(n, -1, same, 1);
    const Side slave(3, s.pairs[0].slave, s.nodes.X);
    Ranked ranked;
    std::vector<std::vector<Index>>& rank = ranked.rank;
    rank.resize(1);
    std::vector<std::vector<Index>> facets_at(s.nodes.X.size());
    std::vector<Index> of_cell(static_cast<std::size_t>(n * n));
    std::iota(of_cell.begin(), of_cell.end(), 0);
    std::shuffle(of_cell.begin(), of_cell.end(), random);
    for (Index f = 0; f < slave.facets(); ++f) {
      const Index cell = f / 2;
      rank[0].push_back(of_cell[scene % 2 == 0 ? cell : cell / n]);
    }
    for (Index f = 0; f < slave.facets(); ++f)
      for (int v = 0; v < 3; ++v) facets_at[slave.facet(f).node[v]].push_back(f);
    Cover all;
    all.cells.assign(slave.facets(), {Cell{}});
    std::vector<Index>& owner = ranked.owner;
    ranked.pair.assign(s.nodes.X.size(), 0);
    for (const auto& facets : facets_at) owner.push_back(rank[0][facets[random() % facets.size()]]);
    std::vector<char> taken(s.nodes.X.size());
    for (char& t : taken) t = random() % 8 == 0;
    const auto lacking = [&] {
      std::vector<char> lacks(slave.facets(), 1);
      const auto has = [&](Index f) {
        const auto& node = slave.facet(f).node;
        return std::any_of(node.begin(), node.begin() + 3,
                           [&](Index i) { return !taken[i] && owner[i] == rank[0][f]; });
      };
      for (Index f = 0; f < slave.facets(); ++f)
        for (int v = 0; v < 3; ++v)
          for (Index g : facets_at[slave.facet(f).node[v]])
            if (rank[0][g] == rank[0][f] && has(g)) lacks[f] = 0;
      return lacks;
    };
    const std::vector<char> before = lacking();
    const std::vector<Index> first = owner;
    const Sides of{s.nodes, {slave}, {slave}, {all}};
    spare(
        of, Ways(of, rank), [&](std::size_t, Index, Index i) { return !taken[i]; }, ranked);
    const std::vector<char> after = lacking();
    for (std::size_t f = 0; f < before.size(); ++f) EXPECT_LE(after[f], before[f]) << scene;
    for (std::size_t i = 0; i < owner.size(); ++i) {
      moved += owner[i] != first[i];
      if (taken[i]) {
        EXPECT_EQ(owner[i], first[i]);
      }
    }
    lacked += std::count(before.begin(), before.end(), 1);
    lack += std::count(after.begin(), after.end(), 1);
  }
  EXPECT_LT(lack, lacked / 20);  // those of which all nodes are taken
  EXPECT_GT(moved, 3000);
}

TEST(Ownership, LawsOverSheetsWithStepsAndEndsDependOnNoRing) {
  std::mt19937 random(5);
  const auto within = [&](Real a, Real b) {
    return std::uniform_real_distribution<Real>(a, b)(random);
  };
  int posed = 0;
  for (int k = 0; k < 800; ++k) {
    Surfaces s(3);
    const int n = 2 + static_cast<int>(random() % 4);
    const Real bend = within(0, 0.3), aside = 0.3 / n;
    s.pairs[0].slave = s.sheet(
        n, -1,
        [&](const Vec3& x) {
          return Vec3(x[0] + within(-aside, aside), x[1] + within(-aside, aside),
                      bend * x[0] * x[0]);
        },
        2);
    Surface& master = s.pairs[0].master;
    master.labels = {1};
    for (int sheets = 2 + static_cast<int>(random() % 4); sheets > 0; --sheets) {
      const Vec3 at(within(-.2, .9), within(-.2, .9), within(-.15, .02));
      const Real wide = within(.1, 1), deep = within(.1, 1), tx = within(-.3, .3),
                 ty = within(-.3, .3);
      const auto place = [&](const Vec3& x) {
        return Vec3(at + Vec3(wide * x[0], deep * x[1], tx * x[0] + ty * x[1]));
      };
      append(master, s.sheet(1 + static_cast<int>(random() % 3), 1, place, 1));
    }
    try {
      const Mortar mortar = s.mortar();
      for (const SlaveNode& node : mortar.nodes()) EXPECT_GT(node.weight, 0) << k;
      ++posed;
    } catch (const IllegalInput&) {  // where nothing faces the pair
    }
  }
  EXPECT_GT(posed, 750);
}

TEST(Ownership, LawsOfTwoPairsDependOnNoRing) {
  for (int blocks : {6, 24}) {
    const Mortar mortar = ring(blocks, 0.1).mortar();
    Index of_pair[2] = {0, 0};
    for (const SlaveNode& node : mortar.nodes()) ++of_pair[node.pair];
    EXPECT_EQ(of_pair[0], blocks);      // the corners behind
    EXPECT_EQ(of_pair[1], 2 * blocks);  // those in front, and the outer ones
    EXPECT_LT(error_of_inverse(mortar), 1e-10);
  }
}

TEST(Ownership, LawsOfFacesThatMeetDependOnNoRing) {
  std::mt19937 random(1);
  int refused = 0;
  for (int k = 0; k < 2000; ++k) {
    const Box box(random, 1 + k % 3);
    Surfaces s = box.surfaces(1, k % 4 < 2);
    if (k % 2) s.nodes.before = box.surfaces(0, k % 4 < 2).nodes.X;
    try {
      const Mortar mortar = s.mortar();
      for (const SlaveNode& node : mortar.nodes()) EXPECT_GT(node.weight, 0);
      EXPECT_LT(
          (mortar.relative() * Vector::Ones(mortar.relative().cols())).lpNorm<Eigen::Infinity>(),
          1e-9)
          << k;
      if (k % 2 == 0) {
        EXPECT_NEAR(pressed(mortar, s), covered(s), 1e-9) << k;
      }
      EXPECT_LT(error_of_inverse(mortar), 1e-10);
    } catch (const IllegalInput&) {  // where nothing faces a pair
      ++refused;
    }
  }
  EXPECT_LT(refused, 500);
}
