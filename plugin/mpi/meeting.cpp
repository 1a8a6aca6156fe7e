#include "meeting.h"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <thread>

namespace frictioncg {

namespace {

constexpr unsigned patience = 5;  ///< [s] with MPI, and with others that are not to be expected

/// What fails in MPI itself, also where PETSc calls it: PETSc may crash while it looks for words.
void end_by_mpi(MPI_Comm* communicator, int* error, ...) {
  char text[MPI_MAX_ERROR_STRING] = "";
  int length = 0;
  MPI_Error_string(*error, text, &length);
  end_all(*communicator, "MPI", text);
}

/// The text that process `root` has.   Collective.
std::string broadcast(MPI_Comm communicator, int root, std::string text) {
  int length = static_cast<int>(text.size());
  MPI_Bcast(&length, 1, MPI_INT, root, communicator);
  text.resize(length);
  MPI_Bcast(&text[0], length, MPI_CHAR, root, communicator);
  return text;
}

/// MPI frees what hangs on its own communicators while it ends: too late for a communicator.
int forget_meeting(MPI_Comm parent, int, void* meeting, void*) {
  if (parent != MPI_COMM_WORLD && parent != MPI_COMM_SELF)
    delete static_cast<std::shared_ptr<Meeting>*>(meeting);
  return MPI_SUCCESS;
}

bool arrive_in_time(MPI_Request& request) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::seconds(patience);
  for (int all_are_here = 0; Clock::now() < end;) {
    MPI_Test(&request, &all_are_here, MPI_STATUS_IGNORE);
    if (all_are_here) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

}  // namespace

void end_all(MPI_Comm communicator, const char* name, const char* message) noexcept {
  int started = 0, rank = 0;
  MPI_Initialized(&started);
  if (started) MPI_Comm_rank(communicator, &rank);
  static bool ending = false;  // MPI may fail once more on the way
  if (ending) std::_Exit(EXIT_FAILURE);
  ending = true;
  std::fprintf(stderr, "%s: %s (rank %d)\n", name, message, rank);
  std::signal(SIGALRM, SIG_DFL);
  alarm(patience);
  if (started) MPI_Abort(communicator, EXIT_FAILURE);
  std::_Exit(EXIT_FAILURE);
}

/// The handler is inherited by what PETSc duplicates in turn.
MPI_Comm duplicate(MPI_Comm communicator) {
  MPI_Comm copy;
  MPI_Errhandler handler;
  MPI_Comm_dup(communicator, &copy);
  MPI_Comm_create_errhandler(end_by_mpi, &handler);
  MPI_Comm_set_errhandler(copy, handler);
  MPI_Errhandler_free(&handler);
  return copy;
}

Attempt attempt(const std::function<void()>& body) {
  try {
    body();
    return {};
  } catch (const IllegalInput& e) {
    return {true, e.what()};
  } catch (const std::bad_alloc&) {
    return {true, not_enough_memory};
  } catch (const std::exception& e) {
    return {true, std::string("internal error: ") + e.what()};
  } catch (...) {
    return {true, "an expression of the script failed"};
  }
}

void throw_together(MPI_Comm communicator, int first, bool everywhere, const std::string& message) {
  const std::string text = broadcast(communicator, first, message);
  throw IllegalInput(everywhere ? text : text + " (on rank " + std::to_string(first) + ")");
}

Meeting::~Meeting() {
  int ended = 0;
  MPI_Finalized(&ended);
  if (!ended) MPI_Comm_free(&communicator_);
}

std::shared_ptr<Meeting> Meeting::of(MPI_Comm parent) {
  static int key = MPI_KEYVAL_INVALID;
  if (key == MPI_KEYVAL_INVALID)
    MPI_Comm_create_keyval(MPI_COMM_NULL_COPY_FN, forget_meeting, &key, nullptr);
  void* found = nullptr;
  int exists = 0;
  MPI_Comm_get_attr(parent, key, &found, &exists);
  if (exists) return *static_cast<std::shared_ptr<Meeting>*>(found);
  const auto made = std::make_shared<Meeting>(parent);
  MPI_Comm_set_attr(parent, key, new std::shared_ptr<Meeting>(made));
  return made;
}

/// The least and the largest key of each item, and who has them; then the least of those who have
/// failed, and whether all have. Keys are whole numbers that a double holds.
std::vector<Comparison::Extreme> Comparison::extremes(int rank, const Attempt& own_part) const {
  constexpr std::size_t most = std::size_t(1) << 52;
  std::vector<Extreme> all;
  for (const Item& item : items_) {
    const std::size_t hash = std::hash<std::string>()(item.value) % most;
    const double key = item.value.empty() ? 0 : 1 + double(hash);
    all.push_back({key, rank});
    all.push_back({-key, rank});
  }
  all.push_back({own_part.failed ? 0. : 1., rank});
  all.push_back({own_part.failed ? 1. : 0., rank});
  return all;
}

void Comparison::refuse(MPI_Comm communicator, const Item& item, int a, int b) const {
  if (a > b) std::swap(a, b);
  const auto words = [&](int rank) {
    const std::string value = broadcast(communicator, rank, item.value);
    return (value.empty() ? "not given" : value) + " on rank " + std::to_string(rank);
  };
  const std::string of_a = words(a), of_b = words(b);
  throw IllegalInput(std::string(item.name) + " is " + of_a + ", but " + of_b +
                     "; make the same call on all processes");
}

void Comparison::compare(const char* name, const Meeting& meeting, const Attempt& own_part,
                         bool patient) const {
  const MPI_Comm communicator = meeting.communicator();
  int rank;
  MPI_Comm_rank(communicator, &rank);
  std::vector<Extreme> all = extremes(rank, own_part);
  MPI_Request request;
  MPI_Iallreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_DOUBLE_INT, MPI_MINLOC,
                 communicator, &request);
  if (patient)
    MPI_Wait(&request, MPI_STATUS_IGNORE);
  else if (!arrive_in_time(request))
    end_all(communicator, name, own_part.message.c_str());
  const auto check = [&](std::size_t first, std::size_t end) {
    for (std::size_t k = first; k < end; ++k)
      if (all[2 * k].key != -all[2 * k + 1].key)
        refuse(communicator, items_[k], all[2 * k].rank, all[2 * k + 1].rank);
  };
  check(0, before_);
  const Extreme &failed = all[2 * items_.size()], &everywhere = all[2 * items_.size() + 1];
  if (failed.key == 0)
    throw_together(communicator, failed.rank, everywhere.key != 0, own_part.message);
  check(before_, items_.size());
}

}  // namespace frictioncg
