// Runs tasks on the other ranks: those of the search for poses (prepare/poses/pose_task.h) and of masks (masks/mask_runner.h). Each rank has one task
// at a time and gets the next one when it is done, so that a slow rank does fewer. Rank 0 runs none itself.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "coordinator/project/run_options.h"
#include "coordinator/ranks/rank_group.h"
#include "coordinator/ranks/shared_folder.h"
#include "core/comm/communicator.h"
#include "masks/make_masks.h"
#include "prepare/poses/pose_task.h"

namespace skyquilt::coordinator {

// What the tasks belong to.
enum class TaskKind { kPoses, kMasks };

// Rank 0's side, with tasks as texts. The other ranks are called when they are first needed, and sent back by the destructor; a task that one of them
// still runs then is stopped.
class TextTasks {
 public:
  // folder: of the project; all ranks must see the same one.
  TextTasks(TaskKind kind, comm::Communicator& comm, const RunOptions& options, std::filesystem::path folder, bool verbose, bool quiet);

  // All throw base::UsageError or base::InputError naming rank and host when a rank is not ready, base::Interrupted after a signal.
  int size();
  int threads();  // of the rank with the most
  // After an exception of a task no more tasks are handed out, and the exception is thrown with rank and host in it.
  void Run(std::span<const std::string> tasks, const std::function<void(double more)>& on_progress);

 private:
  const std::vector<GroupMember>& Members();

  TaskKind kind_;
  comm::Communicator& comm_;
  const int own_threads_;  // as the options have them
  const std::filesystem::path folder_;
  const bool verbose_, quiet_;
  std::optional<SharedFolder> shared_;
  std::unique_ptr<RankGroup> group_;
  std::vector<GroupMember> members_;
  size_t next_number_ = 0;  // of tasks, never used twice: answers to an earlier call may be late
};

// Of the search for poses. The functions throw as those of TextTasks.
class RankTasks : public prepare::poses::RemoteTasks {
 public:
  RankTasks(comm::Communicator& comm, const RunOptions& options, std::filesystem::path folder, bool verbose, bool quiet)
      : tasks_(TaskKind::kPoses, comm, options, std::move(folder), verbose, quiet) {}
  int size() override { return tasks_.size(); }
  int threads() override { return tasks_.threads(); }
  void Run(std::span<const prepare::poses::PoseTask> tasks, const prepare::poses::TaskProgress& on_progress) override;

 private:
  TextTasks tasks_;
};

// Of masks. The functions throw as those of TextTasks.
class MaskTasks : public masks::RemoteTasks {
 public:
  MaskTasks(comm::Communicator& comm, const RunOptions& options, std::filesystem::path folder, bool verbose, bool quiet)
      : tasks_(TaskKind::kMasks, comm, options, std::move(folder), verbose, quiet) {}
  int threads() override { return tasks_.threads(); }
  void Run(std::span<const std::string> tasks, const masks::TaskProgress& on_progress) override { tasks_.Run(tasks, on_progress); }

 private:
  TextTasks tasks_;
};

// The other ranks' side, until kTagDone. setup: from rank 0. Errors are reported to rank 0 and not thrown.
void ServeTasks(comm::Communicator& comm, const std::string& setup);

}  // namespace skyquilt::coordinator
