#pragma once
#include "freefem.h"

#include <algorithm>
#include <utility>

#include "../core/gradient/anderson.h"
#include "scene.h"

namespace frictioncg {

/// A step of Newton's method for bodies whose geometry is that of U. What is solved with A less the
/// symmetric stiffness S of the contact forces G'y, and with the gaps g of U, lacks to first order
/// in v = u - U
///
///   (A - S) u = b - S U + N v + G'y,     N = d(G'y)/dU - S
///   n.G u <= g + n.G U + R v,            R = dg/dU + n.G
///
/// which is added pass by pass, with the v that the passes before lead to: other loads and other
/// gaps for the factors at hand. The answer is certified on the laws of its pass; where u = U they
/// are those of the geometry at u. Far away from there passes that do not contract are not taken.
class NewtonStep {
 public:
  /// b, u_old: by all dofs; gaps: those of pairs are measured, not given.
  NewtonStep(const Scene& scene, const Vector& b, const Vector& u_old, const PointLaws& laws,
             bool gaps)
      : scene_(scene), b_(b), slip_from_(scene.slip_from(u_old)), laws_(laws), gaps_(gaps) {}

  /// From the answer s of the pass without v; u0: where its increment starts.
  Solution solve(Solution s, const Vector& u0, const Settings& settings) const {
    if (scene_.system->nodes() == 0) return s;
    Vector u = scene_.system->to_global(s.x, u0);
    Real last = (u - *scene_.at).lpNorm<Eigen::Infinity>();
    const Real enough = std::max(precise * last, negligible * u.lpNorm<Eigen::Infinity>());
    const Real far = contraction * last;
    Anderson anderson;
    u = anderson.next(*scene_.at, u);
    for (int pass = 0; pass < passes && last > enough; ++pass) {
      Solution next = scene_.solver->solve(corrected(u - *scene_.at), settings, s.x);
      if (next.status != Status::converged) break;
      const Vector now = scene_.system->to_global(next.x, u0);
      const Real change = (now - u).lpNorm<Eigen::Infinity>();
      if (change > std::min(far, last)) break;
      next.iterations += s.iterations;
      s = std::move(next);
      u = anderson.next(u, now);
      last = change;
    }
    return s;
  }

 private:
  static constexpr int passes = 5;
  static constexpr Real precise = 1e-3;      ///< over the step: the next one is what it is squared
  static constexpr Real negligible = 1e-10;  ///< over the displacement
  static constexpr Real contraction = 0.6;   ///< over the step: beyond, slopes at U say too little

  Increment corrected(const Vector& v) const {
    const auto [force, gap] = scene_.pairing->change(v, scene_.d);
    PointLaws laws = laws_;
    if (gaps_) laws.gap.head(gap.size()) += gap;
    const Vector b = b_ + force - scene_.stiffened->force(v);
    return scene_.increment(scene_.system->load_from(b, slip_from_), laws).increment;
  }

  const Scene& scene_;
  const Vector& b_;
  const Vector slip_from_;
  const PointLaws& laws_;
  const bool gaps_;
};

}  // namespace frictioncg
