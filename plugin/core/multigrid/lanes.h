#pragma once
#include <cstddef>
#include <cstring>

namespace frictioncg {

// Four floats, or two doubles, in one register where the machine has such, by the compiler's own
// vectors.
using Four = float __attribute__((vector_size(16)));
using Pair = double __attribute__((vector_size(16)));

template <class Lanes, class T>
inline Lanes load(const T* p) {
  Lanes v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
template <class Lanes, class T>
inline void store(T* p, Lanes v) {
  std::memcpy(p, &v, sizeof v);
}

/// Row r of a block with rows of C
template <int C, class T>
inline T* row_of(T* a, int r) {
  return a + std::size_t(r) * C;
}

/// Six floats: the first four, and the last four.
struct Six {
  Four head, tail;

  static Six load(const float* p) {
    return {frictioncg::load<Four>(p), frictioncg::load<Four>(p + 2)};
  }
  void store(float* p) const {
    frictioncg::store(p, head);
    p[4] = tail[2];
    p[5] = tail[3];
  }
  void add(float factor, const Six& other) {
    head += factor * other.head;
    tail += factor * other.tail;
  }
};

/// The floats between the rows of a vector of B slots each: rows of three fill one register, whose
/// last entry means nothing where the vector is written, and is 0 where it is multiplied.
template <int B>
constexpr std::size_t stride = B == 3 ? 4 : B;

/// Row r of a 3 x 3 block, and a fourth entry that means nothing.
inline Four row_of_three(const float* a, int r) {
  if (r < 2) return load<Four>(row_of<3>(a, r));
  const Four v = load<Four>(a + 5);
  return Four{v[1], v[2], v[3], v[0]};
}

}  // namespace frictioncg
