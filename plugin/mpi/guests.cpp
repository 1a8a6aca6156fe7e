#include "guests.h"

namespace frictioncg {

InterfaceBasis basis_of(const WholeInterface& interface, const mortar::Mortar& mortar) {
  InterfaceBasis basis;
  for (Index c = 0; c < interface.d; ++c) {
    std::vector<char> held;
    for (const InterfaceNode& n : interface.nodes) held.push_back((n.held >> c) & 1);
    basis.T.push_back(mortar.change_of_basis(held));
    basis.W.push_back(mortar.inverse_basis(held));
  }
  return basis;
}

/// How a part grows.
struct Growth {
  using Number = NodeNumbers::Number;
  using Entry = NumberedEntry;

  const Domain& part_;
  const WholeInterface& interface_;
  const InterfaceBasis& basis_;
  const std::vector<NumberedEntry>& addend_;
  NodeNumbers& numbers_;
  GrownPart& grown_;
  std::vector<Entry> received_ = {};     ///< of rows of others
  std::vector<Number> whole_rows_ = {};  ///< of the interface: own, and received ones; sorted
  std::vector<Number> guests_ = {};      ///< nodes in ascending order: by owners

  /// Row i goes to the owners of all p that T_ip or W_ip couple it to.
  void exchange_rows(const Triplets& A, const Dirichlet& of_A) {
    std::vector<std::set<int>> readers_of;  // rows that are sent
    std::vector<Index> place(A.n, -1);      // of a row among these
    for (Index node = 0; node < interface_.count(); ++node) {
      const Number number = interface_.nodes[node].number;
      if (numbers_.owner(number) != part_.rank()) continue;
      for (Index c = 0; c < interface_.d; ++c) {
        const Index dof = numbers_.dof(number, c);
        whole_rows_.push_back(numbers_.of(dof));
        std::set<int> readers;
        for (const Matrix* M : {&basis_.T[c], &basis_.W[c]})
          for (Matrix::InnerIterator e(*M, node); e; ++e)
            readers.insert(numbers_.owner(interface_.nodes[e.col()].number));
        readers.erase(part_.rank());
        if (readers.empty() || of_A.holds(dof)) continue;
        place[dof] = static_cast<Index>(readers_of.size());
        readers_of.push_back(std::move(readers));
      }
    }
    Domain::Letters<Entry> out;
    for_each_entry(A, [&](Index i, Index j, Real a) {
      if (place[i] < 0) return;
      for (int r : readers_of[place[i]]) out[r].push_back({numbers_.of(i), numbers_.of(j), a});
    });
    for (const auto& [rank, entries] : part_.delivered(out))
      received_.insert(received_.end(), entries.begin(), entries.end());
    for (const Entry& e : received_) whole_rows_.push_back(e.i);
    sort_once(whole_rows_);
  }
  /// Own rows off the interface, too, see ghosts of the slave: their rows of T are needed whole.
  void find_guests(const Triplets& A) {
    std::vector<Number> in_T = whole_rows_;
    std::vector<char> seen(A.n, 0);
    for_each_entry(A, [&](Index i, Index j, Real) { seen[j] |= part_.owns(i); });
    for (Index j = 0; j < A.n; ++j)
      if (seen[j] && interface_.at.count(numbers_.node(numbers_.of(j))) > 0)
        in_T.push_back(numbers_.of(j));
    for (const Entry& e : received_) {
      in_T.push_back(e.j);
      for (Number dof : {e.i, e.j}) guests_.push_back(numbers_.node(dof));
    }
    for (const Entry& e : addend_)
      if (is_whole(e.i)) {
        in_T.push_back(e.j);
        guests_.push_back(numbers_.node(e.j));
      }
    const auto add_columns = [&](const std::vector<Number>& dofs, const std::vector<Matrix>& M) {
      for (Number j : dofs) {
        const auto found = interface_.at.find(numbers_.node(j));
        if (found == interface_.at.end()) continue;
        for (Matrix::InnerIterator e(M[numbers_.component(j)], found->second); e; ++e)
          guests_.push_back(interface_.nodes[e.col()].number);
      }
    };
    sort_once(in_T);
    add_columns(in_T, basis_.T);
    add_columns(whole_rows_, basis_.W);
    sort_once(guests_);
    guests_.erase(std::remove_if(guests_.begin(), guests_.end(),
                                 [&](Number node) { return numbers_.is_here(node); }),
                  guests_.end());
  }
  /// Owners learn whom their nodes visit.
  void invite_guests() {
    const Index d = interface_.d;
    Domain::Letters<Number> asked;
    std::map<int, Domain::Exchange> exchanges;
    Index next = part_.dofs();
    for (Number node : guests_) {
      const int owner = numbers_.owner(node);
      asked[owner].push_back(node);
      numbers_.add(node, next);
      for (Index c = 0; c < d; ++c) exchanges[owner].received.push_back(next++);
    }
    for (const auto& [rank, wanted] : part_.delivered(asked))
      for (Number node : wanted)
        for (Index c = 0; c < d; ++c) exchanges[rank].sent.push_back(numbers_.dof(node, c));
    const Index more = d * static_cast<Index>(guests_.size());
    grown_.domain = std::make_shared<const Domain>(part_, more, exchanges);
  }
  /// Rows that were received replace those of the part, and their mirror images the columns between
  /// free dofs: the matrix stays symmetric. Guests without a row have a diagonal.
  void fill_matrix(const Triplets& A, const Dirichlet& of_A) {
    const Domain& domain = *grown_.domain;
    Vector held = Vector::Zero(domain.dofs()), diagonal = Vector::Zero(domain.dofs());
    for (Index i = 0; i < A.n; ++i) held[i] = of_A.holds(i);
    for_each_entry(A, [&](Index i, Index j, Real a) { diagonal[i] += i == j ? a : 0; });
    domain.update(held);
    domain.update(diagonal);
    for (Index i = 0; i < domain.dofs(); ++i) grown_.held.push_back(held[i] != 0);
    grown_.dirichlet = std::make_unique<const Dirichlet>(of_A.with_more(grown_.held, diagonal));
    std::vector<char> replaced(domain.dofs(), 0);
    for (const Entry& e : received_) replaced[numbers_.dof(e.i)] = 1;
    const std::vector<char>& fixed = grown_.held;
    const std::size_t most = (A.half ? 2 : 1) * A.size + 2 * received_.size() + domain.dofs() - A.n;
    grown_.i_.reserve(most);
    grown_.j_.reserve(most);
    grown_.a_.reserve(most);
    for_each_entry(A, [&](Index i, Index j, Real a) {
      if (!replaced[i] && !(replaced[j] && !fixed[i] && !fixed[j])) grown_.put(i, j, a);
    });
    for (const Entry& e : received_) {
      const Index i = numbers_.dof(e.i), j = numbers_.dof(e.j);
      grown_.put(i, j, e.a);
      if (!replaced[j] && !grown_.held[j]) grown_.put(j, i, e.a);
    }
    for (Index i = A.n; i < domain.dofs(); ++i)
      if (!replaced[i]) grown_.put(i, i, diagonal[i]);
    grown_.plain_ = grown_.a_.size();
    for (const Entry& e : addend_) {  // in the rows that are whole, and their mirror images
      if (!is_whole(e.i)) continue;
      const Index i = numbers_.dof(e.i), j = numbers_.dof(e.j);
      grown_.put(i, j, e.a);
      if (!is_whole(e.j)) grown_.put(j, i, e.a);
    }
  }
  void fill_coupling() {
    std::vector<Index> first;
    for (const InterfaceNode& n : interface_.nodes)
      first.push_back(numbers_.is_here(n.number) ? numbers_.dof(n.number, 0) : -1);
    EntryList T, W;
    std::vector<char> coupled(grown_.domain->dofs(), 0);
    for (Index i = 0; i < interface_.count(); ++i) {
      if (first[i] < 0) continue;
      for (Index c = 0; c < interface_.d; ++c) {
        coupled[first[i] + c] = 1;
        add_row(basis_.T[c], first, i, c, T);
        add_row(basis_.W[c], first, i, c, W);
      }
    }
    grown_.coupling = mortar::on_all_dofs(coupled, std::move(T), std::move(W));
  }
  bool is_whole(Number row) const {
    return std::binary_search(whole_rows_.begin(), whole_rows_.end(), row);
  }
  /// A row that is not whole here is one of the identity: no own row of T'AT sees it. first: dof of
  /// each node of the interface, or -1.
  void add_row(const Matrix& M, const std::vector<Index>& first, Index node, Index component,
               EntryList& entries) const {
    const Index i = first[node] + component;
    bool whole = true;
    for (Matrix::InnerIterator e(M, node); e; ++e) whole = whole && first[e.col()] >= 0;
    if (!whole) entries.emplace_back(i, i, 1);
    for (Matrix::InnerIterator e(M, node); e && whole; ++e)
      entries.emplace_back(i, first[e.col()] + component, e.value());
  }
};

GrownPart::GrownPart(const Domain& part, const Triplets& A, const Dirichlet& of_A,
                     const WholeInterface& interface, const InterfaceBasis& basis,
                     const std::vector<NumberedEntry>& addend, NodeNumbers& numbers)
    : has_addend(!addend.empty()) {
  Growth growth{part, interface, basis, addend, numbers, *this};
  growth.exchange_rows(A, of_A);
  growth.find_guests(A);
  growth.invite_guests();
  growth.fill_matrix(A, of_A);
  growth.fill_coupling();
}

void GrownPart::put(Index i, Index j, Real a) {
  i_.push_back(i);
  j_.push_back(j);
  a_.push_back(a);
}

Triplets GrownPart::matrix(bool with_addend) const {
  Triplets A;
  A.n = domain->dofs();
  A.size = with_addend ? a_.size() : plain_;
  A.i = i_.data();
  A.j = j_.data();
  A.a = a_.data();
  A.whole = domain->owned();
  return A;
}

void GrownPart::multiply_addend(const Vector& u, Vector& f) const {
  for (std::size_t k = plain_; k < a_.size(); ++k)
    if (domain->owns(i_[k])) f[i_[k]] += a_[k] * u[j_[k]];
}

}  // namespace frictioncg
