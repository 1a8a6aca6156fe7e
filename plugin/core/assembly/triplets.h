#pragma once
#include "types.h"

namespace frictioncg {

/// A matrix as a finite-element code holds it: triplets in any order, Dirichlet rows included.
struct Triplets {
  Index n = 0;
  std::size_t size = 0;
  const Index* i = nullptr;
  const Index* j = nullptr;
  const Real* a = nullptr;
  Index base = 0;     ///< index of the first row: 0 or 1
  bool half = false;  ///< only one triangle is stored
  /// n, or null: of a part of a matrix, whose rows are whole; others are not checked.
  const char* whole = nullptr;

  Index row(std::size_t k) const { return i[k] - base; }
  Index col(std::size_t k) const { return j[k] - base; }
  /// n, or null: of one process's part, the rows that no other one judges.
  const char* owned = nullptr;

  bool is_owned(Index row) const { return !owned || owned[row] != 0; }
  bool is_whole(Index row) const { return !whole || whole[row] != 0; }
};

/// Calls visit(row, column, value) for each entry that is not 0, of both triangles.
template <class Visit>
void for_each_entry(const Triplets& A, const Visit& visit) {
  for (std::size_t k = 0; k < A.size; ++k) {
    if (A.a[k] == 0) continue;
    visit(A.row(k), A.col(k), A.a[k]);
    if (A.half && A.row(k) != A.col(k)) visit(A.col(k), A.row(k), A.a[k]);
  }
}

}  // namespace frictioncg
