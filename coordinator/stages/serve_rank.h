// The main loop of every rank but rank 0.
#pragma once

#include "core/comm/communicator.h"

namespace skyquilt::coordinator {

// Takes part in rank 0's searches for poses, trainings and renderings until ReleaseRanks. Their errors are reported to rank 0 and not thrown.
void ServeRank(comm::Communicator& comm);
// Ends the loop on all other ranks. Rank 0 must call it before it ends, also after an error.
void ReleaseRanks(comm::Communicator& comm);

}  // namespace skyquilt::coordinator
