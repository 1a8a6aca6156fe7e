#pragma once
#include "freefem.h"

#include <sstream>

#include "../core/assembly/local_system.h"

namespace frictioncg {

/// A view of the script's matrix. Its triplets are read as they lie: sorting them, as FreeFEM's own
/// CSR(), CSC() and COO() do in place, would invalidate a factorization that the script holds.
inline Triplets triplets(Matrice_Creuse<double>* A, long ndof) {
  HashMatrix<int, double>* H = A ? A->pHM() : nullptr;
  if (!H) throw IllegalInput("A is empty; assemble it first, as in matrix A = a(Vh, Vh)");
  if (H->n != ndof || H->m != ndof) {
    std::ostringstream s;
    s << "A is " << H->n << " x " << H->m << " but Vh has " << ndof
      << " degrees of freedom; assemble A on the present Vh";
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
  return t;
}

/// Refuses a script's vector that is not finite, or not of the size of the space.
inline void check_vector(const Vector& v, const char* name, long ndof) {
  if (v.size() != ndof) {
    std::ostringstream s;
    s << name << " has " << v.size() << " entries but Vh has " << ndof
      << " degrees of freedom; was the mesh changed after " << name << " was computed?";
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
