#include "assembly/mortar/curvature.h"

namespace frictioncg::mortar {

namespace {

/// A joint that turns so many times as much as the joints beside it is a kink between straight
/// flanks, and no part of an arc. One of less than 10 degrees may be of an arc whose chords are
/// split in two: it is a kink where its flanks are straighter, and go on for longer.
constexpr Real kink = 4, flat_kink = 20;
constexpr Real rounding = 1e-6;  ///< turns by less are none: cosines tell 1e-8

/// Two chords alone may be an arc as well: a sector of a round body between planes of symmetry has
/// so few.
enum class Kink { none, of_two_chords, clear };

/// The kinks among the joints of a surface.
class Kinks {
 public:
  Kinks(const Side& side, const std::vector<Vec3>& X)
      : side_(side), X_(X), of_facet_(side.facets()) {
    for (std::size_t k = 0; k < side.joints.size(); ++k) {
      turn_.push_back(std::acos(std::clamp(side.joints[k].cosine, -1.0, 1.0)));
      for (Index f : side.joints[k].facet) of_facet_[f].push_back(static_cast<Index>(k));
    }
  }
  Kink at(Index k) const {
    const bool in_3D = side_.d == 3;  // two triangles to a chord, or more
    if (side_.joints[k].cosine < one_surface) return between(k, kink, in_3D ? 4 : 1, 1);
    return turn_[k] > rounding ? between(k, flat_kink, in_3D ? 6 : 3, in_3D ? 3 : 2) : Kink::none;
  }

 private:
  /// Whether both flanks turn by less than 1/`share` of joint k, over facets one after the other,
  /// `most` of them, or to an end of the surface that leaves at least `least` in all.
  Kink between(Index k, Real share, int most, std::size_t least) const {
    const auto& ends = side_.joints[k].facet;
    bool wide = false;
    const bool straight = std::all_of(ends.begin(), ends.end(), [&](Index f) {
      std::vector<Index> flank{f};
      for (std::size_t from = 0, layer = 1;; ++layer) {
        const std::size_t to = flank.size();
        for (; from < to; ++from)
          for (Index j : of_facet_[flank[from]]) {
            if (!side_.joints[j].goes_on || is_same_ridge(j, k)) continue;
            if (turn_[k] <= share * turn_[j]) return false;
            for (Index g : side_.joints[j].facet)
              if (std::find(flank.begin(), flank.end(), g) == flank.end()) flank.push_back(g);
          }
        if (flank.size() == to || layer == static_cast<std::size_t>(most)) {
          wide = wide || is_wide(flank, k);
          return flank.size() >= least;
        }
      }
    });
    return !straight ? Kink::none : wide ? Kink::clear : Kink::of_two_chords;
  }
  /// Whether a flank goes on behind the first of its facets, at joint k.
  bool is_wide(const std::vector<Index>& flank, Index k) const {
    if (side_.d == 2) return flank.size() > 1;
    constexpr Real further = 1.5;  // from the joint: chords of one strip end about as far from it
    const auto& [a, b] = side_.joints[k].vertex;
    const Vec3 along = (X_[b] - X_[a]).normalized();
    const auto reach = [&](Index f) {
      Real most = 0;
      for (int v = 0; v < 3; ++v)
        most = std::max(most, along.cross(X_[side_.facet(f).node[v]] - X_[a]).norm());
      return most;
    };
    return std::any_of(flank.begin(), flank.end(),
                       [&](Index f) { return reach(f) > further * reach(flank[0]); });
  }
  /// Joint k, or in 3D one that goes on along its line: between the same planes.
  bool is_same_ridge(Index j, Index k) const {
    if (j == k || side_.d == 2) return j == k;
    constexpr Real alike = 0.25;  // of the turn
    const auto& [a, b] = side_.joints[j].normal;
    const auto& [p, q] = side_.joints[k].normal;
    const Real most = alike * turn_[k];
    return ((a - p).norm() < most && (b - q).norm() < most) ||
           ((a - q).norm() < most && (b - p).norm() < most);
  }

  const Side& side_;
  const std::vector<Vec3>& X_;
  std::vector<Real> turn_;
  std::vector<std::vector<Index>> of_facet_;
};

bool has_clear_kinks(const Side& side, const std::vector<Vec3>& X) {
  const Kinks kinks(side, X);
  for (std::size_t k = 0; k < side.joints.size(); ++k)
    if (side.joints[k].goes_on && kinks.at(static_cast<Index>(k)) == Kink::clear) return true;
  return false;
}

/// Tells of each joint whether the surface goes on over it. It does not over the edges of the body,
/// nor over a kink between straight flanks, where it does not go on turning; over two chords alone
/// it does unless the other side has kinks.
std::vector<char> smooth_joints(const Side& side, const Side& other, const std::vector<Vec3>& X) {
  std::vector<char> smooth;
  bool flat = true;
  for (const Joint& joint : side.joints) {
    smooth.push_back(joint.goes_on);
    flat = flat && (!joint.goes_on || joint.cosine >= 1 - rounding * rounding / 2);
  }
  if (flat) return smooth;
  const Kinks kinks(side, X);
  std::optional<bool> among_kinks;
  for (std::size_t k = 0; k < smooth.size(); ++k) {
    const Kink found = smooth[k] ? kinks.at(static_cast<Index>(k)) : Kink::none;
    if (found == Kink::of_two_chords && !among_kinks) among_kinks = has_clear_kinks(other, X);
    if (found == Kink::clear || (found == Kink::of_two_chords && *among_kinks)) smooth[k] = false;
  }
  return smooth;
}

/// (n_a + n_b) / (1 + n_a.n_b)
Vec3 between(const Vec3& n_a, const Vec3& n_b) {
  const Real cosine = n_a.dot(n_b);
  return cosine < 0 ? Vec3(Vec3::Zero()) : Vec3((n_a + n_b) / (1 + cosine));
}

Mat3 cross(const Vec3& a) {
  Mat3 m;
  m << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return m;
}

/// Of e / |e|^2.
Mat3 slope_of_inverse(const Vec3& e) {
  const Real square = e.squaredNorm();
  return (Mat3::Identity() - 2 / square * e * e.transpose()) / square;
}

}  // namespace

Turns turns_of_normal(Index i, const Vec3& n, const std::vector<Index>& facets, const Side& side,
                      const std::vector<Vec3>& X, const std::vector<char>& smooth) {
  Vec3 sum = Vec3::Zero();
  Turns turns;  // first the derivatives of the sum
  const auto slope = [&](Index j) -> Mat3& {
    return turns.try_emplace(j, Mat3::Zero()).first->second;
  };
  // factor e/|e|^2 x other, whose sign without the factor is that of n_f
  const auto add = [&](const Vec3& e, const Vec3& other, Index j, const Vec3& n_f, Real factor) {
    const Vec3 term = (e / e.squaredNorm()).cross(other);
    const Real sign = term.dot(n_f) < 0 ? -factor : factor;
    sum += sign * term;
    const Mat3 by = -sign * cross(other) * slope_of_inverse(e);
    slope(j) += by;
    slope(i) -= by;
    return sign;
  };
  Index count = 0, last = -1, beside = -1;  // 2D: the last facet, and its other vertex
  for (Index f : facets) {
    const Vec3& n_f = side.planes[f].normal;
    if (n_f.dot(n) < sharp) continue;
    const auto& node = side.facet(f).node;
    const int v = position(side.facet(f), i);
    const Index j = node[(v + 1) % side.d], k = node[(v + 2) % side.d];
    const Vec3 e = X[j] - X[i], other = X[k] - X[i];
    ++count, last = f, beside = j;
    const Real sign =
        add(e, side.d == 2 ? Vec3(Vec3::UnitZ()) : Vec3(other / other.squaredNorm()), j, n_f, 1);
    if (side.d == 2) continue;
    const Mat3 by = sign * cross(e / e.squaredNorm()) * slope_of_inverse(other);
    slope(k) += by;
    slope(i) -= by;
  }
  for (std::size_t k = 0; k < side.joints.size() && side.d == 2 && count == 1; ++k) {
    const auto [f, g] = side.joints[k].facet;
    if (!is_smooth(side, k, smooth) || side.joints[k].vertex[0] != beside) continue;
    if (f != last && g != last) continue;
    const auto& node = side.facet(f == last ? g : f).node;
    const Index farther = node[0] == beside ? node[1] : node[0];
    add(X[farther] - X[i], Vec3::UnitZ(), farther, side.planes[last].normal, -1);
  }
  const Mat3 along = (Mat3::Identity() - n * n.transpose()) / sum.norm();
  for (auto& [j, by] : turns) by = along * by;
  return turns;
}

CurvedOffset::CurvedOffset(const Side& side, const Side& other, const std::vector<Vec3>& X,
                           const std::vector<Vec3>& reference)
    : side_(side),
      X_(X),
      smooth_joints_(smooth_joints(side, other, X)),
      smooth_(side, X, smooth_joints_),
      bow_(side.facets()),
      edge_(side.facets()),
      of_reference_(!reference.empty()),
      d_(side.d) {
  const auto set_bows = [&](const SmoothSide& smooth, const std::vector<Vec3>& at) {
    for (Index f = 0; f < side.facets(); ++f)
      for (int k = 0; k < edges_of_facet(d_); ++k) {
        const auto [p, q] = edge_ends(d_, k);
        const Vec3 e = at[side.facet(f).node[q]] - at[side.facet(f).node[p]];
        bow_[f][k] = (smooth.at(f, q).normal - smooth.at(f, p).normal).dot(e) / 2;
      }
  };
  if (of_reference_) {
    const Side rest = side.at_rest(X, reference);
    set_bows(SmoothSide(rest, reference, smooth_joints_), reference);
  } else {
    set_bows(smooth_, X);
  }
  for (Index f = 0; f < side.facets(); ++f)
    for (int k = 0; k < edges_of_facet(d_); ++k) {
      const auto [p, q] = edge_ends(d_, k);
      edge_[f][k] = bow_[f][k] * between(smooth_.at(f, p).normal, smooth_.at(f, q).normal);
    }
}

Vec3 CurvedOffset::at(Index facet, const Vec3& lambda) const {
  Vec3 delta = Vec3::Zero();
  for (int k = 0; k < edges_of_facet(d_); ++k) {
    const auto [a, b] = edge_ends(d_, k);
    delta += lambda[a] * lambda[b] * edge_[facet][k];
  }
  return delta;
}

Mat3 CurvedOffset::slopes(Index facet, const Vec3& lambda) const {
  Mat3 slopes = Mat3::Zero();
  for (int k = 0; k < edges_of_facet(d_); ++k) {
    const auto [a, b] = edge_ends(d_, k);
    slopes.col(a) += lambda[b] * edge_[facet][k];
    slopes.col(b) += lambda[a] * edge_[facet][k];
  }
  return slopes;
}

/// y.edge = q along,   along = y.(n_a + n_b) / (1 + n_a.n_b)
void CurvedOffset::add_slopes(Index facet, int k, const Vec3& y, Sloped& to, Bends& bends) const {
  const auto [p, q] = edge_ends(d_, k);
  const Index a = side_.facet(facet).node[p], b = side_.facet(facet).node[q];
  const Vec3 &n_a = smooth_.at(facet, p).normal, &n_b = smooth_.at(facet, q).normal;
  const Real cosine = n_a.dot(n_b);
  if (cosine < 0) return;
  const Vec3 e = X_[b] - X_[a], turn = n_b - n_a;
  const Real along = y.dot(n_a + n_b) / (1 + cosine), bow = bow_[facet][k] / (1 + cosine);
  const auto bend = [&](int v, const Vec3& by) {
    bends.try_emplace(smooth_.fan(facet, v), Vec3::Zero()).first->second += by;
  };
  bend(p, bow * (y - along * n_b));
  bend(q, bow * (y - along * n_a));
  if (of_reference_) return;  // and so is q
  bend(p, -along / 2 * e);
  bend(q, along / 2 * e);
  to.at(a) -= along / 2 * turn;
  to.at(b) += along / 2 * turn;
}

void CurvedOffset::add_slopes(const Bends& bends, Sloped& to) const {
  for (const auto& [fan, y] : bends)
    for (const auto& [j, by] : turns(fan)) to.at(j) += by.transpose() * y;
}

const Turns& CurvedOffset::turns(Index fan) const {
  const auto [at, is_new] = turns_.try_emplace(fan);
  if (is_new)
    at->second = turns_of_normal(smooth_.node(fan), smooth_.normal(fan), smooth_.facets(fan), side_,
                                 X_, smooth_joints_);
  return at->second;
}

}  // namespace frictioncg::mortar
