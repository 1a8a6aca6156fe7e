#include "multigrid/parts.h"

namespace frictioncg {

namespace {

constexpr Index most_halvings = 3;  ///< more of them leave too much to separators
constexpr Index least_rows = 500;  ///< of a leaf: a sweep over them takes far longer than a meeting

}  // namespace

Dissection::Dissection(const Eigen::MatrixXd& place)
    : leaf_(place.rows(), 0), height_(place.rows(), 0) {
  const Index rows = static_cast<Index>(place.rows());
  while (depth_ < most_halvings && rows >> (depth_ + 1) >= least_rows) ++depth_;
  std::vector<Index> row(rows);
  std::iota(row.begin(), row.end(), 0);
  halve(place, row.data(), row.data() + rows, 0, depth_);
}

/// Across the longest side, by the middle row.
void Dissection::halve(const Eigen::MatrixXd& place, Index* begin, Index* end, unsigned leaf,
                       Index depth) {
  if (depth == 0) {
    for (const Index* row = begin; row < end; ++row) leaf_[*row] = static_cast<unsigned char>(leaf);
    return;
  }
  Eigen::RowVectorXd least = place.row(*begin), most = least;
  for (const Index* row = begin; row < end; ++row) {
    least = least.cwiseMin(place.row(*row));
    most = most.cwiseMax(place.row(*row));
  }
  Eigen::Index side;
  (most - least).maxCoeff(&side);
  Index* const middle = begin + (end - begin) / 2;
  std::nth_element(begin, middle, end, [&](Index i, Index j) {
    return std::make_pair(place(i, side), i) < std::make_pair(place(j, side), j);
  });
  halve(place, begin, middle, 2 * leaf, depth - 1);
  halve(place, middle, end, 2 * leaf + 1, depth - 1);
}

Parts Dissection::numbered(std::vector<Index>& number) const {
  const Index leaves = 1 << depth_;
  Parts parts{std::vector<Index>(2 * leaves, 0)};
  const auto task = [&](std::size_t i) {
    // 2^h times fewer tasks from stage h on than leaves: 2 leaves - 2 leaves/2^h before them
    return 2 * leaves - (2 * leaves >> height_[i]) + (leaf_[i] >> height_[i]);
  };
  for (std::size_t i = 0; i < leaf_.size(); ++i) ++parts.first[task(i) + 1];
  std::partial_sum(parts.first.begin(), parts.first.end(), parts.first.begin());
  std::vector<Index> next = parts.first;
  number.resize(leaf_.size());
  for (std::size_t i = 0; i < leaf_.size(); ++i) number[i] = next[task(i)]++;
  return parts;
}

}  // namespace frictioncg
