// Messages between rank 0 (the coordinator) and the other ranks (the workers).
#pragma once

#include "core/comm/communicator.h"

namespace skyquilt::coordinator {

enum Tag : int {
  kTagSetup = 101,       // 0 -> worker: start a training: settings and project (see train_all.h)
  kTagReady = 102,       // worker -> 0: loaded and ready: host name, threads and memory, or the failure (see rank_group.h)
  kTagThreads = 103,     // 0 -> worker: number of threads it may use
  kTagJob = 104,         // 0 -> worker: train this field (FieldJob)
  kTagStatus = 105,      // worker -> 0: progress: FieldJob, newline, TrainStatus
  kTagOutcome = 106,     // worker -> 0: result of a job (FieldOutcome)
  kTagStop = 107,        // 0 -> worker: save and stop
  kTagDone = 108,        // 0 -> worker: this training or rendering is over
  kTagQuit = 109,        // 0 -> worker: the program ends
  kTagGiveBack = 110,    // 0 -> worker: save and give the block back; a faster rank continues it
  kTagScene = 111,       // 0 -> worker: start a rendering of this scene (see rendering/serve_rays.h)
  kTagAssignment = 112,  // 0 -> worker: its threads and memory, and the owner of each block
  kTagRays = 113,        // 0 -> worker: rays to render (RayRequest)
  kTagRayReply = 114,    // worker -> 0: rendered rays, or the failure (RayReply)
  kTagTasks = 115,       // 0 -> worker: share work that is divided into tasks (see tasks/rank_tasks.h)
  kTagTask = 116,        // 0 -> worker: number of a task, newline, the task (prepare::poses::PoseTask, masks::MaskTask)
  kTagTaskPart = 117,    // worker -> 0: number of a task, newline, how much more of it is done
  kTagTaskEnd = 118,     // worker -> 0: number of a task, newline, nothing or its failure
  kTagJobOpen = 119,     // 0 -> worker, while it renders: open this job (see rendering/rank_parts.h)
  kTagJobReady = 120,    // worker -> 0: number of the job, nothing or why it cannot
  kTagParts = 121,       // 0 -> worker: number of the request, parts of the job to make
  kTagPartsMade = 122,   // worker -> 0: number of the request, failure or nothing, what was made
  kTagJobEnd = 123,      // 0 -> worker: the job is done
};

// Waits for a message. A signal (SIGINT, SIGTERM) does not end the wait, because only rank 0 decides when a worker rank ends.
// Throws base::Interrupted when no message came for 60 s after a signal: rank 0 has died.
comm::Message WaitForMessage(comm::Communicator& comm);

}  // namespace skyquilt::coordinator
