#pragma once
#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace frictioncg {

using Real = double;
using Index = int;
using Vector = Eigen::VectorXd;
using DenseMatrix = Eigen::MatrixXd;
using Matrix = Eigen::SparseMatrix<Real, Eigen::RowMajor, Index>;  ///< both halves, sorted rows

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
