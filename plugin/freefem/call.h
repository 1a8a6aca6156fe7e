#pragma once
#include "../core/model/validate.h"
#include "moving_obstacles.h"
#include "scene.h"

namespace frictioncg {

/// What a call says beside geometry and laws. Every expression of the script is evaluated before
/// anything is solved or written: one of them may throw, or change what the call works on.
struct Call {
  Stack stack;
  const Arguments& args;
  Expression load;
  Settings settings = read_settings(stack, args);
  long verb = read_verb(stack, args);
  Vector b = vector_of(stack, load, "b");
  Vector u_old = args.vector(stack, p_uold);         ///< empty where it is not given
  Vector u_init = args.vector(stack, args.start());  ///< likewise
  Motions motions{stack, args};                      ///< of obstacles that move
};

/// A may be definite where it is not less the stiffness of contact forces.
void report_plain(long verb);

/// The laws that the arguments name at the contact points, which get their tangents: a node has
/// tangential laws where `everywhere` or its own mu or limit asks for them.
PointLaws read_point_laws(Stack stack, const Arguments& args, bool everywhere, Scene& scene,
                          PointLaws begun);

/// Where the geometry of a call is; null where it is that of the mesh.
Stage read_stage(Stack stack, const Arguments& args);

/// Reads the problem: geometry, laws, and the matrix in local frames. lasts: for further calls,
/// which may name other laws, and other matrices.
std::shared_ptr<Scene> read_scene(Stack stack, const Arguments& args, const Expression A,
                                  const Site& site, bool lasts, PointLaws& laws);

/// Sizes, and finite values.
void check_vectors(const Call& call, const DofCount& dofs);

/// The vectors of a call by all dofs: those of the script, then those of obstacles that move.
struct Vectors {
  Vector b, u_old, u_init;  ///< u_old and u_init empty where nothing gives them
  Vectors(const Call& call, const Scene& scene);
};

/// These vectors, and the laws, as an increment in local dofs.
LocalIncrement increment(const Vectors& vectors, const Scene& scene, PointLaws laws);

/// Whether rounding is all that a call which has stagnated leaves. With `at` the load of a step is
/// what the last one has left: nothing, where bodies have parted. Elsewhere it is little, as with
/// P2 on slender bodies, and the call names no `tol`. With a large contrast of A, as of a node of
/// which next to nothing faces the master, rounding may be anything.
bool passes_by_rounding(const Solution& s, Real contrast, const Arguments& args, bool at);

/// The field of one increment, on a posed scene.
Vector solve(Stack stack, const Call& call, Scene& scene, const PointLaws& laws);

/// Values at the nodes of the faces.
using AtNodes = std::vector<Vec3>;

/// A step of Newton's method for bodies whose geometry is that of U. What is solved with A less the
/// symmetric stiffness S of the contact forces G'y, and with the gaps g of U, lacks to first order
/// in v = u - U
///
///   (A - S) u = b - S U + N v + G'y,     N = d(G'y)/dU - S
///   n.G u <= g + n.G U + R v,            R = dg/dU + n.G
///
/// which is added pass by pass, with the v that the passes before lead to: other loads and other
/// gaps for the factors at hand. The answer is certified on the laws of its pass; where u = U they
/// are those of the geometry at u. A pass that does not contract is not taken; those after it,
/// which know of it, may: under a corner that digs in friction turns one motion by more than
/// itself.
///
/// N and R ask for v at the nodes of the faces alone, and so does all that is decided here: several
/// processes, which have the faces whole, decide alike.
///
/// s: the answer without v; trace(s): an answer's u at the nodes, as U has them; pass(v, x0): the
/// answer with v at the nodes, begun from x0.
Solution newton_step(Solution s, const AtNodes& U,
                     const std::function<AtNodes(const Solution&)>& trace,
                     const std::function<Solution(const AtNodes&, const Vector&)>& pass);

struct SharedScene;  // of frictionCG-mpi alone

/// What a script's variable of type contactproblem stands for. Copies share the scene with its
/// factorization, and have laws of their own.
struct PosedProblem {
  std::shared_ptr<Scene> scene;
  PointLaws laws;  ///< as given to contactProblem(...); a call's own hold for that call
  std::shared_ptr<SharedScene> shared = {};  ///< of several processes, in place of the scene
};

/// C with the script's matrix as it is now, and with what the call names of its geometry. alone:
/// nobody else has the scene of C, which then gives its solver away. laws: those of the call.
/// Whatever is refused, C stays as it was.
PosedProblem renewed(Stack stack, const Arguments& args, const Expression A, const PosedProblem& C,
                     bool alone, PointLaws& laws);

}  // namespace frictioncg
