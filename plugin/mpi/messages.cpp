#include "messages.h"

namespace frictioncg {

void exchange(MPI_Comm communicator, const std::vector<Message>& out, std::vector<Message>& in) {
  std::vector<MPI_Request> requests;
  requests.reserve(in.size() + out.size());
  for (Message& m : in) {
    requests.emplace_back();
    MPI_Irecv(m.values.data(), static_cast<int>(m.values.size()), MPI_DOUBLE, m.rank, message_tag,
              communicator, &requests.back());
  }
  for (const Message& m : out) {
    requests.emplace_back();
    MPI_Isend(m.values.data(), static_cast<int>(m.values.size()), MPI_DOUBLE, m.rank, message_tag,
              communicator, &requests.back());
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

namespace {
constexpr int unexpected = message_tag + 1;  ///< of messages that nobody waits for
}

std::map<int, int> addressed(MPI_Comm communicator, const std::map<int, int>& mine) {
  std::map<int, int> theirs;
  std::vector<MPI_Request> sent;
  for (const auto& [rank, number] : mine)
    MPI_Issend(&number, 1, MPI_INT, rank, unexpected, communicator, &sent.emplace_back());
  MPI_Request all_received = MPI_REQUEST_NULL;
  for (int ended = 0, own_received = 0; !ended;) {
    int found = 0;
    MPI_Status from;
    MPI_Iprobe(MPI_ANY_SOURCE, unexpected, communicator, &found, &from);
    if (found)
      MPI_Recv(&theirs[from.MPI_SOURCE], 1, MPI_INT, from.MPI_SOURCE, unexpected, communicator,
               MPI_STATUS_IGNORE);
    if (own_received) {
      MPI_Test(&all_received, &ended, MPI_STATUS_IGNORE);
      continue;
    }
    MPI_Testall(static_cast<int>(sent.size()), sent.data(), &own_received, MPI_STATUSES_IGNORE);
    if (own_received) MPI_Ibarrier(communicator, &all_received);
  }
  return theirs;
}

}  // namespace frictioncg
