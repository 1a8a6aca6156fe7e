#pragma once
#include "freefem.h"

#include "../core/assembly/triplets.h"

namespace frictioncg {

/// A script's matrix A, copied, and beside it A - S.
class Stiffened {
 public:
  /// S (n x n): symmetric.
  Stiffened(const Triplets& A, Matrix S)
      : view_(A), i_(A.i, A.i + A.size), j_(A.j, A.j + A.size), a_(A.a, A.a + A.size), S_(S) {
    for (Index r = 0; r < S_.rows(); ++r)
      for (Matrix::InnerIterator e(S_, r); e; ++e) {
        if (A.half && e.col() > r) continue;
        i_.push_back(r + A.base);
        j_.push_back(e.col() + A.base);
        a_.push_back(-e.value());
      }
  }
  Triplets plain() const { return view(view_.size); }
  Triplets less() const { return view(a_.size()); }
  /// b of A u = b at u = U, for A - S.
  Vector load(const Vector& b, const Vector& U) const { return b - S_ * U; }
  /// S v
  Vector force(const Vector& v) const { return S_ * v; }

 private:
  Triplets view(std::size_t size) const {
    Triplets t = view_;
    t.size = size;
    t.i = i_.data();
    t.j = j_.data();
    t.a = a_.data();
    return t;
  }

  Triplets view_;
  std::vector<Index> i_, j_;
  std::vector<Real> a_;
  Matrix S_;
};

}  // namespace frictioncg
