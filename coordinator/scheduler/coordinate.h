// Hands blocks to ranks and collects the results. Rank 0 coordinates; it trains only when it is the only rank.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "coordinator/scheduler/block_queue.h"
#include "coordinator/scheduler/field_job.h"
#include "core/comm/communicator.h"

namespace skyquilt::coordinator {

struct CoordinateHooks {
  std::function<double()> now_s;  // the clock the queue's deadline refers to
  std::function<void(const FieldJob&, int rank)> handed_out;
  std::function<void(const FieldJob&, const worker::TrainStatus&)> status;
  std::function<void(const FieldOutcome&, bool retried)> finished;
  std::function<void(const FieldJob&, int from_rank, int to_rank)> moved = nullptr;
};

// Trains all blocks of the queue: on the other ranks, or with `alone` in this process when there are none. A rank without work continues the block
// of a slow rank from its checkpoint (only when BlockQueue::HasFixedSteps).
// Throws base::Interrupted, or base::InputError or base::UsageError of a worker; all ranks have saved and stopped then.
// Blocks that failed are in queue.outcomes() with their reason.
void CoordinateBlocks(comm::Communicator& comm, BlockQueue& queue, const FieldTrainer& alone, int alone_threads, const CoordinateHooks& hooks);

// Throws base::Interrupted, base::InputError or base::UsageError for an outcome of that kind; returns for the others. `who`: the rank, for messages.
void ThrowIfEndsCommand(const FieldOutcome& outcome, const std::string& who = "");

// A worker rank's side: trains the jobs it receives until kTagDone. checkpoints: the folder of <name of the job>.h5, of which rank 0 is told what
// this machine sees there; empty: it is not told.
void ServeBlocks(comm::Communicator& comm, const FieldTrainer& trainer, int threads, const std::filesystem::path& checkpoints = {});

}  // namespace skyquilt::coordinator
