// Which dofs of a matrix Dirichlet conditions hold.
#include <gtest/gtest.h>

#include "core/assembly/dirichlet.h"

using namespace frictioncg;

namespace {

struct Entry {
  Index i, j;
  Real a;
};

struct Elastic {
  Elastic(Index n, const std::vector<Entry>& entries, bool half_stored = false)
      : size(n), half(half_stored) {
    for (const Entry& e : entries) i.push_back(e.i), j.push_back(e.j), a.push_back(e.a);
  }
  Triplets triplets() const { return {size, a.size(), i.data(), j.data(), a.data(), 0, half}; }
  std::vector<Index> held(const std::vector<ContactPoint>& points = {}) const {
    const Dirichlet dirichlet(triplets(), dofs_of(points));
    std::vector<Index> dofs;
    for (Index k = 0; k < dirichlet.size(); ++k) dofs.push_back(dirichlet.dof(k));
    return dofs;
  }
  Index size;
  bool half;
  std::vector<Index> i, j;
  std::vector<Real> a;
};

/// A chain of two dofs of stiffness 100 with a third that the last column and row couple.
Elastic chain(Real diagonal) {
  return {3,
          {{0, 0, 200},
           {0, 1, -100},
           {1, 0, -100},
           {1, 1, 200},
           {1, 2, -100},
           {2, 1, -100},
           {2, 2, diagonal}}};
}

using Dofs = std::vector<Index>;

}  // namespace

TEST(Dirichlet, ADiagonalBeyondEveryContrastOfStiffnessIsHeld) {
  EXPECT_EQ(chain(100).held(), Dofs());
  EXPECT_EQ(chain(1e10).held(), Dofs());
  EXPECT_EQ(chain(2e12).held(), Dofs{2});
  EXPECT_EQ(chain(1e30).held(), Dofs{2});
}

TEST(Dirichlet, ALargeDiagonalIsJudgedByItsColumnAsWellAsByItsRow) {
  // an elimination of the row alone leaves the column
  const Elastic A(2, {{0, 0, 2}, {0, 1, -1}, {1, 1, 1}});
  EXPECT_EQ(A.held(), Dofs{1});
  // of a half-stored matrix the row is the column
  EXPECT_EQ(Elastic(2, {{0, 0, 1.5}, {1, 0, -1}, {1, 1, 2}}, true).held(), Dofs());
}

TEST(Dirichlet, AHalfStoredRowOfTheIdentityIsHeldWhereItsZerosAreStored) {
  const std::vector<Entry> eliminated = {{0, 0, 2},  {1, 0, 0},  {1, 1, 1},
                                         {2, 0, -1}, {2, 1, -1}, {2, 2, 3}};
  EXPECT_EQ(Elastic(3, eliminated, true).held(), Dofs{1});
  // a diagonal that happens to be 1, above which nothing is stored, is a stiffness
  const std::vector<Entry> free = {{0, 0, 1}, {1, 0, 0.3}, {1, 1, 2}};
  EXPECT_EQ(Elastic(2, free, true).held(), Dofs());
}

TEST(Dirichlet, ASupportAtAContactPointIsNoSpring) {
  ContactPoint p;
  p.dof = {2, 3, -1};
  p.normal = {0, -1, 0};
  const Elastic A(4, {{0, 0, 2}, {0, 1, -1}, {1, 0, -1}, {1, 1, 2}, {2, 2, 5e5}, {3, 3, 1e30}});
  EXPECT_EQ(A.held({p}), Dofs{3});
  EXPECT_EQ(A.held(), (Dofs{2, 3}));
}

TEST(Dirichlet, AMassAtAContactPointIsNoSupportHoweverLittleCouplesIt) {
  ContactPoint p;
  p.dof = {0, 1, -1};
  p.normal = {0, -1, 0};
  const std::vector<Entry> rest = {{0, 2, 1e-9}, {2, 0, 1e-9}, {1, 2, 1e-9}, {2, 1, 1e-9},
                                   {2, 2, 100},  {2, 3, -50},  {3, 2, -50},  {3, 3, 100}};
  for (Real support : {1e12, 1e30}) {
    std::vector<Entry> entries = rest;
    entries.push_back({0, 0, 50});
    entries.push_back({1, 1, support});
    const Elastic A(4, entries);
    EXPECT_EQ(A.held({p}), Dofs{1});
    EXPECT_EQ(A.held(), (Dofs{0, 1}));
  }
}

TEST(Dirichlet, AZeroBesideAFreeDofTellsOfACouplingTakenOutWhateverAnotherBodyHas) {
  // dof 0 by tgv = -2; dof 5, of another body, by tgv = -1, whose column remains
  const Elastic A(6, {{0, 0, 1},
                      {0, 1, 0},
                      {1, 0, 0},
                      {1, 1, 2},
                      {1, 2, -1},
                      {2, 1, -1},
                      {2, 2, 2},
                      {3, 3, 2},
                      {3, 4, -1},
                      {4, 3, -1},
                      {4, 4, 2},
                      {4, 5, -1},
                      {5, 4, 0},
                      {5, 5, 1}});
  const Dirichlet dirichlet(A.triplets(), {});
  ASSERT_EQ(A.held(), (Dofs{0, 5}));
  EXPECT_EQ(dirichlet.data(0.1 * Vector::Unit(6, 5))[1], 0.1);
  EXPECT_THROW(dirichlet.data(0.1 * Vector::Unit(6, 0)), IllegalInput);
}

TEST(Dirichlet, OfARowThatAnotherProcessOwnsThatOneJudgesWhetherCouplingsAreThere) {
  const Elastic A(3, {{0, 0, 1}, {1, 1, 2}, {1, 2, -1}, {2, 1, -1}, {2, 2, 2}});
  const std::array<char, 3> all{1, 1, 1}, others{0, 1, 1};
  const Vector b = 0.1 * Vector::Unit(3, 0);
  Triplets part = A.triplets();
  part.owned = all.data();
  EXPECT_THROW(Dirichlet(part, {}).data(b), IllegalInput);
  part.owned = others.data();
  EXPECT_EQ(Dirichlet(part, {}).data(b)[0], 0.1);
}

TEST(Dirichlet, PrescribedDisplacementsAreTheLoadOverTheDiagonal) {
  const Elastic A = chain(1e30);
  const Dirichlet dirichlet(A.triplets(), {});
  EXPECT_DOUBLE_EQ(dirichlet.data((Vector(3) << 5, 6, 2e29).finished())[0], 0.2);
}

TEST(Dirichlet, DofsThatFollowAreHeldAsOthersSayAndHaveTheirDiagonals) {
  const Dirichlet part(chain(1e30).triplets(), {});
  const Vector diagonal = (Vector(5) << 200, 200, 1e30, 4, 5).finished();
  const Dirichlet all = part.with_more({0, 0, 1, 0, 1}, diagonal);
  EXPECT_EQ(part.size(), 1);
  ASSERT_EQ(all.size(), 2);
  EXPECT_EQ(all.dof(1), 4);
  EXPECT_EQ(all.number(4), 1);
  EXPECT_FALSE(all.holds(3));
  EXPECT_EQ(all.data((Vector(5) << 1, 1, 4e30, 7, 10).finished()),
            Vector((Vector(2) << 4, 2).finished()));
}
