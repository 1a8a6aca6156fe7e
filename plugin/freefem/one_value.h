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

/// The number of free dofs of a component at which b is `value`.
inline std::size_t count_value(const Scene& scene, const Vector& b, int c, Real value) {
  const std::vector<NodePlace> places = scene.places();
  return std::count_if(places.begin(), places.end(), [&](const NodePlace& n) {
    return !scene.held[n.dof[c]] && b[n.dof[c]] == value;
  });
}

/// Refuses b of one value at all nodes of a boundary, its ends included, and nowhere else, where A
/// has rows of tgv = -1: the data of an on() are such values, and no traction is. By any other A a
/// script may mean such nodal forces, and is told.
inline void check_one_value(const Scene& scene, const Vector& b, long verb) {
  const bool refused = scene.system->dirichlet().has_unit_rows();
  if (!refused && verb == 0) return;
  const std::vector<LabelledNode>& nodes = scene.labelled();
  for (int c = 0; c < scene.d; ++c)
    for (const auto& [value, one] : labels_of_one_value(scene, b, c, nodes)) {
      if (!one.like_data() || one.share.size() != count_value(scene, b, c, value)) continue;
      std::ostringstream m;
      m << "b is " << value << " at each node of a boundary, its ends included, as on(";
      for (long label : one.labels) m << label << ", ";
      m << "u" << c + 1 << "=" << value
        << ") with tgv = -1 makes it, where A has no Dirichlet row; " << assemble_both
        << "; a load is an integral, int1d or int2d, with less at the ends";
      if (refused) throw IllegalInput(m.str());
      line() << "note: " << m.str() << std::endl;
    }
}

}  // namespace frictioncg
