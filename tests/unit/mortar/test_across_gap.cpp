// Rows of the mortar of a body with both faces see none of its rotations, across a gap too.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "bodies.h"
#include "surfaces.h"

using namespace frictioncg;
using namespace frictioncg::mortar;
using namespace frictioncg::mortar::test;

namespace {

constexpr Real cell = 1 / 3.;

/// Two boxes, turned, whose faces are `gap` apart and a little uneven, the upper one slid along;
/// where `one`, they count as one body.
struct Faces {
  MeshedBodies bodies;
  std::vector<Pair> pairs{1};

  Faces(int d, bool quadratic, Real gap, bool swapped, bool one = true, Real slid = 0) {
    bodies.d = d;
    bodies.quadratic = quadratic;
    const int up = d - 1;
    const Vec3 n = d == 2 ? Vec3(-0.6, 0.8, 0) : Vec3(1, 2, 2) / 3;
    const Eigen::Matrix3d Q = Eigen::Quaterniond::FromTwoVectors(Vec3::Unit(up), n).matrix();
    std::array<int, 3> few{3, 3, 3}, more{4, 4, 3};
    bodies.add_box(few, [&](const Vec3& x) { return Vec3(Q * x); });
    const Index lower = static_cast<Index>(bodies.elements.size());
    bodies.add_box(more, [&](Vec3 x) {
      x[up] += 1 + gap * (1 + 0.2 * std::sin(5 * x[0] + 3 * x[1]) * (1 - x[up]));
      x[0] += slid;
      return Vec3(Q * x);
    });
    const auto near = [&](const Vec3& x) {
      const Real above = n.dot(x) - 1;
      return above > -0.1 && above < 1.3 * gap + 0.1;
    };
    pairs[0].slave.facets = bodies.boundary(near, 1, lower);
    pairs[0].master.facets = bodies.boundary(near, 2, 0, lower);
    pairs[0].slave.labels = {1};
    pairs[0].master.labels = {2};
    if (swapped) std::swap(pairs[0].slave, pairs[0].master);
    pairs[0].slave.quadratic = pairs[0].master.quadratic = quadratic;
    for (Facet& f : pairs[0].master.facets)
      if (one) f.behind = behind(f), f.one_body = true;
  }
  Mortar mortar() const { return Mortar({bodies.d, bodies.X, {}}, pairs); }

 private:
  Index behind(const Facet& f) const {
    for (const Element& e : bodies.elements) {
      const auto has = [&](Index i) { return std::find(e.begin(), e.end(), i) != e.end(); };
      if (!std::all_of(f.node.begin(), f.node.begin() + bodies.d, has)) continue;
      for (int v = 0; v <= bodies.d; ++v)
        if (!std::count(f.node.begin(), f.node.begin() + bodies.d, e[v])) return e[v];
    }
    return -1;
  }
};

/// The largest sum_l G_il (1, X_l - X_i), over the nodes.
Vec2 seen(const Mortar& m, const std::vector<Vec3>& X) {
  Vec2 worst = Vec2::Zero();
  for (std::size_t k = 0; k < m.nodes().size(); ++k) {
    Real sum = 0;
    Vec3 e = Vec3::Zero();
    for (Matrix::InnerIterator it(m.relative(), static_cast<Index>(k)); it; ++it) {
      sum += it.value();
      e += it.value() * (X[it.col()] - X[m.nodes()[k].node]);
    }
    worst = worst.cwiseMax(Vec2(std::abs(sum), e.norm()));
  }
  return worst;
}

}  // namespace

TEST(AcrossGap, NoRotationOfABodyWithBothFacesIsSeen) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true})
      for (bool swapped : {false, true})
        for (Real gap : {1e-6 * cell, 1e-3 * cell, 0.05 * cell}) {
          SCOPED_TRACE(std::to_string(d) + "D, gap " + std::to_string(gap));
          const Faces faces(d, quadratic, gap, swapped);
          const Mortar m = faces.mortar();
          ASSERT_GT(m.nodes().size(), 2u);
          EXPECT_LT(seen(m, faces.bodies.X).maxCoeff(), 1e-14);
          // the gap is that between the faces
          EXPECT_NEAR(m.nodes()[1].gap, gap, 0.3 * gap);
        }
}

TEST(AcrossGap, TwoBodiesAndWideGapsKeepTheirRows) {
  for (int d : {2, 3})
    for (const Faces& faces :
         {Faces(d, false, 1e-3 * cell, false, false), Faces(d, false, 1.6 * cell, false)}) {
      const Mortar m = faces.mortar();
      const Vec2 all = seen(m, faces.bodies.X);
      EXPECT_LT(all[0], 1e-14);
      EXPECT_GT(all[1], 0.7 * m.nodes()[0].gap);
      // within the faces: no column of a vertex behind
      for (Index i = 0; i < faces.bodies.nodes(); ++i) {
        const auto on = [&](const Surface& s) {
          return std::any_of(s.facets.begin(), s.facets.end(), [&](const Facet& f) {
            return std::count(f.node.begin(), f.node.end(), i) > 0;
          });
        };
        if (on(faces.pairs[0].slave) || on(faces.pairs[0].master)) continue;
        EXPECT_EQ((m.relative() * Vector::Unit(faces.bodies.nodes(), i)).norm(), 0);
      }
    }
}

TEST(AcrossGap, TheChangeOfBasisStillHasItsInverse) {
  for (int d : {2, 3})
    for (bool quadratic : {false, true}) {
      const Faces faces(d, quadratic, 1e-2 * cell, false);
      const Mortar m = faces.mortar();
      std::vector<char> held(faces.bodies.nodes(), 0);
      for (int holds = 0; holds < 2; ++holds) {
        EXPECT_LT(error_of_inverse(m, held), 1e-13);
        for (const Facet& f : faces.pairs[0].master.facets) held[f.node[0]] = held[f.behind] = 1;
      }
    }
}

TEST(AcrossGap, RowsGoOnFromElementToElementAndAsTheGapOpens) {
  const int steps = 400;
  const auto most = [&](const std::function<Faces(Real)>& at) {
    Real largest = 0;
    DenseMatrix last;
    for (int k = 0; k <= steps; ++k) {
      DenseMatrix now = at(k / Real(steps)).mortar().relative();
      // 1 where a node sees the master at one place; more where it leans on others
      now.array().colwise() /= (now.array().abs().rowwise().sum() / 2).eval();
      if (k > 0) largest = std::max(largest, (now - last).cwiseAbs().maxCoeff());
      last = now;
    }
    return largest;
  };
  for (int d : {2, 3}) {
    const Real slid = 0.3 * cell / steps, opened = 0.2 * cell / steps;
    const auto slides = [&](Real t) {
      return Faces(d, false, 0.05 * cell, false, true, (0.05 + 0.3 * t) * cell);
    };
    const auto opens = [&](Real t) { return Faces(d, false, 0.2 * t * cell, false); };
    EXPECT_LT(most(slides), 5 * slid / cell);
    EXPECT_LT(most(opens), 5 * opened / cell);
  }
}
