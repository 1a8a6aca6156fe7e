#pragma once
#include <mpi.h>

#include "../freefem/processes.h"
#include "meeting.h"
#include "model/system.h"

namespace frictioncg {

/// The part of a distributed space that this process has, with overlap, and whom it shares its
/// dofs with: what createMat of FreeFEM's macro_ddm.idp hands to constructor(...).
///
/// A dof belongs to the process with the largest share D in the partition of unity, ties to the
/// lowest rank: all elements around it are there, and its row of the local matrix is complete.
class Domain final : public Processes {
 public:
  struct Neighbour {
    int rank;
    std::vector<Index> shared;  ///< dofs, in the same order on both sides
  };
  /// The dofs whose values go from their owner to another process.
  struct Exchange {
    std::vector<Index> sent, received;
  };

  /// D: one value for each dof of the space. Collective; throws IllegalInput on all processes where
  /// the lists of neighbours do not match.
  Domain(MPI_Comm communicator, std::vector<Neighbour> neighbours, const Vector& D);
  /// Of two spaces, whose dofs follow each other. Throws IllegalInput where other processes share
  /// them.
  Domain(const Domain& first, const Domain& second);
  /// With so many dofs of others more, behind those of the part.
  Domain(const Domain& part, Index more, const std::map<int, Exchange>& exchanges);
  Domain& operator=(const Domain&) = delete;

  MPI_Comm communicator() const { return *communicator_; }
  Meeting& meeting() const { return *meeting_; }
  /// By numbers in the order in which its processes made domains.
  const std::string& name() const { return name_; }
  Index first() const { return first_; }  ///< of two spaces, the dofs of the first, else 0
  int rank() const { return rank_; }
  int size() const { return size_; }
  Index dofs() const { return static_cast<Index>(owned_.size()); }
  bool owns(Index dof) const override { return owned_[dof] != 0; }
  const char* owned() const { return owned_.data(); }  ///< dofs()

  /// What owners have for shared dofs goes to all others.
  void update(Eigen::Ref<Eigen::MatrixXd> values) const;  ///< a column each dof
  void update(Vector& values) const;                      ///< one value a dof
  template <class Values>
  Values of_owners(Values values) const {  ///< the same, as a copy
    update(values);
    return values;
  }
  /// Items by rank: for some processes, or from them. Of any type whose bytes say all.
  template <class T>
  using Letters = std::map<int, std::vector<T>>;
  template <class T>
  Letters<T> delivered(const Letters<T>& out) const;
  /// What the owner of dofs has to say of them to each process that shares them: pack(dofs) there,
  /// a vector of T, and unpack(dofs, items) here, of the same dofs in the same order.
  template <class T, class Pack, class Unpack>
  void tell(const Pack& pack, const Unpack& unpack) const;
  /// The items of all processes, one after the other.
  template <class Items>
  Items gathered(const Items& own) const;

  void sum(Real* values, Index count) const override;
  void largest(Real* values, Index count) const override;
  using Processes::largest;
  Real sum_before(Real value) const;  ///< over the processes of lower rank
  /// As in System; the same on all.
  Vector combined(Vector own,
                  const std::function<Vector(const Vector&, const Vector&)>& both) const;

  /// Runs what one process does by itself. Where it throws on any of them, all throw IllegalInput
  /// with the message of the lowest rank that failed.
  void agree(const std::function<void()>& body) const override { agree(attempt(body)); }
  void agree(const Attempt& own_part) const;  ///< what has been run

 private:
  static constexpr int message_tag = 1412;

  Domain(const Domain&) = default;
  /// Of the number that each process has for some others, by rank, those that others have for it.
  std::map<int, int> told(const std::map<int, int>& mine) const;
  /// All letters out and in at once; the sizes of those received are known.
  template <class Items>
  void exchange(const std::map<int, Items>& out, std::map<int, Items>& in) const;
  void require_match(bool matches) const;
  void check_neighbours(const std::vector<Neighbour>& neighbours) const;
  void choose_owners(const std::vector<Neighbour>& neighbours, const Vector& D);
  void make_exchanges(const std::vector<Neighbour>& neighbours, const std::vector<int>& owner);
  void add(const std::map<int, Exchange>& more, Index offset);

  std::shared_ptr<Meeting> meeting_;
  std::string name_;
  std::shared_ptr<const MPI_Comm> communicator_;
  int rank_ = 0, size_ = 1;
  Index first_ = 0;
  std::vector<char> owned_;            ///< n
  std::map<int, Exchange> exchanges_;  ///< by rank
};

/// What hangs together on several processes, from the parts of each that hang together: those with
/// a dof in common are one whole. parts.of: of some dofs of the domain, which their owners have,
/// too, the part here that each belongs to, and their wholes in what is returned.   Collective.
Bodies join_parts(const Domain& domain, const std::vector<Index>& dofs, const Bodies& parts);

template <class Items>
int bytes_in(const Items& items) {
  return static_cast<int>(items.size() * sizeof(*items.data()));
}

template <class Items>
void Domain::exchange(const std::map<int, Items>& out, std::map<int, Items>& in) const {
  std::vector<MPI_Request> requests;
  for (auto& [rank, items] : in)
    MPI_Irecv(items.data(), bytes_in(items), MPI_BYTE, rank, message_tag, *communicator_,
              &requests.emplace_back());
  for (const auto& [rank, items] : out)
    MPI_Isend(items.data(), bytes_in(items), MPI_BYTE, rank, message_tag, *communicator_,
              &requests.emplace_back());
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

template <class T>
Domain::Letters<T> Domain::delivered(const Letters<T>& out) const {
  std::map<int, int> lengths;
  Letters<T> in;
  for (const auto& [rank, items] : out) lengths[rank] = static_cast<int>(items.size());
  for (const auto& [rank, length] : told(lengths)) in[rank].resize(length);
  exchange(out, in);
  return in;
}

template <class T, class Pack, class Unpack>
void Domain::tell(const Pack& pack, const Unpack& unpack) const {
  Letters<T> out;
  for (const auto& [rank, e] : exchanges_)
    if (!e.sent.empty()) out[rank] = pack(e.sent);
  for (const auto& [rank, items] : delivered(out)) unpack(exchanges_.at(rank).received, items);
}

template <class Items>
Items Domain::gathered(const Items& own) const {
  const int bytes = bytes_in(own);
  std::vector<int> sizes(size_), starts(size_, 0);
  MPI_Allgather(&bytes, 1, MPI_INT, sizes.data(), 1, MPI_INT, *communicator_);
  std::partial_sum(sizes.begin(), sizes.end() - 1, starts.begin() + 1);
  Items all((starts.back() + sizes.back()) / sizeof(*own.data()));
  MPI_Allgatherv(own.data(), bytes, MPI_BYTE, all.data(), sizes.data(), starts.data(), MPI_BYTE,
                 *communicator_);
  return all;
}

}  // namespace frictioncg
