#include "coordinator/tasks/rank_tasks.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "coordinator/ranks/failure.h"
#include "coordinator/ranks/rank_messages.h"
#include "coordinator/tasks/task_message.h"
#include "core/base/json_text.h"
#include "core/base/log.h"

namespace skyquilt::coordinator {

using nlohmann::json;

TextTasks::TextTasks(TaskKind kind, comm::Communicator& comm, const RunOptions& options, std::filesystem::path folder, bool verbose, bool quiet)
    : kind_(kind), comm_(comm), own_threads_(options.threads), folder_(std::move(folder)), verbose_(verbose), quiet_(quiet) {}

const std::vector<GroupMember>& TextTasks::Members() {
  if (group_ == nullptr) {
    shared_.emplace(folder_);
    const json setup = {{"work", NameOf(kind_)}, {"threads", own_threads_}, {"shared", shared_->Proof()}, {"verbose", verbose_}, {"quiet", quiet_}};
    auto group = std::make_unique<RankGroup>(comm_, kTagTasks, base::JsonText(setup));
    members_ = group->WaitForRanks();
    group_ = std::move(group);
    for (const GroupMember& member : members_) comm_.Send(member.rank, kTagThreads, std::to_string(member.threads));
    base::LogInfo("{} by {} ranks with {} threads at most", kind_ == TaskKind::kPoses ? "features and matches are found" : "masks are made",
                  members_.size(), threads());
  }
  return members_;
}

int TextTasks::size() {
  return static_cast<int>(Members().size());
}

int TextTasks::threads() {
  int most = 1;
  for (const GroupMember& member : Members()) most = std::max(most, member.threads);
  return most;
}

void TextTasks::Run(std::span<const std::string> tasks, const std::function<void(double more)>& on_progress) {
  size_t next = 0, n_done = 0;
  std::map<size_t, int> rank_of;  // by number of a task that a rank has
  const auto hand_out = [&](int rank) {
    if (next == tasks.size()) return;
    rank_of.emplace(next_number_, rank);
    comm_.Send(rank, kTagTask, TaskMessage(next_number_++, tasks[next++]));
  };
  for (const GroupMember& member : Members()) hand_out(member.rank);
  while (n_done < tasks.size()) {
    const comm::Message message = comm_.Receive();
    if (message.tag == kTagReady) {
      const json hello = base::ParseJson(message.bytes);
      if (hello.contains("failure")) Throw(FailureFromJson(hello.at("failure")), comm_.NameOf(message.source));
    }
    if (message.tag != kTagTaskPart && message.tag != kTagTaskEnd) continue;
    const auto [number, rest] = SplitTaskMessage(message.bytes);
    if (!rank_of.contains(number)) continue;
    if (message.tag == kTagTaskPart) {
      on_progress(std::stod(rest));
      continue;
    }
    if (!rest.empty()) Throw(FailureFromJson(base::ParseJson(rest)), comm_.NameOf(message.source));
    rank_of.erase(number);
    ++n_done;
    hand_out(message.source);
  }
}

void RankTasks::Run(std::span<const prepare::poses::PoseTask> tasks, const prepare::poses::TaskProgress& on_progress) {
  std::vector<std::string> texts;
  for (const prepare::poses::PoseTask& task : tasks) texts.push_back(prepare::poses::ToText(task));
  tasks_.Run(texts, on_progress);
}

}  // namespace skyquilt::coordinator
