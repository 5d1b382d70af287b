#include "coordinator/bench/simulated_ranks.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "coordinator/scheduler/coordinate.h"
#include "core/base/errors.h"

namespace skyquilt::coordinator {

SimulatedRanks::SimulatedRanks(std::vector<double> speed, std::function<double(int block)> work_s, std::vector<double> fails_at_s,
                               double status_every_s, double start_s)
    : speed_(std::move(speed)), work_s_(std::move(work_s)), fails_at_s_(std::move(fails_at_s)), status_every_s_(status_every_s), now_s_(start_s) {
  std::reverse(fails_at_s_.begin(), fails_at_s_.end());
}

void SimulatedRanks::Send(int destination, int tag, const std::string& bytes) {
  ++messages_;
  bytes_ += static_cast<int64_t>(bytes.size());
  if (tag != kTagJob) return;
  Training training{JobFromText(bytes), now_s_, 0.0, ++serial_};
  training.until_s = now_s_ + work_s_(training.job.block) / speed_[static_cast<size_t>(destination)];
  SKYQUILT_CHECK(!training_.contains(destination), "a rank trains one block at a time");
  training_[destination] = training;
  events_.push({std::min(now_s_ + status_every_s_, training.until_s), destination, serial_});
}

std::optional<comm::Message> SimulatedRanks::TryReceive() {
  if (events_.empty()) return std::nullopt;
  const Event event = events_.top();
  if (!fails_at_s_.empty() && fails_at_s_.back() <= event.at_s) {
    now_s_ = std::max(now_s_, fails_at_s_.back());
    throw RankLost{event.rank};
  }
  events_.pop();
  now_s_ = event.at_s;
  const Training& training = training_.at(event.rank);
  ++messages_;
  comm::Message message{event.rank, kTagStatus, ""};
  if (now_s_ < training.until_s) {
    worker::TrainStatus status;
    status.fraction = (now_s_ - training.from_s) / (training.until_s - training.from_s);
    status.seconds = now_s_ - training.from_s;
    message.bytes = ToText(training.job) + "\n" + ToText(status);
    events_.push({std::min(now_s_ + status_every_s_, training.until_s), event.rank, event.serial});
  } else {
    FieldOutcome outcome;
    outcome.job = training.job;
    outcome.result.ok = true;
    outcome.rank = event.rank;
    outcome.wall_s = training.until_s - training.from_s;
    message.tag = kTagOutcome;
    message.bytes = ToText(outcome);
    training_.erase(event.rank);
  }
  bytes_ += static_cast<int64_t>(message.bytes.size());
  return message;
}

void SimulatedRanks::Abort(int exit_status) {
  std::_Exit(exit_status);
}

std::map<int, double> SimulatedRanks::InTraining() const {
  std::map<int, double> done_s;
  for (const auto& [rank, training] : training_) {
    done_s[training.job.block] = (now_s_ - training.from_s) * speed_[static_cast<size_t>(rank)];
  }
  return done_s;
}

}  // namespace skyquilt::coordinator
