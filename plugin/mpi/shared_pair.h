#pragma once
#include "../freefem/freefem.h"

#include "guests.h"
#include "opening.h"
#include "shared_scene.h"

namespace frictioncg {

/// What a process knows of the faces, with normals and weights where the call gives them.
inline std::vector<InterfaceNode> interface_nodes(Stack stack, const Arguments& args,
                                                  const Scene& scene, const Dirichlet& dirichlet) {
  const Interface& faces = scene.pairing->between();
  std::vector<InterfaceNode> nodes;
  const auto held = mortar::held_components(scene.d, faces.dof, dirichlet);
  const auto body = body_of_nodes(faces.dof, scene.places(), scene.d, scene.ndof());
  for (std::size_t i = 0; i < faces.dof.size(); ++i) {
    const auto& dof = faces.dof[i];
    for (Index c = 1; c < scene.d; ++c)
      if (dof[c] != dof[0] + c)
        throw std::logic_error("the dofs of a node do not follow each other");
    nodes.push_back({-1, faces.X[i], held[i], body[i], faces.groups[i]});
  }
  const auto set = [&](auto InterfaceNode::*value, const auto& of_node) {
    for (std::size_t i = 0; i < of_node.size(); ++i) nodes[i].*value = of_node[i];
  };
  const auto given = [&](Parameter p) -> std::vector<Vec3> {
    if (!args.has(p)) return {};
    return scene.pairing->at_nodes(args.vector(stack, p, scene.dofs));
  };
  if (scene.at) {
    set(&InterfaceNode::now, faces.moved);
    set(&InterfaceNode::before, given(p_uold));
    set(&InterfaceNode::force, given(p_forceold));
  }
  if (args.has(p_normal)) set(&InterfaceNode::normal, slave_normals(stack, args, scene));
  set(&InterfaceNode::weight, slave_weights(stack, args, scene));
  return nodes;
}

/// macro_ddm.idp tells nodes by their places: faces that lie on each other when a mesh is
/// decomposed may get each other's nodes for ghosts.   Collective.
inline void refuse_exchanged_faces(const Domain& domain, const Interface& part) {
  Eigen::MatrixXd sides = Eigen::MatrixXd::Zero(2, domain.dofs());
  for (const mortar::Pair& pair : part.pairs)
    for (int side = 0; side < 2; ++side)
      for (const mortar::Facet& f : (side == 0 ? pair.slave : pair.master).facets)
        for (Index i : f.node)
          if (i >= 0) sides(side, part.dof[i][0]) = 1;
  if (domain.largest((sides.array() > domain.of_owners(sides).array()).any()) > 0)
    throw IllegalInput(
        "the domain takes nodes of slave and master for each other, which lie at the same places; "
        "decompose the mesh while the faces are apart, and move them together by movemesh after "
        "createMat");
}

/// The script's matrix, and what Dirichlet conditions hold of it, as owners of ghosts see it.
class PartMatrix {
 public:
  /// Collective.
  PartMatrix(Stack stack, const Expression A, const Scene& scene, const Domain& part) {
    Triplets given;
    std::unique_ptr<Dirichlet> own;
    part.agree([&] {
      given = matrix_of(stack, A, scene.dofs);
      if (are_exchanged(scene, given)) refuse_order(scene.dofs);
      own = std::make_unique<Dirichlet>(given, scene.pairing->between().dof);
    });
    patch_ = std::make_unique<PatchedMatrix>(part, given, *own);
    part.agree([&] {
      dirichlet_ = std::make_unique<Dirichlet>(triplets(), scene.pairing->between().dof);
    });
  }
  const Triplets& triplets() const { return patch_->triplets(); }
  const Dirichlet& dirichlet() const { return *dirichlet_; }

 private:
  std::unique_ptr<PatchedMatrix> patch_;
  std::unique_ptr<Dirichlet> dirichlet_;
};

/// The mortar between the whole faces, and how its contact nodes have moved: the same on all
/// processes.   Collective.
inline std::vector<BoundaryNode> face_whole(const Arguments& args, const Opening& opening,
                                            const PartMatrix& A, const Scene& scene,
                                            const Domain& part, SharedScene& shared) {
  const WholeInterface& faces = *shared.interface;
  mortar::Options options = opening.facing;
  for (Index i = 0; i < faces.slaves; ++i) {
    if (args.has(p_normal)) options.normals.push_back(faces.nodes[i].normal);
    if (args.has(p_weight)) options.weight.push_back(faces.nodes[i].weight);
  }
  const std::vector<Vec3> X = faces.at_all(&InterfaceNode::X);
  options.bodies = [&] { return faces.at_all(&InterfaceNode::body); };
  options.freedom = [&] {
    const std::vector<Index> body = options.bodies();
    return freedom_of(A.triplets(), A.dirichlet(), scene.places(), faces.d, extent_of(X), body,
                      count_of(body), part);
  };
  options.element_groups = [&](Index i) { return faces.nodes[i].groups; };
  if (args.has(p_forceold)) options.force = faces.at_all(&InterfaceNode::force);
  mortar::Nodes nodes{faces.d, X, faces.at_all(&InterfaceNode::held)};
  if (scene.at)
    for (const InterfaceNode& n : faces.nodes) {
      nodes.reference.push_back(n.X - n.now);
      if (args.has(p_uold)) nodes.before.push_back(nodes.reference.back() + n.before);
    }
  shared.mortar = std::make_shared<mortar::Mortar>(nodes, faces.pairs, options);
  std::vector<BoundaryNode> contact(shared.mortar->nodes().size());
  Pairing::add_motions(*shared.mortar, faces.at_all(&InterfaceNode::now), contact);
  return contact;
}

/// The contact points of own nodes, and what the outputs need of the mortar; contact: of all, how
/// they have moved.
inline void face_part(const NodeNumbers& numbers, const Domain& part,
                      const std::vector<BoundaryNode>& contact, SharedScene& shared) {
  Scene& scene = *shared.scene;
  const WholeInterface& faces = *shared.interface;
  const NodeDofs& dof = scene.pairing->between().dof;
  std::unordered_map<Index, Index> here;  // first dof -> node of the part's interface
  for (std::size_t i = 0; i < dof.size(); ++i) here.emplace(dof[i][0], static_cast<Index>(i));
  const auto local = [&](Index node) -> Index {
    const NodeNumbers::Number number = faces.nodes[node].number;
    const auto found = here.find(numbers.is_here(number) ? numbers.dof(number, 0) : -1);
    return found == here.end() ? -1 : found->second;
  };
  const auto is_own = [&](Index i) { return i >= 0 && part.owns(dof[i][0]); };
  FacedPart faced;
  const std::vector<mortar::SlaveNode>& nodes = shared.mortar->nodes();
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    const Index i = local(nodes[k].node);
    if (!is_own(i)) continue;
    scene.nodes.push_back(scene.pairing->contact_node(i, nodes[k]));
    scene.nodes.back().moved = contact[k].moved;
    scene.nodes.back().slid = contact[k].slid;
    shared.in_mortar.push_back(static_cast<Index>(k));
    faced.add(nodes[k]);
  }
  for (const mortar::MidEdge& e : shared.mortar->edges())
    if (is_own(local(e.node)))
      faced.edges.push_back({local(e.node), local(e.a), local(e.b), e.distance});
  const std::vector<Vec3> X = faces.at_all(&InterfaceNode::X);
  for (std::size_t p = 0; p < faces.pairs.size(); ++p)
    faced.add(faces.pairs[p], shared.mortar->statistics(static_cast<Index>(p)), scene.d, X);
  scene.pairing->set(std::move(faced));
}

/// The gap at the contact points of own nodes, with what has been moved already: between the
/// meshes, or as the call gives it at the slave's nodes.   Collective.
inline Vector gap_of_all(Stack stack, const Arguments& args, const SharedScene& shared) {
  const Scene& scene = *shared.scene;
  const Vector moved = moved_along_normals(scene).head(static_cast<Index>(shared.in_mortar.size()));
  if (!args.has(p_gap)) return scene.pairing->gap() + moved;
  std::vector<mortar::NodeGap> given;
  shared.domain->agree([&] { given = given_gap(stack, args, *scene.pairing); });
  const Vector weighted =
      shared.mortar->weighted(shared.interface->gathered(*shared.domain, given));
  return weighted(shared.in_mortar) + moved;
}

/// Places and bodies of guests, by their owners; each is a node of its own.   Collective.
inline void place_guests(const Domain& domain, Scene& scene) {
  const Index n = static_cast<Index>(scene.ndof()), d = scene.d;
  std::vector<NodePlace> places = scene.places();
  Eigen::MatrixXd at = Eigen::MatrixXd::Zero(4, domain.dofs());
  for (const NodePlace& p : places) at.col(p.dof[0]) << p.x, Real(p.body);
  domain.update(at);
  Index node = 0;
  for (Index of_part : scene.mesh_node) node = std::max(node, of_part + 1);
  for (Index i = n; i < domain.dofs(); i += d, ++node) {
    NodePlace p;
    p.x = at.col(i).head<3>();
    p.body = static_cast<Index>(at(3, i));
    for (Index c = 0; c < d; ++c) {
      p.dof[c] = i + c;
      scene.mesh_node.push_back(node);
    }
    places.push_back(p);
  }
  scene.places = [places = std::move(places)] { return places; };
}

/// The local system of the grown part, and of all.   Collective.
inline void assemble_grown(const GrownPart& grown, bool stiffened, SharedScene& shared) {
  Scene& scene = *shared.scene;
  const Domain& domain = *shared.domain;
  const Triplets A = grown.matrix(stiffened);
  shared.patch = std::make_unique<PatchedMatrix>(domain, A, *grown.dirichlet);
  domain.agree([&] {
    scene.system = std::make_unique<LocalSystem>(A, scene.d, points_of(scene.nodes),
                                                 scene.mesh_node, *grown.dirichlet, grown.coupling);
  });
  make_solver(shared);
}

/// A itself in place of what is stiffened.   Collective.
inline void assemble_plain(SharedScene& shared, long verb) {
  report_plain(verb);
  const std::shared_ptr<const GrownPart> grown = std::move(shared.stiffened);
  assemble_grown(*grown, false, shared);
}

/// As assemble() in one process: the matrix is less the stiffness of forceold, or the plain one
/// where the former has no answer.   Collective.
inline void assemble_grown(std::shared_ptr<const GrownPart> grown, long verb, SharedScene& shared) {
  if (!grown->has_addend) return assemble_grown(*grown, false, shared);
  shared.stiffened = std::move(grown);
  try {
    assemble_grown(*shared.stiffened, true, shared);
  } catch (const IllegalInput&) {
    assemble_plain(shared, verb);
  }
}

/// T'AT x against T'(A(T x)), A by the own rows of the script's matrix: a certificate cannot see
/// that a matrix is not the one that is meant.   Collective.
inline void check_transformed(const Triplets& A, const Domain& part, const SharedScene& shared) {
  constexpr Real rounding = 1e-9;
  const LocalSystem& local = *shared.scene->system;
  Vector x(shared.A->dofs()), Ax;
  for (Index k = 0; k < x.size(); ++k) x[k] = std::sin(Real(1 + k + shared.numbering().first));
  Vector u = local.to_global(shared.A->on_local(x), Vector::Zero(shared.scene->ndof()));
  shared.domain->update(u);
  Vector f = Vector::Zero(u.size());
  for_each_entry(A, [&](Index i, Index j, Real a) {
    if (part.owns(i) && !shared.scene->holds(i)) f[i] += a * u[j];
  });
  if (shared.stiffened) shared.stiffened->multiply_addend(u, f);
  shared.domain->update(f);
  const Vector by_parts = shared.A->own_part(local.basis().T.transpose() * f);
  shared.A->multiply(x, Ax);
  Real sums[] = {(by_parts - Ax).cwiseAbs2().cwiseQuotient(shared.A->D).sum(),
                 Ax.cwiseAbs2().cwiseQuotient(shared.A->D).sum()};
  shared.domain->sum(sums, 2);
  if (!(sums[0] <= rounding * rounding * sums[1]))
    throw IllegalInput(
        "the matrix between the bodies is not that of A: some process does not have all elements "
        "around its nodes; make the domains by createMat(Th, C, Pk) of macro_ddm.idp");
}

/// Less the symmetric part of the derivative of forceold, between free dofs, as
/// Pairing::stiffness.
inline std::vector<NumberedEntry> less_stiffness(const WholeInterface& faces,
                                                 const mortar::Mortar& mortar) {
  std::vector<NumberedEntry> entries;
  const auto is_held = [&](Index node, Index c) { return (faces.nodes[node].held >> c & 1) != 0; };
  const auto dof = [&](Index node, Index c) { return faces.d * faces.nodes[node].number + c; };
  mortar.stiffness().for_each_symmetric(faces.d, [&](Index i, int a, Index j, int b, Real s) {
    if (!is_held(i, a) && !is_held(j, b)) entries.push_back({dof(i, a), dof(j, b), -s});
  });
  return entries;
}

/// The mortar of the whole faces, and this process's part of it; the grown part.   Collective.
inline std::unique_ptr<GrownPart> grow(Stack stack, const Arguments& args, const Opening& opening,
                                       const PartMatrix& A, SharedScene& shared) {
  const Timed timed(Phase::pairing);
  const Scene& scene = *shared.scene;
  const Domain& part = *shared.domain;
  const Interface& faces = scene.pairing->between();
  std::vector<InterfaceNode> nodes;
  part.agree([&] { nodes = interface_nodes(stack, args, scene, A.dirichlet()); });
  refuse_exchanged_faces(part, faces);
  NodeNumbers numbers(part, scene.d, scene.mesh_node);
  shared.interface = std::make_shared<WholeInterface>(part, numbers, faces, nodes);
  InterfaceBasis basis;
  std::vector<NumberedEntry> stiffness;
  part.agree([&] {
    const auto contact = face_whole(args, opening, A, scene, part, shared);
    basis = basis_of(*shared.interface, *shared.mortar);
    stiffness = less_stiffness(*shared.interface, *shared.mortar);
    face_part(numbers, part, contact, shared);
  });
  return std::make_unique<GrownPart>(part, A.triplets(), A.dirichlet(), *shared.interface, basis,
                                     stiffness, numbers);
}

/// Poses contact of two bodies, whose part is in the scene.   Collective.
inline void read_pair(Stack stack, const Arguments& args, const Expression A, bool everywhere,
                      const Opening& opening, SharedScene& shared, PointLaws& laws) {
  const std::shared_ptr<const Domain> part = shared.domain;
  shared.script = shared.scene->dofs;
  const PartMatrix matrix(stack, A, *shared.scene, *part);
  const std::shared_ptr<const GrownPart> grown = grow(stack, args, opening, matrix, shared);
  laws = opening.laws;
  laws.gap = gap_of_all(stack, args, shared);
  part->agree([&] { laws = read_point_laws(stack, args, everywhere, *shared.scene, laws); });
  agree_on_tangents(shared, laws);
  Scene& scene = *shared.scene;
  shared.domain = grown->domain;
  place_guests(*shared.domain, scene);
  scene.dofs.count = shared.domain->dofs();
  shared.own_points = scene.nodes.size();
  add_ghost_points(*shared.domain, scene);
  assemble_grown(grown, part->rank() == 0 ? read_verb(stack, args) : 0, shared);
  check_transformed(matrix.triplets(), *part, shared);
}

}  // namespace frictioncg
