// The order of rows by which threads share sweeps.
#include "scene_in_blocks.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace frictioncg::test {

namespace {

/// The rows of a plate of points, coupled where they lie beside each other, and which row each
/// becomes.
struct Plate {
  static constexpr Index n = 64;
  Eigen::MatrixXd place{n * n, 2};
  std::vector<std::pair<Index, Index>> couplings;
  std::vector<Index> number;
  Parts parts;

  Plate() {
    for (Index i = 0; i < n * n; ++i) place.row(i) << i % n, 2 * (i / n);
    for (Index i = 0; i < n * n; ++i)
      for (Index step : {1, n - 1, n, n + 1})
        if (i + step < n * n && std::abs(i % n - (i + step) % n) < 2)
          couplings.emplace_back(i, i + step);
    Dissection halves(place);
    for (const auto& [i, j] : couplings) halves.couple(i, j);
    parts = halves.numbered(number);
  }
  Index task_of(Index row) const {
    return Index(std::upper_bound(parts.first.begin(), parts.first.end(), row) -
                 parts.first.begin()) -
           1;
  }
};

}  // namespace

TEST(Parts, HoldEachRowOnceInTheOrderOfTheirTasks) {
  const Plate plate;
  std::vector<Index> sorted = plate.number;
  std::sort(sorted.begin(), sorted.end());
  for (Index i = 0; i < Index(sorted.size()); ++i) EXPECT_EQ(sorted[i], i);
  EXPECT_EQ(plate.parts.leaves(), 8);
  ASSERT_EQ(plate.parts.first.size(), 16u);
  EXPECT_EQ(plate.parts.first.back(), Plate::n * Plate::n);
  // leaves are equal but for what separators take of them: a line of the shorter side at each cut
  for (Index k = 0; k < 8; ++k)
    EXPECT_NEAR(plate.parts.first[k + 1] - plate.parts.first[k], 512, 3 * 64);
  EXPECT_LE(plate.parts.first[15] - plate.parts.first[14], Plate::n);
}

TEST(Parts, OfOneStageHaveNoEntriesBetweenThemAndSeparateOnlyTheirOwn) {
  const Plate plate;
  for (const auto& [i, j] : plate.couplings) {
    Index low = plate.task_of(std::min(plate.number[i], plate.number[j]));
    const Index high = plate.task_of(std::max(plate.number[i], plate.number[j]));
    // task k of a stage is one of the two below task k/2 of the next
    for (Index stage = 0, tasks = 8; low < high && tasks > 1; stage += tasks, tasks /= 2)
      if (low < stage + tasks) low = stage + tasks + (low - stage) / 2;
    EXPECT_EQ(low, high) << i << " " << j;
  }
}

TEST(Parts, GoUpwardsAndDownwardsOverAllRows) {
  const Plate plate;
  const Threads one(1);
  std::vector<Index> up, down;
  plate.parts.upwards([&](Index first, Index end) {
    for (Index i = first; i < end; ++i) up.push_back(i);
  });
  plate.parts.downwards([&](Index first, Index) { down.push_back(first); });
  for (Index i = 0; i < Index(up.size()); ++i) EXPECT_EQ(up[i], i);
  EXPECT_EQ(up.size(), plate.number.size());
  EXPECT_EQ(down.size(), 15u);
  EXPECT_EQ(down.front(), plate.parts.first[14]);
}

TEST(Parts, OfFewRowsAreOne) {
  Dissection halves(Eigen::MatrixXd::Random(900, 3));
  std::vector<Index> number;
  EXPECT_EQ(halves.numbered(number).leaves(), 1);
  for (Index i = 0; i < 900; ++i) EXPECT_EQ(number[i], i);
}

TEST(SideBySide, ThrowsWhatATaskThrows) {
  for (Index threads : {1, 2}) {
    const Threads given(threads);
    std::vector<int> done(100, 0);
    with_threads([&] { side_by_side(100, [&](Index k) { done[k] = 1; }); });
    EXPECT_EQ(std::count(done.begin(), done.end(), 1), 100);
    const auto fail = [](Index k) {
      if (k == 5) throw IllegalInput("five");
    };
    EXPECT_THROW(with_threads([&] { side_by_side(8, fail); }), IllegalInput);
    EXPECT_THROW(with_threads([&] { fail(5); }), IllegalInput);
  }
}

TEST(SideBySide, TasksShareTasksOfTheirOwn) {
  const Threads two(2);
  std::vector<std::array<int, 10>> done(2);
  with_threads([&] {
    side_by_side(2, [&](Index k) { side_by_side(10, [&](Index j) { done[k][j] = 1; }); });
  });
  for (const auto& tasks : done) EXPECT_EQ(std::count(tasks.begin(), tasks.end(), 1), 10);
}

TEST(SideBySide, TakesThreads) {
  if (!omp_in_parallel) GTEST_SKIP() << "compiled without OpenMP";
  const Threads two(2);
  // each waits for the other
  std::atomic<int> met{0};
  with_threads([&] {
    side_by_side(2, [&](Index) {
      ++met;
      while (met < 2) std::this_thread::yield();
    });
  });
  EXPECT_EQ(met, 2);
}

TEST(SumOfRanges, IsTheSameOnAnyNumberOfThreads) {
  const Index n = 100000;
  const Vector x = Vector::Random(n);
  std::vector<Real> sums;
  for (Index threads : {1, 2, 3}) {
    const Threads given(threads);
    with_threads([&] {
      sums.push_back(sum_of_ranges(n, [&](Index first, Index end) {
        EXPECT_LT(end - first, n / 2);
        return x.segment(first, end - first).sum();
      }));
    });
    EXPECT_EQ(sums.back(), sums.front());
  }
  EXPECT_NEAR(sums.front(), x.sum(), 1e-12 * n);
  EXPECT_EQ(sum_of_ranges(0, [](Index first, Index end) { return end - first; }), 0);
}

TEST(Hierarchy, GivesTheSameOnAnyNumberOfThreads) {
  std::vector<Vector> z, Az;
  for (Index threads : {1, 2, 3}) {
    const Threads given(threads);
    with_threads([&] {
      SceneInBlocks s(cube_of(14));
      EXPECT_EQ(s.blocks.parts.leaves(), 4);
      std::vector<char> fixed(s.system->contact_dofs(), 0);
      for (std::size_t c = 0; c < fixed.size(); c += 2) fixed[c] = 1;
      s.hierarchy->truncate(fixed, {});
      const Vector r = Vector::LinSpaced(s.system->dofs(), 1, 7).array().sin();
      s.hierarchy->apply(r, z.emplace_back());
      EXPECT_TRUE(s.hierarchy->multiply(r, Az.emplace_back()));
      EXPECT_LT((Az.back() - s.system->entries() * r).norm(), 1e-12 * Az.back().norm());
    });
  }
  for (const std::vector<Vector>& all : {z, Az})
    for (const Vector& v : all) EXPECT_EQ((v - all.front()).lpNorm<Eigen::Infinity>(), 0);
}

}  // namespace frictioncg::test
