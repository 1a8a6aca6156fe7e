#pragma once
#include "scene.h"

namespace frictioncg {

/// mu, gap, weight or a traction at each of the nodes; 0 where it is not given.
Vector at_nodes(Stack stack, const Arguments& args, Parameter p,
                const std::vector<BoundaryNode>& nodes);

/// The gap of the call at the slave's nodes, once for each of their labels.
std::vector<mortar::NodeGap> given_gap(Stack stack, const Arguments& args, const Pairing& pairs);

/// n.w of the displacement at which the geometry is, at each contact point: gaps are those that are
/// left there, and laws bound the whole displacement.
Vector moved_along_normals(const Scene& scene);

/// A normal may lean away from the boundary's own, up to lying in it (the obstacle may give it).
/// Beyond that the node faces away from the obstacle.
bool faces_away(const BoundaryNode& node, const Vec3& n);

/// Replaces the mesh's normals on an obstacle by those of the call. Nodes that faced away from it
/// where the increment began, as those at the ends of a nose, are left out, and kept aside.
void set_normals(Stack stack, const Arguments& args, Scene& scene);

/// Refuses normals that every node faces away from: they point into the body.
void refuse_inward(const Scene& scene);

/// The normals of the call at the slave's nodes; 0 where they have no direction.
std::vector<Vec3> slave_normals(Stack stack, const Arguments& args, const Scene& scene);

/// Orthotropic friction: the ratio of the coefficients, and the direction of the first. The frames
/// keep the ratio: a later call changes mu, and mu2 with it.
void set_orthotropy(Stack stack, const Arguments& args, const Vector& mu, Scene& scene);

/// Refuses friction on a contactproblem, `name`, that has no tangents.
void refuse_friction_of_none(const char* name, const Arguments& args, const Scene& scene);

/// What the laws of a call are beside their values at nodes, of which `given` has others. Refuses
/// laws that exclude one another, and a bound on friction that nothing makes.
PointLaws begun_laws(Stack stack, const Arguments& args, PointLaws given = {});

/// The laws of a call: those of `laws` where the call names no other. They hold for this call only.
/// gap: as read_gap's before.
PointLaws read_laws(Stack stack, const Arguments& args, const Scene& scene, PointLaws laws,
                    const Vector& gap = {});

/// Weights the shares of the contact points on an obstacle, by which tractions are multiplied.
void set_weights(Stack stack, const Arguments& args, Scene& scene);

/// The weight of the mortar at the slave's nodes; empty where none is named.
std::vector<Real> slave_weights(Stack stack, const Arguments& args, const Scene& scene);

/// The radius of forms that look axisymmetric, as a component, where contact does not know it: no
/// weight is named, and pressures or limits are integrated. Else -1.
int unnamed_radius(const Arguments& args, const Scene& scene, const Triplets& A);

}  // namespace frictioncg
