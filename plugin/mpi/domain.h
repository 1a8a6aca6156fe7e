#pragma once
#include <mpi.h>

#include "meeting.h"

namespace frictioncg {

/// The part of a distributed space that this process has, with overlap, and whom it shares its
/// dofs with: what createMat of FreeFEM's macro_ddm.idp hands to constructor(...).
///
/// A dof belongs to the process with the largest share D in the partition of unity, ties to the
/// lowest rank: all elements around it are there, and its row of the local matrix is complete.
class Domain {
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
  bool owns(Index dof) const { return owned_[dof] != 0; }
  const char* owned() const { return owned_.data(); }  ///< dofs()

  /// `width` numbers for each shared dof go from its owner to all others.
  using Pack = std::function<void(Index dof, Real* values)>;
  using Unpack = std::function<void(Index dof, const Real* values)>;
  void update(Index width, const Pack& pack, const Unpack& unpack) const;
  void update(Eigen::Ref<Eigen::MatrixXd> values) const;  ///< a column each dof
  void update(Vector& values) const;                      ///< one value a dof
  void least(Vector& values) const;  ///< of what all processes have for a dof, on all of them
  /// Lists of any length, from the owner of dofs to each process that shares them. What arrives.
  using PackList = std::function<std::vector<Real>(const std::vector<Index>& dofs)>;
  std::vector<Real> lists(const PackList& pack) const;

  void sum(Real* values, Index count) const;
  void largest(Real* values, Index count) const;
  Real largest(Real value) const;
  Real sum_before(Real value) const;  ///< over the processes of lower rank
  Vector gathered(const Vector& own) const;
  /// As in Processes; the same on all.
  Vector combined(Vector own,
                  const std::function<Vector(const Vector&, const Vector&)>& both) const;
  /// Numbers to some processes, by rank, and those from others.
  using Letters = std::map<int, std::vector<Real>>;
  Letters delivered(const Letters& out) const;

  /// Runs what one process does by itself. Where it throws on any of them, all throw IllegalInput
  /// with the message of the lowest rank that failed.
  void agree(const std::function<void()>& body) const;

 private:
  Domain(const Domain&) = default;
  /// Of the number that each process has for some others, by rank, those that others have for it.
  std::map<int, int> told(const std::map<int, int>& mine) const;
  using List = std::vector<Index> Exchange::*;
  void transfer(List from, List to, Index width, const Pack& pack, const Unpack& unpack) const;
  void require_match(bool matches) const;
  void check_neighbours(const std::vector<Neighbour>& neighbours) const;
  void choose_owners(const std::vector<Neighbour>& neighbours, const Vector& D);
  void make_exchanges(const std::vector<Neighbour>& neighbours, const std::vector<int>& owner);
  void fail_together(bool failed, const std::string& message) const;
  void add(const std::map<int, Exchange>& more, Index offset);

  std::shared_ptr<Meeting> meeting_;
  std::string name_;
  std::shared_ptr<const MPI_Comm> communicator_;
  int rank_ = 0, size_ = 1;
  Index first_ = 0;
  std::vector<char> owned_;            ///< n
  std::map<int, Exchange> exchanges_;  ///< by rank
};

}  // namespace frictioncg
