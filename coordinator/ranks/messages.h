// What rank 0 and the others say to each other.
#pragma once

#include "core/comm/communicator.h"

namespace skyquilt::coordinator {

// Message tags between rank 0 and the others.
enum Tag : int {
  kTagSetup = 101,     // 0 -> worker: a training begins, and what to load for it (see train_all.h)
  kTagHello = 102,     // worker -> 0: its host and what it has (see rank_group.h)
  kTagThreads = 103,   // 0 -> worker: how many threads it may use
  kTagJob = 104,       // 0 -> worker: FieldJob
  kTagStatus = 105,    // worker -> 0: FieldJob, newline, TrainStatus
  kTagOutcome = 106,   // worker -> 0: FieldOutcome
  kTagStop = 107,      // 0 -> worker: save and stop
  kTagDone = 108,      // 0 -> worker: no more jobs of this training or rendering
  kTagQuit = 109,      // 0 -> worker: the program ends
  kTagYield = 110,     // 0 -> worker: save and give the block back, another rank goes on with it
  kTagScene = 111,     // 0 -> worker: a rendering begins, and of which scene (see rendering/serve_rays.h)
  kTagPart = 112,      // 0 -> worker: what it may use and which blocks are whose
  kTagRays = 113,      // 0 -> worker: rays to take on
  kTagRayReply = 114,  // worker -> 0: how far they came, or what went wrong
};

// Waits for a message without giving up when a signal came: only rank 0 decides when a worker rank ends.
// After a signal and 60 s of silence it throws base::Interrupted, because rank 0 is gone then.
comm::Message WaitForMessage(comm::Communicator& comm);

}  // namespace skyquilt::coordinator
