// What every rank but the first does from start to end.
#pragma once

#include "core/comm/communicator.h"

namespace skyquilt::coordinator {

// Serves rank 0's trainings and renderings until ReleaseRanks. Never throws for what one of them met.
void ServeRank(comm::Communicator& comm);
// Called on rank 0 before it ends, whatever happened.
void ReleaseRanks(comm::Communicator& comm);

}  // namespace skyquilt::coordinator
