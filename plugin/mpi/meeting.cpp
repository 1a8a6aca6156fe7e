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
constexpr int arrived = 1, away = 2, knock = 3;  ///< what processes say to each other on a ring
constexpr unsigned loading = 30;                 ///< [s] of a plugin, from a slow disk
constexpr unsigned suspicious = 30;              ///< [s] of others at work

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

bool arrive_in_time(MPI_Request& request, unsigned seconds) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::seconds(seconds);
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

Meeting::Meeting(MPI_Comm parent) : communicator_(duplicate(parent)) {
  int size;
  MPI_Comm_size(communicator_, &size);
  MPI_Comm_rank(communicator_, &rank_);
  before_ = (rank_ + size - 1) % size;
  after_ = (rank_ + 1) % size;
  answers_.fill(MPI_REQUEST_NULL);
}

Meeting::~Meeting() {
  int ended = 0;
  MPI_Finalized(&ended);
  if (ended) return;
  end_answers();
  MPI_Comm_free(&communicator_);
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

/// To the process after this one on the ring.
void Meeting::say(int tag) const {
  MPI_Request sent;
  MPI_Isend(nullptr, 0, MPI_BYTE, after_, tag, communicator_, &sent);
  MPI_Request_free(&sent);
}
/// Whether the process before this one has said so.
bool Meeting::has_word(int tag) const {
  int found = 0;
  MPI_Iprobe(before_, tag, communicator_, &found, MPI_STATUS_IGNORE);
  return found;
}
void Meeting::forget_words(int tag) {
  while (has_word(tag))
    MPI_Recv(nullptr, 0, MPI_BYTE, before_, tag, communicator_, MPI_STATUS_IGNORE);
}

void Meeting::stay_away() {
  forget_words(away);
  say(away);
  for (MPI_Request& answer : answers_) {
    int free = 1;
    if (answer != MPI_REQUEST_NULL) MPI_Test(&answer, &free, MPI_STATUS_IGNORE);
    if (free) MPI_Irecv(nullptr, 0, MPI_BYTE, after_, knock, communicator_, &answer);
  }
}

void Meeting::end_answers() {
  for (MPI_Request& answer : answers_) {
    if (answer == MPI_REQUEST_NULL) continue;
    MPI_Cancel(&answer);
    MPI_Wait(&answer, MPI_STATUS_IGNORE);
  }
}

void Meeting::note(const char* name, const std::string& words) const {
  std::fprintf(stderr, "%s: note: %s (rank %d)\n", name, words.c_str(), rank_);
}

void Meeting::wait_for_all(const char* name, MPI_Request& here, const std::string& failure) {
  unsigned answered = 0, waited = 0;
  for (unsigned seconds = patience; !arrive_in_time(here, seconds); seconds = 1) {
    waited += seconds;
    if (waited == patience && !failure.empty())
      note(name, failure + "; this process waits for the others to come here");
    if (waited == suspicious)
      note(name,
           "for half a minute this process has waited for others to come here; those that are not "
           "at work never will: make the same calls on all processes");
    if (has_word(arrived) || !has_word(away)) continue;
    MPI_Request question;
    MPI_Issend(nullptr, 0, MPI_BYTE, before_, knock, communicator_, &question);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    int done = 0;
    MPI_Test(&question, &done, MPI_STATUS_IGNORE);
    if (!done) MPI_Request_free(&question);
    answered = done ? answered + 1 : 0;
    if (answered < answers_.size()) continue;
    const std::string text = "rank " + std::to_string(before_) +
                             " has solved a problem of its own, by a contactdomain that is not "
                             "set, and waits elsewhere; make the same call on all processes";
    end_all(communicator_, name, text.c_str());
  }
}

void Meeting::begin(const char* name, MPI_Request& here, const std::string& failure, bool patient) {
  say(arrived);
  if (patient)
    wait_for_all(name, here, failure);
  else if (!arrive_in_time(here, patience))
    end_all(communicator_, name, failure.c_str());
  MPI_Recv(nullptr, 0, MPI_BYTE, before_, arrived, communicator_, MPI_STATUS_IGNORE);
  forget_words(away);
}

/// The least of those who have failed, and whether all have; then the least and the largest key of
/// each item, and who has them. Keys are whole numbers that a double holds.
std::vector<Comparison::Extreme> Comparison::extremes(int rank, const Attempt& own_part) const {
  constexpr std::size_t most = std::size_t(1) << 52;
  std::vector<Extreme> all{{own_part.failed ? 0. : 1., rank}, {own_part.failed ? 1. : 0., rank}};
  for (const Item& item : items_) {
    const std::size_t hash = std::hash<std::string>()(item.value) % most;
    const double key = item.value.empty() ? 0 : 1 + double(hash);
    all.push_back({key, rank});
    all.push_back({-key, rank});
  }
  all.resize(2 * (1 + most_items), {0, rank});
  return all;
}

void Comparison::refuse(MPI_Comm communicator, const Item& item, int a, int b) const {
  if (a > b) std::swap(a, b);
  const auto words = [&](int rank) {
    const std::string value = broadcast(communicator, rank, item.value);
    return (value.empty() ? "not given" : value) + " on rank " + std::to_string(rank);
  };
  const std::string of_a = words(a), of_b = words(b);
  frictioncg::refuse(item.name, " is ", of_a, ", but ", of_b,
                     "; make the same call on all processes");
}

void Comparison::compare(const char* name, Meeting& meeting, const Attempt& own_part,
                         bool patient) const {
  const MPI_Comm communicator = meeting.communicator();
  std::vector<Extreme> all = extremes(meeting.rank(), own_part);
  MPI_Request request;
  MPI_Iallreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_DOUBLE_INT, MPI_MINLOC,
                 communicator, &request);
  meeting.begin(name, request, own_part.message, patient);
  const auto check = [&](std::size_t first, std::size_t end) {
    for (std::size_t k = first; k < end; ++k)
      if (const Extreme* of = &all[2 * (k + 1)]; of[0].key != -of[1].key)
        refuse(communicator, items_[k], of[0].rank, of[1].rank);
  };
  check(0, before_);
  const Extreme &failed = all[0], &everywhere = all[1];
  if (failed.key == 0)
    throw_together(communicator, failed.rank, everywhere.key != 0, own_part.message);
  check(before_, items_.size());
}

bool meet_at_load() {
  MPI_Request request;
  MPI_Ibarrier(MPI_COMM_WORLD, &request);
  if (!arrive_in_time(request, loading)) return false;
  Meeting::of(MPI_COMM_WORLD);
  return true;
}

void meet_at_end(const char* name) {
  Comparison last;
  last.add("the call", "the end of the script");
  last.mark();
  const auto meeting = Meeting::of(MPI_COMM_WORLD);
  for (bool together = false; !together;) try {
      last.compare(name, *meeting, {}, true);
      together = true;
    } catch (const IllegalInput& e) {
      if (meeting->rank() == 0) std::fprintf(stderr, "%s: %s\n", name, e.what());
    }
  meeting->end_answers();
}

}  // namespace frictioncg
