#include "coordinator/scheduler/coordinate.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <thread>
#include <utility>

#include "coordinator/ranks/rank_messages.h"
#include "coordinator/ranks/shared_folder.h"
#include "coordinator/scheduler/rank_speeds.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"

namespace skyquilt::coordinator {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

void ThrowIfEndsCommand(const FieldOutcome& outcome, const std::string& who) {
  if (outcome.failure && outcome.failure.kind != Failure::kBlock) Throw(outcome.failure, who);
}

namespace {

void CoordinateAlone(BlockQueue& queue, const FieldTrainer& trainer, int threads, const CoordinateHooks& hooks) {
  while (queue.HasWaiting()) {
    base::ThrowIfCancelled();
    const FieldJob job = queue.TakeNext(hooks.now_s(), {});
    hooks.handed_out(job, 0);
    const FieldOutcome outcome = RunField(
        trainer, job, [&](const worker::TrainStatus& status) { hooks.status(job, status); }, 0, threads);
    ThrowIfEndsCommand(outcome);
    hooks.finished(outcome, queue.RecordOutcome(outcome));
  }
}

// State of one training that is divided among ranks.
class Coordination {
  static constexpr double kRelieveEvery_s = 1.0;
  static constexpr int kMostMoves = 3;

 public:
  Coordination(comm::Communicator& comm, BlockQueue& queue, const CoordinateHooks& hooks) : comm_(comm), queue_(queue), hooks_(hooks) {
    for (int rank = 1; rank < comm.size(); ++rank) idle_.insert(rank);
  }

  void Run() {
    while (true) {
      if (!stopping_ && base::CancelRequested()) {
        interrupted_ = true;
        Stop();
      }
      if (!stopping_) RelieveSlowRanks();
      while (!stopping_ && !idle_.empty() && AssignReturnedBlock()) {
      }
      while (!stopping_ && queue_.HasWaiting() && !idle_.empty()) HandOut();
      if (busy_.empty() && (stopping_ || (!queue_.HasWaiting() && returned_.empty()))) break;
      const std::optional<comm::Message> message = comm_.TryReceive();
      if (!message) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        continue;
      }
      if (message->tag == kTagStatus) TakeStatus(*message);
      if (message->tag == kTagOutcome) TakeOutcome(*message);
    }
    if (fatal_) ThrowIfEndsCommand(*fatal_, comm_.NameOf(fatal_->rank));
    if (interrupted_) throw base::Interrupted();
  }

 private:
  struct Busy {
    FieldJob job;
    double until_s = 0.0;  // expected
  };

  void HandOut() {
    std::vector<double> busy_until;
    for (const auto& [rank, busy] : busy_) busy_until.push_back(busy.until_s);
    const double now = hooks_.now_s();
    const int rank = *idle_.begin();
    const FieldJob job = queue_.TakeNext(now, busy_until);
    idle_.erase(rank);
    Begin(rank, job, now);
    hooks_.handed_out(job, rank);
  }

  void Begin(int rank, const FieldJob& job, double now) {
    busy_[rank] = {job, now + job.seconds};
    speeds_.Started(rank, queue_.Cost(job.block), now);
    comm_.Send(rank, kTagJob, ToText(job));
  }

  // Asks slow ranks for their blocks while other ranks are idle; at most once a second.
  void RelieveSlowRanks() {
    if (idle_.empty() || busy_.empty() || !queue_.HasFixedSteps()) return;
    const double now = hooks_.now_s();
    if (now < relieve_again_s_) return;
    relieve_again_s_ = now + kRelieveEvery_s;
    while (asked_.size() < idle_.size()) {
      // The fastest idle rank.
      const int to = *std::max_element(idle_.begin(), idle_.end(), [this](int a, int b) { return speeds_.Speed(a) < speeds_.Speed(b); });
      const std::optional<int> from = speeds_.SlowRank(to, queue_.WaitingCost(), comm_.size() - 1, now);
      if (!from) return;
      asked_.insert(*from);
      speeds_.Keep(*from);
      comm_.Send(*from, kTagGiveBack, ToText(busy_.at(*from).job));
    }
  }

  // Gives a block that a slow rank gave back to the fastest idle rank; to the slow rank itself only if no other rank is idle and no block waits.
  bool AssignReturnedBlock() {
    if (returned_.empty()) return false;
    const auto [job, from] = returned_.back();
    std::optional<int> to;
    for (const int rank : idle_) {
      if (rank != from && (!to || speeds_.Speed(rank) > speeds_.Speed(*to))) to = rank;
    }
    if (!to && !queue_.HasWaiting()) to = *idle_.begin();
    if (!to) return false;
    returned_.pop_back();
    idle_.erase(*to);
    Begin(*to, job, hooks_.now_s());
    if (++moves_[job.block] >= kMostMoves) speeds_.Keep(*to);
    if (hooks_.moved) hooks_.moved(job, from, *to);
    return true;
  }

  void Stop() {
    stopping_ = true;
    for (const auto& [rank, busy] : busy_) comm_.Send(rank, kTagStop, "");
  }

  void TakeStatus(const comm::Message& message) {
    const auto busy = busy_.find(message.source);
    if (busy == busy_.end()) return;
    const size_t newline = message.bytes.find('\n');
    const worker::TrainStatus status = StatusFromText(message.bytes.substr(newline + 1));
    speeds_.Progress(message.source, status.fraction, hooks_.now_s());
    if (busy->second.job.seconds > 0.0) busy->second.until_s = hooks_.now_s() + std::max(0.0, busy->second.job.seconds - status.seconds);
    hooks_.status(busy->second.job, status);
  }

  void TakeOutcome(const comm::Message& message) {
    const FieldOutcome outcome = OutcomeFromText(message.bytes);
    busy_.erase(message.source);
    idle_.insert(message.source);
    const bool finished = outcome.failure.kind == Failure::kNone;
    if (finished) {
      speeds_.Finished(message.source, hooks_.now_s());
    } else {
      speeds_.Stopped(message.source, hooks_.now_s());
    }
    const bool was_asked = asked_.erase(message.source) > 0;
    if (was_asked && outcome.failure.kind == Failure::kInterrupted && !stopping_) {
      returned_.emplace_back(outcome.job, message.source);
      return;
    }
    switch (outcome.failure.kind) {
      case Failure::kInterrupted:
        // Also when the signal reached only that rank: the batch system is ending the job.
        interrupted_ = true;
        if (!stopping_) Stop();
        break;
      case Failure::kInput:
      case Failure::kUsage:
        if (!fatal_) fatal_ = outcome;
        if (!stopping_) Stop();
        break;
      case Failure::kNone:
      case Failure::kBlock:
        hooks_.finished(outcome, queue_.RecordOutcome(outcome));
        break;
    }
  }

  comm::Communicator& comm_;
  BlockQueue& queue_;
  const CoordinateHooks& hooks_;
  std::set<int> idle_;
  std::map<int, Busy> busy_;
  RankSpeeds speeds_;
  std::set<int> asked_;                             // slow ranks that were asked for their block
  std::vector<std::pair<FieldJob, int>> returned_;  // blocks that slow ranks gave back, with the rank
  std::map<int, int> moves_;                        // moves of each block so far
  double relieve_again_s_ = 0.0;
  std::optional<FieldOutcome> fatal_;
  bool stopping_ = false;
  bool interrupted_ = false;
};

// Called by the trainer between steps: sends the status to rank 0 about twice a second, and checks for a stop from rank 0.
class RankReporter {
 public:
  RankReporter(comm::Communicator& comm, const FieldJob& job) : comm_(comm), job_text_(ToText(job)) {}

  void operator()(const worker::TrainStatus& status) {
    if (SecondsSince(last_poll_) > 0.05) {
      last_poll_ = Clock::now();
      while (const std::optional<comm::Message> message = comm_.TryReceive()) {
        done_ = done_ || message->tag == kTagDone;  // rank 0 ended the training by an error of its own
        if (message->tag == kTagStop || done_) stop_ = true;
        // A request for an earlier job may arrive late, after that job has ended; it does not concern this one.
        if (message->tag == kTagGiveBack && message->bytes == job_text_) yield_ = true;
        if (stop_ || yield_) base::RequestCancel();
      }
    }
    if (!sent_ || SecondsSince(last_sent_) > 0.5) {
      sent_ = true;
      last_sent_ = Clock::now();
      comm_.Send(0, kTagStatus, job_text_ + "\n" + ToText(status));
    }
  }
  // Only the block was asked for: the rank stays in the training.
  bool only_yielded() const { return yield_ && !stop_; }
  bool done() const { return done_; }

 private:
  comm::Communicator& comm_;
  bool stop_ = false;
  bool yield_ = false;
  bool done_ = false;
  std::string job_text_;
  Clock::time_point last_poll_{};
  Clock::time_point last_sent_{};
  bool sent_ = false;
};

}  // namespace

void CoordinateBlocks(comm::Communicator& comm, BlockQueue& queue, const FieldTrainer& alone, int alone_threads, const CoordinateHooks& hooks) {
  if (comm.size() == 1) {
    CoordinateAlone(queue, alone, alone_threads, hooks);
  } else {
    Coordination(comm, queue, hooks).Run();
  }
}

void ServeBlocks(comm::Communicator& comm, const FieldTrainer& trainer, int threads, const std::filesystem::path& checkpoints) {
  while (true) {
    const comm::Message message = WaitForMessage(comm);
    if (message.tag == kTagDone) return;
    if (message.tag != kTagJob) continue;  // a stop for a job that ended before it arrived
    const FieldJob job = JobFromText(message.bytes);
    RankReporter reporter(comm, job);
    FieldOutcome outcome = RunField(
        trainer, job, [&reporter](const worker::TrainStatus& status) { reporter(status); }, comm.rank(), threads);
    if (reporter.only_yielded() || reporter.done()) base::WithdrawRequest();
    if (!outcome.failure && !checkpoints.empty()) outcome.saved_bytes = BytesSeen(checkpoints / (job.name + ".h5"));
    comm.Send(0, kTagOutcome, ToText(outcome));
    if (reporter.done()) return;
  }
}

}  // namespace skyquilt::coordinator
