#pragma once
// Here once for all files that include this one: what nearly each of them uses of the library.
#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace frictioncg {

using Real = double;
using Index = int;
constexpr Real infinity = std::numeric_limits<Real>::infinity();
constexpr Real epsilon = std::numeric_limits<Real>::epsilon();
using Vector = Eigen::VectorXd;
using Vec3 = Eigen::Vector3d;  ///< 2D: third component 0
using DenseMatrix = Eigen::MatrixXd;
using Matrix = Eigen::SparseMatrix<Real, Eigen::RowMajor, Index>;  ///< both halves, sorted rows

/// Translations and rotations of a body.
constexpr Index rigid_components(int dimension) { return dimension == 2 ? 3 : 6; }

/// The arrays of a matrix: entry a[k] of row i lies in column col[k], row[i] <= k < row[i + 1].
struct Arrays {
  const Index *row, *col;
  const Real* a;
};
inline Arrays arrays_of(const Matrix& A) {
  return {A.outerIndexPtr(), A.innerIndexPtr(), A.valuePtr()};
}

/// Entries of a matrix in any order; those of one place add.
using EntryList = std::vector<Eigen::Triplet<Real, Index>>;
inline Matrix sparse(Index rows, Index columns, const EntryList& entries) {
  Matrix M(rows, columns);
  M.setFromTriplets(entries.begin(), entries.end());
  return M;
}

/// Each value once, in ascending order.
template <class T>
void sort_once(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// The input breaks a rule of the interface; what() is one sentence for the user.
struct IllegalInput : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Throws it, with the parts of the sentence in a row.
template <class... Part>
[[noreturn]] void refuse(const Part&... part) {
  std::ostringstream m;
  (m << ... << part);
  throw IllegalInput(m.str());
}

}  // namespace frictioncg
