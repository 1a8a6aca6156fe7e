#include "domain.h"

namespace frictioncg {

namespace {

constexpr int tag = 1412;  ///< of messages between neighbours

struct Message {
  int rank;
  std::vector<Real> values;
};

/// All messages out and in at once; the sizes of those received are known.
void exchange(MPI_Comm communicator, const std::vector<Message>& out, std::vector<Message>& in) {
  std::vector<MPI_Request> requests;
  requests.reserve(in.size() + out.size());
  for (Message& m : in) {
    requests.emplace_back();
    MPI_Irecv(m.values.data(), static_cast<int>(m.values.size()), MPI_DOUBLE, m.rank, tag,
              communicator, &requests.back());
  }
  for (const Message& m : out) {
    requests.emplace_back();
    MPI_Isend(m.values.data(), static_cast<int>(m.values.size()), MPI_DOUBLE, m.rank, tag,
              communicator, &requests.back());
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

}  // namespace

Domain::Domain(MPI_Comm communicator, std::vector<Neighbour> neighbours, const Vector& D)
    : meeting_(Meeting::of(communicator)),
      number_(meeting_->next_number()),
      communicator_(duplicate(communicator)),
      owned_(D.size(), 1) {
  MPI_Comm_rank(communicator_, &rank_);
  MPI_Comm_size(communicator_, &size_);
  check_neighbours(neighbours);
  choose_owners(neighbours, D);
}

Domain::~Domain() {
  int ended = 0;
  MPI_Finalized(&ended);
  if (!ended) MPI_Comm_free(&communicator_);
}

/// One message of all processes where on any of them something is wrong with the lists.
void Domain::require_match(bool matches) const {
  fail_together(!matches,
                "the lists of shared dofs do not match between the processes; make the domain by "
                "createMat(Th, C, Pk) of macro_ddm.idp, Th being made by buildDmesh or createMat");
}

/// Of what each process has for each other one (size), what they have for this one.
std::vector<int> Domain::counterpart(const std::vector<int>& mine) const {
  std::vector<int> theirs(size_);
  MPI_Alltoall(mine.data(), 1, MPI_INT, theirs.data(), 1, MPI_INT, communicator_);
  return theirs;
}

/// Each list has its counterpart of the same length: before anything is sent along them.
void Domain::check_neighbours(const std::vector<Neighbour>& neighbours) const {
  std::vector<int> mine(size_, 0);
  bool matches = true;
  for (const Neighbour& n : neighbours) {
    const bool legal = n.rank >= 0 && n.rank < size_ && n.rank != rank_;
    matches = matches && legal;
    if (legal) mine[n.rank] = static_cast<int>(n.shared.size());
    for (Index dof : n.shared) matches = matches && dof >= 0 && dof < dofs();
  }
  require_match(counterpart(mine) == mine && matches);
}

void Domain::choose_owners(const std::vector<Neighbour>& neighbours, const Vector& D) {
  std::vector<Message> out, in;
  for (const Neighbour& n : neighbours) {
    out.push_back({n.rank, {}});
    for (Index dof : n.shared) out.back().values.push_back(D[dof]);
    in.push_back({n.rank, std::vector<Real>(n.shared.size())});
  }
  exchange(communicator_, out, in);
  std::vector<int> owner(dofs(), rank_);
  Vector most = D;
  for (std::size_t k = 0; k < neighbours.size(); ++k)
    for (std::size_t s = 0; s < neighbours[k].shared.size(); ++s) {
      const Index dof = neighbours[k].shared[s];
      const Real share = in[k].values[s];
      const int rank = neighbours[k].rank;
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
  std::vector<int> sent(size_, 0), received(size_, 0);
  for (const Neighbour& n : neighbours) {
    Exchange e{n.rank, {}, {}};
    for (Index dof : n.shared) {
      if (owner[dof] == rank_) e.sent.push_back(dof);
      if (owner[dof] == n.rank) e.received.push_back(dof);
    }
    sent[n.rank] = static_cast<int>(e.sent.size());
    received[n.rank] = static_cast<int>(e.received.size());
    exchanges_.push_back(std::move(e));
  }
  require_match(counterpart(sent) == received);
}

/// The owner's list and the receiver's have the same order; what a third process owns is sent by it
/// alone.
void Domain::update(Index width, const Pack& pack, const Unpack& unpack) const {
  std::vector<Message> out, in;
  std::vector<const Exchange*> from;
  for (const Exchange& e : exchanges_) {
    if (!e.sent.empty()) {
      out.push_back({e.rank, std::vector<Real>(e.sent.size() * width)});
      for (std::size_t s = 0; s < e.sent.size(); ++s)
        pack(e.sent[s], &out.back().values[s * width]);
    }
    if (e.received.empty()) continue;
    in.push_back({e.rank, std::vector<Real>(e.received.size() * width)});
    from.push_back(&e);
  }
  exchange(communicator_, out, in);
  for (std::size_t k = 0; k < in.size(); ++k)
    for (std::size_t s = 0; s < from[k]->received.size(); ++s)
      unpack(from[k]->received[s], &in[k].values[s * width]);
}

void Domain::update(Vector& values) const {
  update(
      1, [&](Index dof, Real* value) { *value = values[dof]; },
      [&](Index dof, const Real* value) { values[dof] = *value; });
}

void Domain::sum(Real* values, Index count) const {
  MPI_Allreduce(MPI_IN_PLACE, values, count, MPI_DOUBLE, MPI_SUM, communicator_);
  reductions_ += 1;
}

Real Domain::largest(Real value) const {
  MPI_Allreduce(MPI_IN_PLACE, &value, 1, MPI_DOUBLE, MPI_MAX, communicator_);
  reductions_ += 1;
  return value;
}

Vector Domain::gathered(const Vector& own) const {
  const int count = static_cast<int>(own.size());
  std::vector<int> counts(size_), starts(size_, 0);
  MPI_Allgather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, communicator_);
  for (int r = 1; r < size_; ++r) starts[r] = starts[r - 1] + counts[r - 1];
  Vector all(starts.back() + counts.back());
  MPI_Allgatherv(own.data(), count, MPI_DOUBLE, all.data(), counts.data(), starts.data(),
                 MPI_DOUBLE, communicator_);
  reductions_ += 2;
  return all;
}

void Domain::agree(const std::function<void()>& body) const {
  const Attempt own_part = attempt(body);
  fail_together(own_part.failed, own_part.message);
}

void Domain::fail_together(bool failed, const std::string& message) const {
  int least[] = {failed ? rank_ : size_, failed};
  MPI_Allreduce(MPI_IN_PLACE, least, 2, MPI_INT, MPI_MIN, communicator_);
  if (least[0] < size_) throw_together(communicator_, least[0], least[1] != 0, message);
}

}  // namespace frictioncg
