#pragma once
#include "freefem.h"

#include "scene.h"

namespace frictioncg {

/// Which node of the mesh each dof belongs to.
template <class Space>
std::vector<Index> mesh_nodes(const Space& Vh) {
  std::vector<Index> node(Vh.NbOfDF);
  for (int k = 0; k < Vh.NbOfNodes; ++k)
    for (int i = Vh.FirstDFOfNode(k); i < Vh.LastDFOfNode(k); ++i) node[i] = k;
  return node;
}

/// The nodes that carry values of every component of the displacement. Elements with nothing new
/// are passed over: most of them, in 3D.
template <class Space>
std::vector<NodePlace> node_places(const Placement<Space>& placement) {
  using D = Dimension<Space>;
  const Space& Vh = placement.space();
  const std::vector<Index> body = body_of_element(Vh.Th, D::d);
  std::vector<NodePlace> places, at_point;
  std::vector<char> seen(Vh.NbOfDF, 0);
  Interpolation ip;
  for (int k = 0; k < Vh.Th.nt; ++k) {
    const typename D::Element K(Vh[k]);
    bool news = false;
    for (int i = 0; i < K.NbDoF() && !news; ++i) news = !seen[K(i)];
    if (!news) continue;
    D::interpolate(K, ip);
    at_point.assign(ip.hat.size(), NodePlace());
    for (std::size_t e = 0; e < ip.dof.size(); ++e)
      if (ip.coefficient[e] == 1) at_point[ip.point[e]].dof[ip.component[e]] = K(ip.dof[e]);
    for (std::size_t p = 0; p < at_point.size(); ++p) {
      NodePlace& n = at_point[p];
      bool whole = true;
      for (int c = 0; c < D::d; ++c) whole &= n.dof[c] >= 0;
      if (!whole || seen[n.dof[0]]) continue;
      const Fem2D::R3 x = placement.node(k, ip.hat[p], n.dof);
      n.x = {x.x, x.y, x.z};
      n.body = body[k];
      places.push_back(n);
      seen[n.dof[0]] = 1;
    }
    for (int i = 0; i < K.NbDoF(); ++i) seen[K(i)] = 1;
  }
  return places;
}

/// Makes a node the point at which expressions are evaluated: where it has been moved to, and in
/// its element, by which functions on the mesh are read.
template <class FESpaceType>
void go_to(MeshPoint* mp, const Placement<FESpaceType>& Vh, const BoundaryNode& node) {
  const Placement<FESpaceType>& there = node.is_begun ? *Vh.begun() : Vh;
  Dimension<FESpaceType>::set_point(mp, Vh.mesh(), node,
                                    there(node.element, node.hat) + node.aside);
}

/// make(), by whichever copy is called first, for all of them.
template <class Make>
auto once(Make make) {
  const auto made = std::make_shared<std::optional<decltype(make())>>();
  return [make = std::move(make), made]() -> const decltype(make())& {
    if (!*made) *made = make();
    return **made;
  };
}

/// How to evaluate expressions at the nodes of a space, and where they are.
template <class FESpaceType>
void observe(const Placement<FESpaceType>& Vh, Scene& scene) {
  scene.mesh_node = mesh_nodes(Vh.space());
  scene.go_to = [Vh](MeshPoint* mp, const BoundaryNode& node) { frictioncg::go_to(mp, Vh, node); };
  scene.places = once([Vh] { return node_places(Vh); });
  scene.labelled = once([Vh] { return labelled_nodes(Vh); });
}

/// Normals that motions of a body leave tangential, as far as the mesh can tell, do so exactly.
template <class FESpaceType>
void follow_motions(const Placement<FESpaceType>& Vh, std::vector<BoundaryNode>& points) {
  if (!any_curved(points)) return;
  const std::vector<Index> of_element = body_of_element(Vh.mesh(), Dimension<FESpaceType>::d);
  std::vector<Index> body;
  for (const BoundaryNode& p : points) body.push_back(of_element[p.element]);
  follow_motions(Dimension<FESpaceType>::d, body, *std::max_element(body.begin(), body.end()) + 1,
                 Vh.begun() != nullptr, points);
}

}  // namespace frictioncg
