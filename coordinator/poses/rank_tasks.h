// Runs tasks of the search for poses (prepare/poses/pose_task.h) on the other ranks. Each rank has one task at a time and gets the next one when it
// is done, so that a slow rank does fewer. Rank 0 runs none itself.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "coordinator/project/run_options.h"
#include "coordinator/ranks/rank_group.h"
#include "coordinator/ranks/shared_folder.h"
#include "core/comm/communicator.h"
#include "prepare/poses/pose_task.h"

namespace skyquilt::coordinator {

// Rank 0's side. The other ranks are called when they are first needed, and sent back by the destructor; a task that one of them still runs then is
// stopped.
class RankTasks : public prepare::poses::RemoteTasks {
 public:
  // folder: of the project; all ranks must see the same one.
  RankTasks(comm::Communicator& comm, const RunOptions& options, std::filesystem::path folder, bool verbose, bool quiet);

  // All throw base::UsageError or base::InputError naming rank and host when a rank is not ready, base::Interrupted after a signal.
  int size() override;
  int threads() override;
  // After an exception of a task no more tasks are handed out, and the exception is thrown with rank and host in it.
  void Run(std::span<const prepare::poses::PoseTask> tasks, const prepare::poses::TaskProgress& on_progress) override;

 private:
  const std::vector<GroupMember>& Members();

  comm::Communicator& comm_;
  const int own_threads_;  // as the options have them
  const std::filesystem::path folder_;
  const bool verbose_, quiet_;
  std::optional<SharedFolder> shared_;
  std::unique_ptr<RankGroup> group_;
  std::vector<GroupMember> members_;
  size_t next_number_ = 0;  // of tasks, never used twice: answers to an earlier call may be late
};

// The other ranks' side, until kTagDone. setup: from rank 0. Errors are reported to rank 0 and not thrown.
void ServeTasks(comm::Communicator& comm, const std::string& setup);

}  // namespace skyquilt::coordinator
