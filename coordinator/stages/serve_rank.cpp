#include "coordinator/stages/serve_rank.h"

#include "coordinator/ranks/rank_messages.h"
#include "coordinator/rendering/serve_rays.h"
#include "coordinator/scheduler/train_all.h"
#include "coordinator/tasks/rank_tasks.h"

namespace skyquilt::coordinator {

void ServeRank(comm::Communicator& comm) {
  while (true) {
    const comm::Message message = WaitForMessage(comm);
    if (message.tag == kTagQuit) return;
    if (message.tag == kTagSetup) ServeTraining(comm, message.bytes);
    if (message.tag == kTagScene) ServeRays(comm, message.bytes);
    if (message.tag == kTagTasks) ServeTasks(comm, message.bytes);
  }
}

void ReleaseRanks(comm::Communicator& comm) {
  for (int rank = 1; rank < comm.size(); ++rank) comm.Send(rank, kTagQuit, "");
}

}  // namespace skyquilt::coordinator
