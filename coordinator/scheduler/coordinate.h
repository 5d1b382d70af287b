// Hands blocks to ranks and gathers what came of them. Rank 0 coordinates and trains only when it is alone.
#pragma once

#include <functional>
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

// Works the queue off: over the other ranks, or with `alone` in this process when there are none. A rank with nothing better to do takes over
// the block of a slow one, from its checkpoint (blocks of fixed work only).
// Throws base::Interrupted (all ranks have saved and stopped), base::InputError or base::UsageError of a worker (likewise).
// Blocks that failed are in queue.outcomes() with their reason.
void CoordinateBlocks(comm::Communicator& comm, BlockQueue& queue, const FieldTrainer& alone, int alone_threads, const CoordinateHooks& hooks);

// Throws base::Interrupted, base::InputError or base::UsageError for an outcome of that kind; returns for the others.
void ThrowIfEndsCommand(const FieldOutcome& outcome);

// A worker rank's part of one training: takes jobs until kTagDone.
void ServeBlocks(comm::Communicator& comm, const FieldTrainer& trainer, int threads);

}  // namespace skyquilt::coordinator
