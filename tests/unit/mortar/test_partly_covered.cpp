#include <gtest/gtest.h>

#include "core/assembly/mortar/clipping.h"
#include "surfaces.h"
#include "tied.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

constexpr Real exact = 1e-11;

bool at(Real a, Real b) { return std::abs(a - b) < 1e-13; }

/// A box in the directions across the interface, which is the plane x_up = 1.
struct Footprint {
  Vec3 low = Vec3::Zero(), high = Vec3::Ones();
};

/// Loads of a traction on the part of a facet outside of a footprint.
void add_traction_outside(const Scene& s, const Facet& facet, const Footprint& hidden,
                          const Vec3& traction, Vector& F) {
  const int d = s.d();
  s.bodies.add_traction(facet, traction, F);
  Polygon part = reference_facet(d);
  for (int c = 0; c + 1 < d; ++c)
    for (int side : {1, -1}) {
      Affine f;  // side (x_c - bound)
      const Real x0 = s.bodies.X[facet.node[0]][c];
      f.c = side * (x0 - (side > 0 ? hidden.low[c] : hidden.high[c]));
      for (int v = 1; v < d; ++v) f.g[v - 1] = side * (s.bodies.X[facet.node[v]][c] - x0);
      part = cut(part, f);
    }
  if (part.empty()) return;
  std::vector<QuadraturePoint> points;
  quadrature(part, points);
  const Real jacobian = plane_of(d, facet, s.bodies.X).measure / extent(reference_facet(d));
  for (const QuadraturePoint& p : points) {
    const Shape phi = shape_functions(d, s.bodies.quadratic, slave_coordinates(d, p.xi));
    for (int k = 0; k < nodes_of_facet(d, s.bodies.quadratic); ++k)
      F.segment(d * facet.node[k], d) -= jacobian * p.weight * phi[k] * traction.head(d);
  }
}

Eigen::Matrix3d stress(const MeshedBodies& bodies, const Eigen::Matrix3d& H) {
  const Eigen::Matrix3d strain = (H + H.transpose()) / 2;
  const Real E = bodies.E[0], nu = bodies.nu;
  return E * nu / ((1 + nu) * (1 - 2 * nu)) * strain.trace() * Eigen::Matrix3d::Identity() +
         E / (1 + nu) * strain;
}

/// The unit box below, a box with another footprint on it: u = H x in both, held at the bottom and
/// at the top, by tractions elsewhere.
Scene overlapping(int d, bool quadratic, std::array<int, 3> below, std::array<int, 3> above,
                  const Footprint& footprint, Real distortion, Real height = 1) {
  Scene s(d, quadratic);
  const int up = d - 1;
  s.bodies.add_box(below, [&](const Vec3& x) { return distorted(d, x, distortion, 0.4); });
  const Index first = static_cast<Index>(s.bodies.elements.size());
  s.bodies.add_box(above, [&](const Vec3& x) {
    Vec3 y = distorted(d, x, distortion, 1.9);
    for (int c = 0; c < up; ++c)
      y[c] = footprint.low[c] + y[c] * (footprint.high[c] - footprint.low[c]);
    y[up] = 1 + height * y[up];
    return y;
  });
  const auto on_plane = [&](const Vec3& x) { return at(x[up], 1); };
  Pair pair;
  pair.slave = {quadratic, {2}, s.bodies.boundary(on_plane, 2, first)};
  pair.master = {quadratic, {1}, s.bodies.boundary(on_plane, 1, 0, first)};
  s.pairs = {pair};
  s.start();
  const Eigen::Matrix3d H = some_gradient(d), sigma = stress(s.bodies, H);
  hold_linear(s, H, [&](const Vec3& x) { return at(x[up], 0) || at(x[up], 1 + height); });
  const auto load = [&](const Facet& f) {
    s.bodies.add_traction(f, sigma * plane_of(d, f, s.bodies.X).normal, s.load);
  };
  const auto on_side = [&](const Vec3& x) {
    return x[up] > 1e-9 && x[up] < 1 + height * (1 - 1e-9) && !on_plane(x);
  };
  for (const Facet& f : s.bodies.boundary(on_side)) load(f);
  for (const Facet& f : pair.slave.facets)
    add_traction_outside(s, f, Footprint(), -sigma.col(up), s.load);
  for (const Facet& f : pair.master.facets)
    add_traction_outside(s, f, footprint, sigma.col(up), s.load);
  return s;
}

}  // namespace

TEST(MortarPartlyCovered, FacetsAreCountedWhateverTheirCoveredShare) {
  for (Real reach : {0.3, 0.5, 0.7, 0.999, 1.0}) {
    Surfaces s(2);
    s.pairs[0].slave = s.sheet(1, -1, same, 2);
    s.pairs[0].master = s.sheet(2, 1, lifted(2, 0, 0, reach), 1);
    EXPECT_EQ(s.mortar().statistics().partly_covered, reach < 1) << reach;
  }
}

TEST(MortarPartlyCovered, UniformStressAcrossFootprintsThatDiffer) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (bool swapped : {false, true})
        for (Real shift : {0.0, 0.57}) {  // inside of the lower footprint, or overhanging
          Footprint footprint{Vec3(0.13 + shift, 0.21 - shift / 2, 0),
                              Vec3(0.87 + shift, 0.93 - shift / 2, 0)};
          Scene s = overlapping(d, quadratic, {5, 5, 2}, {4, 4, 2}, footprint, 0.2);
          if (swapped) std::swap(s.pairs[0].slave, s.pairs[0].master);
          const Mortar mortar = s.mortar();
          EXPECT_TRUE(shift == 0 && !swapped ? mortar.statistics().partly_covered == 0
                                             : mortar.statistics().partly_covered > 0);
          EXPECT_LT(error_of(s, solve_tied(s, mortar).u, some_gradient(d)), exact)
              << d << "D P" << 1 + quadratic << swapped << shift;
        }
}

TEST(MortarPartlyCovered, SliversOfAnySizeCarryTheirShare) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (Real sliver : {0.3, 3e-2, 1.1e-3, 0.9e-3, 1e-4, 1e-6, 1e-9, 1e-12}) {
        const Footprint footprint{Vec3(1. / 3 - sliver / 3, 1. / 3 - sliver / 5, 0),
                                  Vec3(2. / 3 + sliver / 4, 2. / 3 + sliver / 3, 0)};
        Scene s = overlapping(d, quadratic, {3, 3, 2}, {2, 2, 2}, footprint, 0);
        std::swap(s.pairs[0].slave, s.pairs[0].master);
        EXPECT_LT(error_of(s, solve_tied(s, s.mortar()).u, some_gradient(d)), exact)
            << d << "D P" << 1 + quadratic << " sliver " << sliver;
      }
}

TEST(MortarPartlyCovered, ASliverAloneIsSeenByTheVertexThatItReaches) {
  for (int d : {2, 3})
    for (bool first : {false, true})  // vertices of lower numbers
      for (Real sliver : {1e-4, 1e-7, 1e-10, 1e-13}) {
        Surfaces s(d);
        s.pairs[0].slave = s.sheet(1, -1, lifted(d, 0, 0, 1), 2);
        s.pairs[0].master = s.sheet(
            1, 1, lifted(d, -0.1, first ? sliver - 1 : 1 - sliver, first ? sliver : 2 - sliver), 1);
        const Mortar mortar = s.mortar();
        ASSERT_FALSE(mortar.nodes().empty()) << d << first << sliver;
        for (const SlaveNode& node : mortar.nodes()) {
          EXPECT_EQ(s.nodes.X[node.node][0], first ? 0 : 1) << sliver;
          EXPECT_NEAR(node.distance, 0.1, 1e-12) << sliver;
        }
        EXPECT_LT(DenseMatrix(mortar.relative()).cwiseAbs().maxCoeff(), d) << sliver;
      }
}

TEST(MortarPartlyCovered, AMasterInTheMiddleOfOneFacetIsFound) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (Real size : {0.3, 0.1, 1e-2}) {
        const Footprint footprint{Vec3(0.4, 0.3, 0), Vec3(0.4 + size, 0.3 + size, 0)};
        Scene s = overlapping(d, quadratic, {1, 1, 1}, {2, 2, 2}, footprint, 0, size);
        std::swap(s.pairs[0].slave, s.pairs[0].master);
        EXPECT_LT(error_of(s, solve_tied(s, s.mortar()).u, some_gradient(d)), exact)
            << d << "D P" << 1 + quadratic << " size " << size;
      }
}

TEST(MortarPartlyCovered, NodesWithNothingBeforeThemStayFree) {
  const Footprint footprint{Vec3(0, 0, 0), Vec3(0.3, 0.3, 0)};
  for (int d : {2, 3}) {
    Scene s = overlapping(d, true, {6, 6, 2}, {2, 2, 2}, footprint, 0);
    std::swap(s.pairs[0].slave, s.pairs[0].master);
    const Mortar mortar = s.mortar();
    const Matrix T = mortar.change_of_basis();
    for (const Facet& f : s.pairs[0].slave.facets)
      for (int v = 0; v < d; ++v) {
        const Index i = f.node[v];
        if (s.bodies.X[i].head(d - 1).maxCoeff() < 0.51) continue;
        EXPECT_EQ(T.row(i).nonZeros(), 1);
        for (const SlaveNode& node : mortar.nodes()) EXPECT_NE(node.node, i);
      }
  }
}

TEST(MortarPartlyCovered, LawsOfNodesBeyondTheMasterAreOfWhereItEnds) {
  const Real h = 0.25;
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (Real share : {0.004, 0.03, 0.06, 0.5, 0.97}) {  // of the facets there
        const Real end = 0.5 + share * h;
        Surfaces s(d, quadratic);
        s.pairs[0].slave = s.sheet(4, -1, lifted(d, 0.01), 2);
        const Index first = static_cast<Index>(s.nodes.X.size());
        s.pairs[0].master = s.sheet(
            5, 1,
            [=](const Vec3& x) {
              return Vec3(-0.2 + (end + 0.2) * x[0], d == 3 ? 1.4 * x[1] - 0.2 : 0, 0);
            },
            1);
        const Mortar mortar = s.mortar();
        Real farthest = 0, beyond = 0;
        for (std::size_t k = 0; k < mortar.nodes().size(); ++k) {
          Vec2 weight(0, 0), place(0, 0);  // of the slave and of the master
          for (Matrix::InnerIterator G(mortar.relative(), static_cast<Index>(k)); G; ++G) {
            weight[G.col() >= first] += G.value();
            place[G.col() >= first] += G.value() * s.nodes.X[G.col()][0];
          }
          place = place.cwiseQuotient(weight);
          EXPECT_NEAR(place[0], place[1], 1e-12);
          farthest = std::max(farthest, place[0]);
          beyond += s.nodes.X[mortar.nodes()[k].node][0] > end;
          EXPECT_NEAR(mortar.nodes()[k].distance, 0.01, 1e-12);
        }
        EXPECT_GE(beyond, d == 2 ? 1 : 4);
        const Real most = share < 0.05 && d == 2 ? 0.5 + 0.05 * h : end;
        EXPECT_NEAR(farthest, most, (d == 2 ? 1e-12 : 0.05) * h) << d << "D " << share;
        EXPECT_LT(error_of_inverse(mortar), 1e-12);
      }
}

TEST(MortarPartlyCovered, LawsBesideTheEndOfTheMasterHaveTheNormalThere) {
  const auto scene = [](Real end) {  // a slave that no motion lets slip
    Surfaces s(2);
    s.pairs[0].slave = s.sheet(
        4, -1, [](const Vec3& x) { return Vec3(x[0], 0.1 + 0.2 * std::pow(x[0], 3), 0); }, 2);
    s.pairs[0].master = s.sheet(1, 1, lifted(2, 0, -0.1, end), 1);
    return s.mortar();
  };
  const Mortar whole = scene(1.1), part = scene(0.65);
  ASSERT_EQ(part.nodes().size(), 4);
  Vec3 between = Vec3::Zero();
  for (Index i = 0; i < 4; ++i)
    between += part.relative().coeff(3, i) * whole.nodes()[static_cast<std::size_t>(i)].normal;
  EXPECT_GT((part.nodes()[3].normal - whole.nodes()[3].normal).norm(), 0.02);
  EXPECT_LT((part.nodes()[3].normal - between.normalized()).norm(), 1e-12);
}

TEST(MortarPartlyCovered, HeldFacetsBeyondAHoleOfTheMasterArePassedOnOnce) {
  // the master lies before the first and the last third of the slave; the last is held, and the
  // nodes of the first stand in for it, several for one facet
  for (int d : {2, 3}) {
    Surfaces s(d);
    s.pairs[0].slave = s.sheet(3, -1, same, 2);
    const Index first = static_cast<Index>(s.nodes.X.size());
    s.pairs[0].master = s.sheet(2, 1, lifted(d, 0, 0, 1. / 3), 1);
    append(s.pairs[0].master, s.sheet(2, 1, lifted(d, 0, 2. / 3), 1));
    for (Index i = 0; i < static_cast<Index>(s.nodes.X.size()); ++i)
      s.nodes.held.push_back(i < first && s.nodes.X[i][0] > 0.6 ? 7 : 0);
    const Mortar mortar = s.mortar();
    Vector unit(mortar.relative().rows());  // a traction 1
    for (std::size_t k = 0; k < mortar.nodes().size(); ++k)
      unit[Index(k)] = mortar.nodes()[k].weight;
    const Vector force = mortar.relative().transpose() * unit;
    EXPECT_NEAR(force.tail(force.size() - first).sum(), -2. / 3, 1e-14);
    Real beyond = 0;
    for (Index i = first; i < force.size(); ++i) beyond += s.nodes.X[i][0] > 0.6 ? force[i] : 0;
    EXPECT_NEAR(beyond, -1. / 3, 1e-14);
  }
}
