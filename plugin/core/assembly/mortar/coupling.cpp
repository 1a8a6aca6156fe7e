#include "assembly/mortar/coupling.h"

namespace frictioncg::mortar {

namespace {

void add_component(const Matrix& of_nodes, const NodeDofs& dof, int c, EntryList& entries) {
  for (Index i = 0; i < of_nodes.rows(); ++i)
    for (Matrix::InnerIterator it(of_nodes, i); it; ++it)
      entries.emplace_back(dof[i][c], dof[it.col()][c], it.value());
}

}  // namespace

std::vector<unsigned char> held_components(int d, const NodeDofs& dof, const Dirichlet& dirichlet) {
  std::vector<unsigned char> held(dof.size(), 0);
  for (std::size_t i = 0; i < dof.size(); ++i)
    for (int c = 0; c < d; ++c)
      if (dirichlet.holds(dof[i][c])) held[i] |= static_cast<unsigned char>(1 << c);
  return held;
}

Coupling couple(const Mortar& mortar, int d, const NodeDofs& dof, const Dirichlet& dirichlet,
                Index n, const std::vector<char>& taken) {
  EntryList T, W;
  std::vector<char> coupled(n, 0);
  for (int c = 0; c < d; ++c) {
    std::vector<char> held(dof.size());
    for (std::size_t i = 0; i < dof.size(); ++i) {
      held[i] = dirichlet.holds(dof[i][c]) || (!taken.empty() && taken[i]);
      coupled[dof[i][c]] = 1;
    }
    add_component(mortar.change_of_basis(held), dof, c, T);
    add_component(mortar.inverse_basis(held), dof, c, W);
  }
  return on_all_dofs(coupled, std::move(T), std::move(W));
}

Coupling on_all_dofs(const std::vector<char>& coupled, EntryList T, EntryList W) {
  const Index n = static_cast<Index>(coupled.size());
  for (Index i = 0; i < n; ++i) {
    if (coupled[i]) continue;
    T.emplace_back(i, i, 1);
    W.emplace_back(i, i, 1);
  }
  return {sparse(n, n, T), sparse(n, n, W)};
}

}  // namespace frictioncg::mortar
