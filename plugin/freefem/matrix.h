#pragma once
#include "freefem.h"

#include <sstream>
#include <string>

#include "../core/assembly/local_system.h"

namespace frictioncg {

/// The dofs of a call's space, or of its two spaces.
struct DofCount {
  long count = 0;
  long first = 0;  ///< of two spaces, those of the first

  /// "Vh has 72 degrees of freedom"; made when it is said, for nothing else needs its memory.
  std::string in_words() const {
    if (first == 0) return "Vh has " + std::to_string(count) + " degrees of freedom";
    return "V1 and V2 have " + std::to_string(first) + " + " + std::to_string(count - first) +
           " degrees of freedom";
  }
  /// How A comes to have as many.
  const char* assemble() const {
    return first == 0 ? "assemble A on the present Vh"
                      : "give the matrix of both bodies, A = [[A1, 0], [0, A2]], and b = [b1, b2]";
  }
};

inline DofCount dofs_of(long ndof) { return {ndof, 0}; }
inline DofCount dofs_of(long ndof1, long ndof2) { return {ndof1 + ndof2, ndof1}; }

[[noreturn]] inline void refuse_order(const DofCount& dofs) {
  throw IllegalInput("the blocks of A are in the other order: " + dofs.in_words() +
                     ", and A = [[A1, 0], [0, A2]] and b = [b1, b2] have those of V1, the space of "
                     "the slave, first");
}

/// Refuses the blocks of two bodies that come in the other order: nothing else would tell, where
/// the sizes add up. Couplings that the script has put between the bodies are none of it.
inline void refuse_other_order(const Triplets& A, const DofCount& dofs) {
  const long second = dofs.count - dofs.first;
  bool crosses_first = false, crosses_second = false;
  for (std::size_t k = 0; k < A.size; ++k) {
    if (A.a[k] == 0) continue;
    const long i = A.i[k] - A.base, j = A.j[k] - A.base;
    crosses_first = crosses_first || (i < dofs.first) != (j < dofs.first);
    crosses_second = crosses_second || (i < second) != (j < second);
  }
  if (crosses_first && !crosses_second) refuse_order(dofs);
}

/// A view of the script's matrix. Its triplets are read as they lie: sorting them, as FreeFEM's own
/// CSR(), CSC() and COO() do in place, would invalidate a factorization that the script holds.
inline Triplets triplets(Matrice_Creuse<double>* A, const DofCount& dofs) {
  HashMatrix<int, double>* H = A ? A->pHM() : nullptr;
  if (!H) throw IllegalInput("A is empty; assemble it first, as in matrix A = a(Vh, Vh)");
  if (H->n != dofs.count || H->m != dofs.count) {
    std::ostringstream s;
    s << "A is " << H->n << " x " << H->m << " but " << dofs.in_words() << "; " << dofs.assemble();
    throw IllegalInput(s.str());
  }
  Triplets t;
  t.n = H->n;
  t.size = H->nnz;
  t.i = H->i;
  t.j = H->j;
  t.a = H->aij;
  t.base = H->fortran;
  t.half = H->half > 0;
  if (dofs.first > 0 && 2 * dofs.first != dofs.count) refuse_other_order(t, dofs);
  return t;
}

/// Refuses a script's vector that is not finite, or not of the size of the space.
inline void check_vector(const Vector& v, const char* name, const DofCount& dofs) {
  if (v.size() != dofs.count) {
    std::ostringstream s;
    s << name << " has " << v.size() << " entries but " << dofs.in_words()
      << "; was the mesh changed after " << name << " was computed?";
    throw IllegalInput(s.str());
  }
  for (long i = 0; i < v.size(); ++i) {
    if (std::isfinite(v[i])) continue;
    std::ostringstream s;
    s << name << "[" << i << "] = " << v[i] << "; the entries of " << name << " must be finite";
    throw IllegalInput(s.str());
  }
}

}  // namespace frictioncg
