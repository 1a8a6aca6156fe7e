#include "core/multigrid/aggregation.h"

#include <gtest/gtest.h>

#include "../refusal.h"
#include "scene_in_blocks.h"

using namespace frictioncg;
using namespace frictioncg::test;

namespace {

/// A chain of n rows, 2 x 2 blocks; `weak` couples i and i + 1 where i % 4 == 3.
SymmetricBlocks<2> chain(Index n, float weak) {
  SymmetricBlocks<2> A;
  for (Index i = 0; i < n; ++i) {
    if (i > 0) {
      A.col.push_back(i - 1);
      const float a = i % 4 == 0 ? weak : 1;
      for (float e : {-a, 0.0f, 0.0f, -a}) A.value.push_back(e);
    }
    A.row.push_back(Index(A.col.size()));
    for (float e : {2.0f, 0.0f, 0.0f, 2.0f}) A.diagonal.push_back(e);
  }
  return A;
}

}  // namespace

TEST(Aggregation, EveryRowBelongsToOneConnectedAggregate) {
  const SymmetricBlocks<2> A = chain(31, 1);
  const Aggregates a = aggregate(make_graph(A), coupling_strength(A), {0, 1});
  std::vector<Index> members(a.count, 0);
  for (Index i = 0; i < 31; ++i) {
    ASSERT_GE(a.of[i], 0);
    ASSERT_LT(a.of[i], a.count);
    if (i > 0 && a.of[i] != a.of[i - 1]) {
      EXPECT_EQ(members[a.of[i]], 0);  // a chain: consecutive
    }
    ++members[a.of[i]];
  }
  for (Index size : members) EXPECT_GE(size, 2);
}

TEST(Aggregation, DoesNotCrossWeakCouplingsUnlessTooFewRowsWouldMeet) {
  const SymmetricBlocks<2> A = chain(32, 0.01f);
  const BlockGraph graph = make_graph(A);
  const Aggregates a = aggregate(graph, coupling_strength(A), {0.1f, 1});
  for (Index i = 4; i < 32; i += 4) EXPECT_NE(a.of[i], a.of[i - 1]);
  const Aggregates b = aggregate(graph, coupling_strength(A), {0.1f, 10});
  EXPECT_LE(b.count, aggregate(graph, coupling_strength(A), {0, 1}).count);
}

TEST(Aggregation, ARowWithoutNeighboursIsItsOwnAggregate) {
  SymmetricBlocks<2> A;
  A.row = {0, 0, 0};
  A.diagonal.assign(8, 1);
  const Aggregates a = aggregate(make_graph(A), coupling_strength(A), {0.1f, 4});
  EXPECT_EQ(a.count, 2);
  EXPECT_NE(a.of[0], a.of[1]);
}

TEST(NodeBlocks, HoldEveryDofOnceAndKnowContactNodes) {
  const SceneInBlocks s(cube_of(3));
  const NodeBlocks& b = s.blocks;
  std::vector<Index> hits(b.slots(), 0);
  for (Index p = 0; p < s.system->dofs(); ++p) {
    EXPECT_EQ(b.dof[b.slot[p]], p);
    ++hits[b.slot[p]];
    EXPECT_EQ(p >= s.system->interior(),
              std::binary_search(b.contact.begin(), b.contact.end(), b.slot[p] / 3));
  }
  for (Index k = 0; k < b.slots(); ++k) EXPECT_EQ(hits[k], b.dof[k] >= 0);
}

TEST(BlockIndex, HoldsUpToTheLargestIndexAndRefusesByNameBeyond) {
  EXPECT_EQ(to_block_index(2147483647u), 2147483647);
  const std::string text = refusal([] { to_block_index(2147483648u); });
  for (const char* word : {"2147483648 blocks", "2^31 - 1", "multigrid", "method=\"GCX\""})
    EXPECT_TRUE(names(text, word)) << word;
}

TEST(RigidModes, AreTheKernelOfElasticityInLocalFrames) {
  for (int d : {2, 3}) {
    SparseOptions o;
    o.d = d;
    o.cells = {4, 4, 3};
    o.clamp_side = false;
    o.tilt = 0.5;
    o.mu_ratio = d == 3 ? 2 : 1;
    const SceneInBlocks s(o);
    EXPECT_EQ(s.modes.cols(), d == 2 ? 3 : 6);
    EXPECT_LT((s.system->entries() * s.modes).norm(),
              1e-12 * s.system->entries().norm() * s.modes.norm());
  }
}
