// Where the last answers of a history lead to.
#include <gtest/gtest.h>

#include "core/multigrid/past.h"
#include "scene_in_blocks.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

SceneInBlocks small() { return SceneInBlocks(cube_of(3)); }

}  // namespace

TEST(Past, WithoutAnAnswerItLeadsNowhereAndWithOneToThat) {
  const SceneInBlocks s = small();
  const Increment increment = s.posed.problem().increment;
  Past past;
  EXPECT_EQ(past.next(*s.system, increment).size(), 0);
  const Vector x = Vector::Random(s.system->dofs());
  past.add(increment, x);
  EXPECT_FALSE(past.has_direction());
  EXPECT_EQ(past.next(*s.system, increment), x);
  past.forget();
  EXPECT_EQ(past.next(*s.system, increment).size(), 0);
}

TEST(Past, GoesOnByTheShareByWhichLoadOrGapsGoOn) {
  const SceneInBlocks s = small();
  Increment one = s.posed.problem().increment, two = one, now = one;
  const Vector x1 = Vector::Random(s.system->dofs()), x2 = Vector::Random(s.system->dofs());
  for (bool by_gap : {false, true}) {
    Vector &a = by_gap ? two.gap : two.F, &b = by_gap ? now.gap : now.F;
    const Vector base = a, step = Vector::Random(a.size());
    a = base + step;
    b = base + 1.5 * step;
    Past past;
    past.add(one, x1);
    past.add(two, x2);
    EXPECT_TRUE(past.has_direction());
    EXPECT_LT((past.next(*s.system, now) - (x2 + 0.5 * (x2 - x1))).norm(), 1e-12 * x2.norm());
    b = base + 1000 * step;  // too far to tell
    EXPECT_LT((past.next(*s.system, now) - (x2 + 4 * (x2 - x1))).norm(), 1e-12 * x2.norm());
    a = b = base;
  }
}

TEST(Past, TheLastAnswerStandsWhereNothingHasChanged) {
  const SceneInBlocks s = small();
  const Increment increment = s.posed.problem().increment;
  const Vector x1 = Vector::Random(s.system->dofs()), x2 = Vector::Random(s.system->dofs());
  Past past;
  past.add(increment, x1);
  past.add(increment, x2);
  EXPECT_EQ(past.next(*s.system, increment), x2);
}

TEST(Past, WeighsLoadsByWhatResistsThem) {
  const SceneInBlocks s = small();
  Increment one = s.posed.problem().increment, two = one, now = one;
  const Vector step = Vector::Random(one.F.size()), turn = Vector::Random(one.F.size());
  two.F += step;
  now.F = two.F + turn;
  const Vector x1 = Vector::Random(s.system->dofs()), x2 = Vector::Random(s.system->dofs());
  Past past;
  past.add(one, x1);
  past.add(two, x2);
  const Vector energy = step.cwiseQuotient(s.system->weight);
  const Vector next = x2 + turn.dot(energy) / step.dot(energy) * (x2 - x1);
  EXPECT_LT((past.next(*s.system, now) - next).norm(), 1e-12 * next.norm());
}
