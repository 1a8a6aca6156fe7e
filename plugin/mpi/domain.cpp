#include "domain.h"

namespace frictioncg {

namespace {

/// Domains that are made of this one share it.
std::shared_ptr<const MPI_Comm> own_copy(MPI_Comm communicator) {
  return {new MPI_Comm(duplicate(communicator)), [](MPI_Comm* copy) {
            int ended = 0;
            MPI_Finalized(&ended);
            if (!ended) MPI_Comm_free(copy);
            delete copy;
          }};
}

}  // namespace

Domain::Domain(MPI_Comm communicator, std::vector<Neighbour> neighbours, const Vector& D)
    : meeting_(Meeting::of(communicator)),
      name_("no. " + std::to_string(meeting_->next_number())),
      communicator_(own_copy(communicator)),
      owned_(D.size(), 1) {
  MPI_Comm_rank(*communicator_, &rank_);
  MPI_Comm_size(*communicator_, &size_);
  check_neighbours(neighbours);
  choose_owners(neighbours, D);
}

Domain::Domain(const Domain& first, const Domain& second) : Domain(first) {
  if (second.meeting_ != meeting_)
    throw IllegalInput("the two domains were made with different communicators");
  name_ += " and " + second.name_;
  first_ = first.dofs();
  owned_.insert(owned_.end(), second.owned_.begin(), second.owned_.end());
  add(second.exchanges_, first_);
}

Domain::Domain(const Domain& part, Index more, const std::map<int, Exchange>& exchanges)
    : Domain(part) {
  owned_.resize(owned_.size() + static_cast<std::size_t>(more), 0);
  add(exchanges, 0);
}

/// One message a process: what was sent to it before comes first, on both sides.
void Domain::add(const std::map<int, Exchange>& more, Index offset) {
  for (const auto& [rank, e] : more) {
    Exchange& all = exchanges_[rank];
    for (Index dof : e.sent) all.sent.push_back(dof + offset);
    for (Index dof : e.received) all.received.push_back(dof + offset);
  }
}

/// One message of all processes where on any of them something is wrong with the lists.
void Domain::require_match(bool matches) const {
  agree({!matches,
         "the lists of shared dofs do not match between the processes; make the domain by "
         "createMat(Th, C, Pk) of macro_ddm.idp, Th being made by buildDmesh or createMat"});
}

std::map<int, int> Domain::told(const std::map<int, int>& mine) const {
  std::vector<int> out(size_, -1), in(size_);
  for (const auto& [rank, number] : mine) out[rank] = number;
  MPI_Alltoall(out.data(), 1, MPI_INT, in.data(), 1, MPI_INT, *communicator_);
  std::map<int, int> theirs;
  for (int r = 0; r < size_; ++r)
    if (in[r] >= 0) theirs[r] = in[r];
  return theirs;
}

/// Each list has its counterpart of the same length: before anything is sent along them.
void Domain::check_neighbours(const std::vector<Neighbour>& neighbours) const {
  std::map<int, int> mine;
  bool matches = true;
  for (const Neighbour& n : neighbours) {
    for (Index dof : n.shared) matches = matches && dof >= 0 && dof < dofs();
    const bool legal = n.rank >= 0 && n.rank < size_ && n.rank != rank_;
    if (!legal || !mine.emplace(n.rank, static_cast<int>(n.shared.size())).second) matches = false;
  }
  require_match(told(mine) == mine && matches);
}

void Domain::choose_owners(const std::vector<Neighbour>& neighbours, const Vector& D) {
  Letters<Real> out;
  for (const Neighbour& n : neighbours) {
    std::vector<Real>& shares = out[n.rank];
    for (Index dof : n.shared) shares.push_back(D[dof]);
  }
  const Letters<Real> in = delivered(out);
  std::vector<int> owner(dofs(), rank_);
  Vector most = D;
  for (const auto& [rank, shared] : neighbours)
    for (std::size_t s = 0; s < shared.size(); ++s) {
      const Index dof = shared[s];
      const Real share = in.at(rank)[s];
      if (share < most[dof] || (share == most[dof] && rank > owner[dof])) continue;
      most[dof] = share;
      owner[dof] = rank;
    }
  for (Index dof = 0; dof < dofs(); ++dof) owned_[dof] = owner[dof] == rank_;
  make_exchanges(neighbours, owner);
}

/// Where three processes share a dof and two of them do not know it of each other, they may take
/// different ones for its owner.
void Domain::make_exchanges(const std::vector<Neighbour>& neighbours,
                            const std::vector<int>& owner) {
  std::map<int, int> sent, received;
  for (const Neighbour& n : neighbours) {
    Exchange& e = exchanges_[n.rank];
    for (Index dof : n.shared) {
      if (owner[dof] == rank_) e.sent.push_back(dof);
      if (owner[dof] == n.rank) e.received.push_back(dof);
    }
    sent[n.rank] = static_cast<int>(e.sent.size());
    received[n.rank] = static_cast<int>(e.received.size());
  }
  require_match(told(sent) == received);
}

/// Both processes have their lists in the same order. What a third one owns is sent by it alone.
void Domain::update(Eigen::Ref<Eigen::MatrixXd> values) const {
  std::map<int, Eigen::MatrixXd> out, in;
  for (const auto& [rank, e] : exchanges_) {
    if (!e.sent.empty()) out[rank] = values(Eigen::all, e.sent);
    if (!e.received.empty()) in[rank].resize(values.rows(), Eigen::Index(e.received.size()));
  }
  exchange(out, in);
  for (const auto& [rank, columns] : in) values(Eigen::all, exchanges_.at(rank).received) = columns;
}

void Domain::update(Vector& values) const {
  update(Eigen::Map<Eigen::MatrixXd>(values.data(), 1, values.size()));
}

void Domain::sum(Real* values, Index count) const {
  MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_SUM, *communicator_);
}

void Domain::largest(Real* values, Index count) const {
  MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_MAX, *communicator_);
}

Real Domain::sum_before(Real value) const {
  Real before = 0;
  MPI_Exscan(&value, &before, 1, MPI_DOUBLE, MPI_SUM, *communicator_);
  return rank_ == 0 ? 0 : before;
}

/// Two by two, then the results two by two.
Vector Domain::combined(Vector own,
                        const std::function<Vector(const Vector&, const Vector&)>& both) const {
  const int count = static_cast<int>(own.size());
  for (int step = 1; step < size_; step *= 2) {
    if (rank_ % (2 * step) == step) {
      MPI_Send(own.data(), count, MPI_DOUBLE, rank_ - step, message_tag, *communicator_);
      break;
    }
    if (rank_ + step >= size_) continue;
    Vector other(count);
    MPI_Recv(other.data(), count, MPI_DOUBLE, rank_ + step, message_tag, *communicator_,
             MPI_STATUS_IGNORE);
    own = both(own, other);
  }
  MPI_Bcast(own.data(), count, MPI_DOUBLE, 0, *communicator_);
  return own;
}

void Domain::agree(const Attempt& own_part) const {
  int least[] = {own_part.failed ? rank_ : size_, own_part.failed};
  MPI_Allreduce(MPI_IN_PLACE, least, 2, MPI_INT, MPI_MIN, *communicator_);
  if (least[0] < size_) throw_together(*communicator_, least[0], least[1] != 0, own_part.message);
}

/// By what dofs are here and at their owners.
Bodies join_parts(const Domain& domain, const std::vector<Index>& dofs, const Bodies& parts) {
  Real count = parts.count;
  domain.sum(&count, 1);
  const Index first = static_cast<Index>(domain.sum_before(parts.count));
  Vector part = Vector::Constant(domain.dofs(), -1);  // as all processes number them
  for (std::size_t k = 0; k < dofs.size(); ++k) part[dofs[k]] = first + parts.of[k];
  const Vector of_owner = domain.of_owners(part);
  std::vector<std::array<Index, 2>> pairs;
  for (Index i : dofs)
    if (of_owner[i] != part[i])
      pairs.push_back({static_cast<Index>(of_owner[i]), static_cast<Index>(part[i])});
  sort_once(pairs);
  Groups groups(static_cast<Index>(count));
  for (const auto& [p, q] : domain.gathered(pairs)) groups.join(p, q);
  Bodies wholes;
  std::vector<Index> whole;  // of each part
  for (Index p = 0; p < count; ++p)
    whole.push_back(groups.of(p) == p ? wholes.count++ : whole[groups.of(p)]);
  for (Index p : parts.of) wholes.of.push_back(whole[first + p]);
  return wholes;
}

}  // namespace frictioncg
