#pragma once
#include <mpi.h>

#include <map>
#include <vector>

#include "types.h"

namespace frictioncg {

constexpr int message_tag = 1412;

struct Message {
  int rank;
  std::vector<Real> values;
};

/// All messages out and in at once; the sizes of those received are known.
void exchange(MPI_Comm communicator, const std::vector<Message>& out, std::vector<Message>& in);

/// Of the number that each process has for some others, by rank, those that others have for this
/// one: it learns from the messages alone who they are. They have arrived where all processes know
/// theirs received. Before the next search all have to meet.   Collective.
std::map<int, int> addressed(MPI_Comm communicator, const std::map<int, int>& mine);

}  // namespace frictioncg
