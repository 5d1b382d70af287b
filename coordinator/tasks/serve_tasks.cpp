#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "coordinator/ranks/failure.h"
#include "coordinator/ranks/rank_messages.h"
#include "coordinator/tasks/rank_tasks.h"
#include "coordinator/tasks/task_message.h"
#include "core/base/cancel.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/progress.h"

namespace skyquilt::coordinator {
namespace {

using nlohmann::json;

// While a task runs: tells rank 0 about twice a second how much more of it is done, and stops it when rank 0 ends the work.
class TaskReporter {
 public:
  TaskReporter(comm::Communicator& comm, size_t number) : comm_(comm), number_(number) {}

  // Of any thread; only this one's creator speaks with rank 0.
  void operator()(double more) {
    more_.fetch_add(more);
    if (std::this_thread::get_id() != creator_ || Clock::now() - last_ < std::chrono::milliseconds(400)) return;
    last_ = Clock::now();
    // What follows the end is for the next piece of work, or ends the program.
    while (!over_) {
      const std::optional<comm::Message> message = comm_.TryReceive();
      if (!message) break;
      over_ = message->tag == kTagDone;
    }
    if (over_) base::RequestCancel();
    Flush();
  }
  void Flush() {
    const double more = more_.exchange(0.0);
    if (more > 0.0) comm_.Send(0, kTagTaskPart, TaskMessage(number_, std::to_string(more)));
  }
  bool over() const { return over_; }

 private:
  using Clock = std::chrono::steady_clock;
  comm::Communicator& comm_;
  size_t number_;
  std::thread::id creator_ = std::this_thread::get_id();
  std::atomic<double> more_{0.0};
  Clock::time_point last_ = Clock::now();
  bool over_ = false;
};

// Runs a task that came as a text.
using TextRunner = std::function<void(const std::string& task, const std::function<void(double more)>& on_progress)>;

TextRunner PoseRunner(int threads, int rank) {
  const auto runner = std::make_shared<prepare::poses::TaskRunner>(threads, "colmap_rank_" + std::to_string(rank) + ".log");
  return [runner](const std::string& task, const auto& on_progress) { runner->Run(prepare::poses::TaskFromText(task), on_progress); };
}

TextRunner RunnerOfMasks(int threads) {
  const auto runner = std::make_shared<masks::MaskRunner>(threads);
  return [runner](const std::string& task, const auto& on_progress) { runner->Run(masks::TaskFromText(task), on_progress); };
}

// False when rank 0 has ended the work in the meantime.
bool RunTask(comm::Communicator& comm, const std::string& bytes, const TextRunner& runner) {
  const auto [number, text] = SplitTaskMessage(bytes);
  TaskReporter reporter(comm, number);
  std::string failure;
  try {
    runner(text, [&reporter](double more) { reporter(more); });
  } catch (...) {
    failure = base::JsonText(ToJson(CurrentFailure()));
  }
  if (reporter.over()) {
    base::WithdrawRequest();
    return false;
  }
  reporter.Flush();
  comm.Send(0, kTagTaskEnd, TaskMessage(number, failure));
  return true;
}

}  // namespace

void ServeTasks(comm::Communicator& comm, const std::string& setup_text) {
  ServeRankGroup(comm, [&](json& hello) {
    const json setup = base::ParseJson(setup_text);
    const std::string name = "rank " + std::to_string(comm.rank());
    base::InitLog(setup.at("verbose").get<bool>(), name);
    if (setup.at("quiet").get<bool>()) base::SetLogLevel(base::LogLevel::kWarning);
    base::Progress::SetQuiet(true);
    if (setup.contains("shared")) RequireSharedFolder(setup.at("shared"));
    RunOptions options;
    options.threads = setup.at("threads").get<int>();
    hello["threads"] = options.UsableThreads();
    const int threads = std::stoi(Register(comm, hello, kTagThreads));
    const bool masks = setup.value("work", NameOf(TaskKind::kPoses)) == NameOf(TaskKind::kMasks);
    const TextRunner runner = masks ? RunnerOfMasks(threads) : PoseRunner(threads, comm.rank());
    while (true) {
      const comm::Message message = WaitForMessage(comm);
      if (message.tag == kTagDone) return;
      if (message.tag == kTagTask && !RunTask(comm, message.bytes, runner)) return;
    }
  });
}

}  // namespace skyquilt::coordinator
