#pragma once
#include "assembly/dirichlet.h"
#include "assembly/frames.h"
#include "assembly/obstacles.h"
#include "model/contact_problem.h"

namespace frictioncg {

/// The laws of a call, at the contact points.
struct PointLaws {
  Law law = Law::frictionless;
  bool bilateral = false;
  Vector gap;      ///< one for each contact point [length]
  Vector mu = {};  ///< likewise [1]; law coulomb
  Vector g = {};   ///< likewise [force]; law tresca
  /// likewise [force], or empty; law coulomb, as in Increment
  Vector cohesion = {}, cap = {};
  bool given_gap = false;  ///< that of pairs is the script's, not measured between the meshes

  /// Whether a contact point has tangential laws.
  bool rubs(Index k) const {
    const auto is_above_0 = [&](const Vector& v) { return v.size() > 0 && v[k] > 0; };
    return law == Law::coulomb ? is_above_0(mu) || is_above_0(cohesion)
                               : law == Law::tresca && is_above_0(g);
  }
};

/// The load of an increment in local dofs (n_w), and what it is made of.
struct LocalLoad {
  Vector external;  ///< T'b
  Vector total;     ///< external - K u_D
  Vector F;         ///< total - A w_old
  Vector sizes;     ///< sums of the sizes of what F is summed of
  Vector start;     ///< w_old, then u_D
};

/// Fills F and the norms of an increment whose laws are known. system: what load is over.
void set_load(const LocalLoad& load, const System& system, Increment& increment);

/// An increment in local dofs, and the displacement u0 (n) that it starts from: u = u0 + T x.
struct LocalIncrement {
  Increment increment;
  Vector u0;
  Real left_out = 0;  ///< of the load, by leave_out_uncertain_work
};

/// From the assembled system to the contact problem in local dofs, and back: Dirichlet conditions
/// eliminated, u = T [w; u_D] in the frames of the contact points. Where the frames lie along the
/// axes nothing is rotated.
class LocalSystem {
 public:
  /// Copies A once, in O(nnz); A itself is not kept. mesh_node (n, or empty): which dofs share a
  /// node of the mesh, so that the factorization orders nodes in place of dofs. shape: motions in
  /// dofs of the script (n x k). before: the system of another matrix, or null; its pattern is kept
  /// where that holds all of A. obstacles: those that move; n counts their dofs, too, of which b
  /// has the load where they are free, and the motion where it is given.
  /// Throws IllegalInput for what is not finite, not symmetric, or has a diagonal <= 0, and as
  /// with_obstacles.
  LocalSystem(const Triplets& A, int dimension, std::vector<ContactPoint> points,
              std::vector<Index> mesh_node = {}, BodyShape shape = {},
              const LocalSystem* before = nullptr, const RigidObstacles& obstacles = {});
  /// With two bodies: frames and laws act on the relative displacements of the coupling, that knows
  /// what `dirichlet` holds of A.
  LocalSystem(const Triplets& A, int dimension, std::vector<ContactPoint> points,
              const std::vector<Index>& mesh_node, Dirichlet dirichlet, const Coupling& coupling,
              BodyShape shape = {}, const LocalSystem* before = nullptr);
  LocalSystem(const LocalSystem&) = delete;
  LocalSystem& operator=(const LocalSystem&) = delete;

  /// The increment under the load b (n, with the data of Dirichlet dofs as A's storage wants it)
  /// from the state u_old (n, or empty for 0). Throws IllegalInput for vectors of another size, and
  /// where A does not have the couplings that Dirichlet data need.
  LocalIncrement increment(const Vector& b, const Vector& u_old, const PointLaws& laws) const;

  /// The load of that increment alone, by the state in local dofs, and the increment under it.
  /// as_known: b is rounded by as much as A w_old, as with b = K U + r.
  LocalLoad load_from(const Vector& b, const Vector& w_old, bool as_known = false) const;
  LocalIncrement increment(const LocalLoad& load, const PointLaws& laws) const;

  SystemPtr system() const { return system_; }
  Index nodes() const { return static_cast<Index>(nodes_.size()); }
  /// Contact point of contact node k; several nodes may lie at one node of the mesh.
  const ContactNode& node(Index k) const { return nodes_[k]; }
  Index fixed_dofs() const { return dirichlet_.size(); }
  const Dirichlet& dirichlet() const { return dirichlet_; }
  bool rotated() const { return basis_->rotated; }
  const Basis& basis() const { return *basis_; }

  Vector to_local(const Vector& u) const { return basis_->W * u; }
  /// u0 + x on free dofs, u0 on Dirichlet dofs
  Vector to_global(const Vector& x, const Vector& u0) const;
  Vector to_global(const Vector& x) const;  ///< from u0 = 0
  /// Force of the obstacle on the body (n), of r = F - Ax: along its normals and against the slip,
  /// W'(-r) on the contact dofs. What supports take at the same node is not in it. On the dofs of
  /// an obstacle that moves: force and moment of the body on it.
  Vector force_to_global(const Vector& r) const;

 private:
  void make_basis(const Triplets& A, int dimension);
  void assemble(const Triplets& A, int dimension, const std::vector<Index>& mesh_node,
                BodyShape shape, const LocalSystem* before);
  Matrix border(Index n) const;
  template <class Modes>
  std::function<Modes()> in_local_dofs(std::function<Modes()> modes) const;
  Real nearest_obstacle(const ContactNode& node, const PointLaws& laws, Real rounding,
                        const Vector& start) const;

  std::vector<ContactPoint> points_;
  Dirichlet dirichlet_;
  std::vector<ContactNode> nodes_;
  std::shared_ptr<const Basis> basis_;
  Matrix K_;       ///< n_w x n_D, forces of prescribed displacements
  Places places_;  ///< of a matrix that has come again; else empty
  SystemPtr system_;
};

}  // namespace frictioncg
