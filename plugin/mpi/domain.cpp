#include "domain.h"

namespace frictioncg {

namespace {

constexpr int message_tag = 1412;

/// All letters out and in at once; the sizes of those received are known.
void exchange(MPI_Comm communicator, const Domain::Letters& out, Domain::Letters& in) {
  std::vector<MPI_Request> requests;
  for (auto& [rank, values] : in)
    MPI_Irecv(values.data(), static_cast<int>(values.size()), MPI_DOUBLE, rank, message_tag,
              communicator, &requests.emplace_back());
  for (const auto& [rank, values] : out)
    MPI_Isend(values.data(), static_cast<int>(values.size()), MPI_DOUBLE, rank, message_tag,
              communicator, &requests.emplace_back());
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

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
  fail_together(!matches,
                "the lists of shared dofs do not match between the processes; make the domain by "
                "createMat(Th, C, Pk) of macro_ddm.idp, Th being made by buildDmesh or createMat");
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
  Letters out, in;
  for (const Neighbour& n : neighbours) {
    std::vector<Real>& shares = out[n.rank];
    for (Index dof : n.shared) shares.push_back(D[dof]);
    in[n.rank].resize(n.shared.size());
  }
  exchange(*communicator_, out, in);
  std::vector<int> owner(dofs(), rank_);
  Vector most = D;
  for (const auto& [rank, shared] : neighbours)
    for (std::size_t s = 0; s < shared.size(); ++s) {
      const Index dof = shared[s];
      const Real share = in[rank][s];
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

/// Both processes have their lists in the same order.
void Domain::transfer(List from, List to, Index width, const Pack& pack,
                      const Unpack& unpack) const {
  Letters out, in;
  for (const auto& [rank, e] : exchanges_) {
    const std::vector<Index>&sent = e.*from, &received = e.*to;
    if (!received.empty()) in[rank].resize(received.size() * width);
    if (sent.empty()) continue;
    std::vector<Real>& values = out[rank];
    values.resize(sent.size() * width);
    for (std::size_t s = 0; s < sent.size(); ++s) pack(sent[s], &values[s * width]);
  }
  exchange(*communicator_, out, in);
  for (const auto& [rank, values] : in) {
    const std::vector<Index>& received = exchanges_.at(rank).*to;
    for (std::size_t s = 0; s < received.size(); ++s) unpack(received[s], &values[s * width]);
  }
}

/// What a third process owns is sent by it alone.
void Domain::update(Index width, const Pack& pack, const Unpack& unpack) const {
  transfer(&Exchange::sent, &Exchange::received, width, pack, unpack);
}

void Domain::update(Eigen::Ref<Eigen::MatrixXd> values) const {
  const Index width = static_cast<Index>(values.rows());
  update(
      width, [&](Index dof, Real* out) { std::copy_n(&values(0, dof), width, out); },
      [&](Index dof, const Real* in) { std::copy_n(in, width, &values(0, dof)); });
}

void Domain::update(Vector& values) const {
  update(Eigen::Map<Eigen::MatrixXd>(values.data(), 1, values.size()));
}

/// What others have goes to the owners first.
void Domain::least(Vector& values) const {
  transfer(
      &Exchange::received, &Exchange::sent, 1, [&](Index dof, Real* out) { *out = values[dof]; },
      [&](Index dof, const Real* in) { values[dof] = std::min(values[dof], *in); });
  update(values);
}

std::vector<Real> Domain::lists(const PackList& pack) const {
  Letters out;
  for (const auto& [rank, e] : exchanges_)
    if (!e.sent.empty()) out[rank] = pack(e.sent);
  std::vector<Real> all;
  for (const auto& [rank, list] : delivered(out)) all.insert(all.end(), list.begin(), list.end());
  return all;
}

void Domain::sum(Real* values, Index count) const {
  MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_SUM, *communicator_);
}

void Domain::largest(Real* values, Index count) const {
  MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_MAX, *communicator_);
}

Real Domain::largest(Real value) const {
  largest(&value, 1);
  return value;
}

Real Domain::sum_before(Real value) const {
  Real before = 0;
  MPI_Exscan(&value, &before, 1, MPI_DOUBLE, MPI_SUM, *communicator_);
  return rank_ == 0 ? 0 : before;
}

Vector Domain::gathered(const Vector& own) const {
  const int count = static_cast<int>(own.size());
  std::vector<int> counts(size_), starts(size_, 0);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, *communicator_);
  for (int r = 1; r < size_; ++r) starts[r] = starts[r - 1] + counts[r - 1];
  Vector all(starts.back() + counts.back());
  MPI_Allgatherv(own.data(), count, MPI_DOUBLE, all.data(), counts.data(), starts.data(),
                 MPI_DOUBLE, *communicator_);
  return all;
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

/// Their lengths first.
Domain::Letters Domain::delivered(const Letters& out) const {
  std::map<int, int> lengths;
  Letters in;
  for (const auto& [rank, values] : out) lengths[rank] = static_cast<int>(values.size());
  for (const auto& [rank, length] : told(lengths)) in[rank].resize(length);
  exchange(*communicator_, out, in);
  return in;
}

void Domain::agree(const std::function<void()>& body) const {
  const Attempt own_part = attempt(body);
  fail_together(own_part.failed, own_part.message);
}

void Domain::fail_together(bool failed, const std::string& message) const {
  int least[] = {failed ? rank_ : size_, failed};
  MPI_Allreduce(MPI_IN_PLACE, least, 2, MPI_INT, MPI_MIN, *communicator_);
  if (least[0] < size_) throw_together(*communicator_, least[0], least[1] != 0, message);
}

}  // namespace frictioncg
