// Hands blocks to ranks and gathers what came of them. Rank 0 coordinates and trains only when it is alone.
#pragma once

#include <functional>
#include <vector>

#include "coordinator/scheduler/block_queue.h"
#include "coordinator/scheduler/field_job.h"
#include "core/comm/communicator.h"

namespace skyquilt::coordinator {

// Message tags between rank 0 and the others.
enum Tag : int {
  kTagSetup = 101,    // 0 -> worker: a training begins, and what to load for it (see train_all.h)
  kTagHello = 102,    // worker -> 0: its host and what it has (see crew.h)
  kTagThreads = 103,  // 0 -> worker: how many threads it may use
  kTagJob = 104,      // 0 -> worker: FieldJob
  kTagStatus = 105,   // worker -> 0: FieldJob, newline, TrainStatus
  kTagOutcome = 106,  // worker -> 0: FieldOutcome
  kTagStop = 107,     // 0 -> worker: save and stop
  kTagDone = 108,     // 0 -> worker: no more jobs of this training or rendering
  kTagQuit = 109,     // 0 -> worker: the program ends
  kTagYield = 110,    // 0 -> worker: save and give the block back, another rank goes on with it
  kTagScene = 111,    // 0 -> worker: a rendering begins, and of which scene (see rendering/serve_rays.h)
  kTagPart = 112,     // 0 -> worker: what it may use and which blocks are whose
  kTagRays = 113,     // 0 -> worker: rays to take on
  kTagCarried = 114,  // worker -> 0: how far they came, or what went wrong
  kTagShare = 115,    // between members of a team: what came of their part of a training step
};

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

// Waits for a message without giving up when a signal came: only rank 0 decides when a worker rank ends.
// After a signal and 60 s of silence it throws base::Interrupted, because rank 0 is gone then.
comm::Message WaitForMessage(comm::Communicator& comm);

}  // namespace skyquilt::coordinator
