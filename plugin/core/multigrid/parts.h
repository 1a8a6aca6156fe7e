#pragma once
#include "threads.h"

namespace frictioncg {

/// The rows of a symmetric matrix in an order by which threads share sweeps: first leaves, without
/// entries between them, then, stage by stage, half as many separators, each of two tasks of the
/// stage before. What a row has below the diagonal belongs to its own task or to those that it
/// separates: a sweep reads and writes no row of another task of its stage, and gives the same on
/// any number of threads.
struct Parts {
  std::vector<Index> first;                                              ///< tasks + 1, their rows
  Index leaves() const { return static_cast<Index>(first.size()) / 2; }  ///< a power of 2

  /// work(first row, end) for each task, the leaves first
  template <class Work>
  void upwards(const Work& work) const {
    for (Index stage = 0, tasks = leaves(); tasks > 0; stage += tasks, tasks /= 2)
      of(stage, tasks, work);
  }
  /// The same, the leaves last
  template <class Work>
  void downwards(const Work& work) const {
    for (Index tasks = 1; tasks <= leaves(); tasks *= 2) of(2 * (leaves() - tasks), tasks, work);
  }

 private:
  template <class Work>
  void of(Index stage, Index tasks, const Work& work) const {
    side_by_side(tasks, [&](Index k) { work(first[stage + k], first[stage + k + 1]); });
  }
};

/// Nested dissection: rows are halved by their places, and of two halves the one gives the rows
/// that have entries with the other to the separator.
class Dissection {
 public:
  /// place: rows x dimension, at the places of the rows or near them
  explicit Dissection(const Eigen::MatrixXd& place);

  /// Entry (i, j) may not be 0.
  void couple(Index i, Index j) {
    const unsigned apart = leaf_[i] ^ leaf_[j];
    if (apart == 0) return;
    unsigned char height = 1;
    while (apart >> height) ++height;
    const Index beyond = leaf_[i] > leaf_[j] ? i : j;
    height_[beyond] = std::max(height_[beyond], height);
  }
  /// number (rows): which row each becomes.
  Parts numbered(std::vector<Index>& number) const;

 private:
  void halve(const Eigen::MatrixXd& place, Index* begin, Index* end, unsigned leaf, Index depth);

  Index depth_ = 0;
  std::vector<unsigned char> leaf_;    ///< of each row, a bit a halving
  std::vector<unsigned char> height_;  ///< of its separator, 0: of none
};

}  // namespace frictioncg
