#pragma once
#include "freefem.h"

#include "dirichlet.h"
#include "report.h"

namespace frictioncg {

/// Nodes that have one value of b in a component, and the labels that they make up.
struct OneValue {
  std::vector<long> labels;
  std::map<Index, Real> share;  ///< of the boundary, per dof
  /// Data of on() have it at the ends, too. Where the shares are alike, as on a closed boundary, a
  /// traction has it as well.
  bool like_data() const {
    if (share.size() < 3) return false;
    const auto less = [](const auto& a, const auto& b) { return a.second < b.second; };
    const auto [least, most] = std::minmax_element(share.begin(), share.end(), less);
    return most->second > 1.5 * least->second;
  }
};

/// Of a component, the labels whose free nodes all have one value of b, but 0, by that value.
inline std::map<Real, OneValue> labels_of_one_value(const Scene& scene, const Vector& b, int c,
                                                    const std::vector<LabelledNode>& nodes) {
  std::map<std::pair<int, long>, std::vector<const LabelledNode*>> of_label;
  for (const LabelledNode& n : nodes)
    if (!scene.held[n.dof[c]]) of_label[{n.space, n.label}].push_back(&n);
  std::map<Real, OneValue> found;
  for (const auto& [label, own] : of_label) {
    const Real value = b[own.front()->dof[c]];
    const auto same = [&](const LabelledNode* n) { return b[n->dof[c]] == value; };
    if (value == 0 || !std::all_of(own.begin(), own.end(), same)) continue;
    found[value].labels.push_back(label.second);
    for (const LabelledNode* n : own) found[value].share[n->dof[c]] += n->share;
  }
  return found;
}

/// A note where b has one value at all nodes of a boundary, its ends included, and nowhere else:
/// the data of an on() with tgv = -1 are such values, and no traction is. A script may mean such
/// nodal forces all the same.
inline void note_one_value(const Scene& scene, const Vector& b) {
  std::map<Real, std::size_t> uses;
  for (long i = 0; i < scene.ndof(); ++i)
    if (!scene.held[i] && b[i] != 0) ++uses[b[i]];
  if (std::none_of(uses.begin(), uses.end(), [](const auto& u) { return u.second > 2; })) return;
  const std::vector<NodePlace> places = scene.places();
  const std::vector<LabelledNode> nodes = scene.labelled();
  for (int c = 0; c < scene.d; ++c) {
    std::map<Real, std::size_t> of_component;
    for (const NodePlace& n : places)
      if (!scene.held[n.dof[c]]) ++of_component[b[n.dof[c]]];
    for (const auto& [value, one] : labels_of_one_value(scene, b, c, nodes)) {
      if (!one.like_data() || one.share.size() != of_component[value]) continue;
      std::ostringstream on;
      for (long label : one.labels) on << label << ", ";
      on << "u" << c + 1 << "=" << value;
      line() << "note: b is " << value << " at each node of a boundary, its ends included, as on("
             << on.str()
             << ") with tgv = -1 makes it, where A has no Dirichlet row; it acts as forces "
             << "of the nodes. If it is data, " << assemble_both << std::endl;
    }
  }
}

}  // namespace frictioncg
