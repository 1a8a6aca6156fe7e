#pragma once
#include <mpi.h>

#include "types.h"

namespace frictioncg {

constexpr const char* not_enough_memory = "not enough memory for this problem";

/// Ends all processes of the communicator, with one message. Needs no memory itself.
[[noreturn]] void end_all(MPI_Comm communicator, const char* name, const char* message) noexcept;

/// A copy for messages of our own, that ends all processes where MPI itself fails.
MPI_Comm duplicate(MPI_Comm communicator);

/// How a part of a call ended that one process does by itself: in words, where it failed.
struct Attempt {
  bool failed = false;
  std::string message;
};
Attempt attempt(const std::function<void()>& body);

/// Throws IllegalInput with what process `first` has to say, on all: that it was this one, where
/// not all have failed.   Collective.
[[noreturn]] void throw_together(MPI_Comm communicator, int first, bool everywhere,
                                 const std::string& message);

/// Where the processes of a communicator meet when a call begins, whichever of its domains each of
/// them has named.
class Meeting {
 public:
  explicit Meeting(MPI_Comm parent);
  ~Meeting();
  Meeting(const Meeting&) = delete;
  Meeting& operator=(const Meeting&) = delete;

  /// The one of a communicator.   Collective the first time.
  static std::shared_ptr<Meeting> of(MPI_Comm parent);
  MPI_Comm communicator() const { return communicator_; }
  int rank() const { return rank_; }
  /// For what all of them make together: the same on all.
  int next_number() { return ++made_; }

  /// This process has solved a problem of its own, which the others need not know.
  void stay_away();
  /// Nobody waits any more: what stay_away has left is given up, before MPI ends.
  void end_answers();
  /// Waits until all are here, as a collective operation tells. Ends them all where one that has
  /// stayed away waits elsewhere, in MPI, and cannot come: it answers while it is there, and not
  /// while it is at work. failure: what is wrong with the call on this process, or ""; said after
  /// some seconds, where it should not be here itself, not `patient`, as the end of all of them.
  void begin(const char* name, MPI_Request& here, const std::string& failure, bool patient);

 private:
  void wait_for_all(const char* name, MPI_Request& here, const std::string& failure);
  void note(const char* name, const std::string& words) const;
  void say(int tag) const;
  bool has_word(int tag) const;
  void forget_words(int tag);

  MPI_Comm communicator_;
  int made_ = 0;
  int rank_ = 0, before_ = 0, after_ = 0;  ///< and those of the neighbours on a ring
  std::array<MPI_Request, 10> answers_;    ///< as many as tell that a process waits, one a second
};

/// What a call is on this process, in words, compared with what it is on the others: the same items
/// in the same order on all, or others from the first on.
class Comparison {
 public:
  static constexpr std::size_t most_items = 64;
  /// No value: the item is not given.
  void add(const char* item, std::string value) { items_.push_back({item, std::move(value)}); }
  /// What was added before is compared before the outcomes, and what is added after, after them.
  void mark() { before_ = items_.size(); }

  /// Throws IllegalInput on all processes where an item differs, or any of them has failed.
  /// patient: false on a process that knows it should not be here. Where the others do not come
  /// within some seconds it ends them all.   Collective.
  void compare(const char* name, Meeting& meeting, const Attempt& own_part, bool patient) const;

 private:
  struct Item {
    const char* name;
    std::string value;
  };
  struct Extreme {  ///< as MPI_DOUBLE_INT
    double key;
    int rank;
  };
  std::vector<Extreme> extremes(int rank, const Attempt& own_part) const;
  [[noreturn]] void refuse(MPI_Comm communicator, const Item& item, int a, int b) const;

  std::vector<Item> items_;
  std::size_t before_ = 0;
};

/// While all processes load the plugin. False where some have not within half a minute: FreeFEM's
/// own end of a process that could not waits for the others.
bool meet_at_load();
/// At the end of the script. Where others still wait in a call, both are told; then they may come.
/// Collective.
void meet_at_end(const char* name);

}  // namespace frictioncg
