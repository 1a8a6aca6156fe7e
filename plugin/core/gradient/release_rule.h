#pragma once
#include <memory>

#include "gradient/iterate.h"

namespace frictioncg {

/// When, and how, the nodes are let go whose face violates the laws: contact under tension, stick
/// beyond the sliding limit. It is what tells GC1, GC2, GC3 and GCX apart.
class ReleaseRule {
 public:
  virtual ~ReleaseRule() = default;

  /// At the start of a minimization.
  virtual void start() {}

  /// Let go at each iteration, before anything is measured.
  virtual bool at_once() const { return false; }

  /// Else: the norm of the residual on the free dofs down to which the faces are kept, given the
  /// final one, eps_0, and the violation (all in norm_D).
  virtual Real threshold(Real eps_0, Real violation) const = 0;

  /// Lets go of the nodes that violate by more than `least` (norm_D). True if there is one; where x
  /// has moved, only on the contact dofs, through it.rows.
  virtual bool release(Iterate& it, Real least) = 0;

  /// After a release: start again from v = P r, in place of conjugating.
  virtual bool restarts() const { return true; }

  /// The next direction would drive a released node back into the obstacle: it was held again.
  virtual void blocked() {}

  /// A step that ends at a gap goes on along the direction bent there, while J falls.
  virtual bool expands() const { return false; }

  /// Stick is a face, as contact is, in place of a regularized |x_T|.
  virtual bool stick_is_a_face() const { return false; }
};

std::unique_ptr<ReleaseRule> make_release_rule(const Settings& settings, const System& system);

}  // namespace frictioncg
