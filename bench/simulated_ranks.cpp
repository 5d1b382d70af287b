#include "bench/simulated_ranks.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "coordinator/ranks/rank_messages.h"
#include "core/base/errors.h"

namespace skyquilt::bench {

SimulatedRanks::SimulatedRanks(std::vector<double> speed, std::vector<double> work_s, std::vector<double> left_s, std::vector<double> fails_at_s,
                               double skip_s, double save_s, double status_every_s, double start_s)
    : speed_(std::move(speed)),
      work_s_(std::move(work_s)),
      left_s_(std::move(left_s)),
      fails_at_s_(std::move(fails_at_s)),
      skip_s_(skip_s),
      save_s_(save_s),
      status_every_s_(status_every_s),
      now_s_(start_s) {
  std::reverse(fails_at_s_.begin(), fails_at_s_.end());
}

double SimulatedRanks::DoneWork(int rank, const Training& training) const {
  const double left = left_s_[static_cast<size_t>(training.job.block)];
  return std::clamp((now_s_ - training.from_s) * speed_[static_cast<size_t>(rank)], 0.0, left);
}

void SimulatedRanks::Send(int destination, int tag, const std::string& bytes) {
  ++messages_;
  bytes_ += static_cast<int64_t>(bytes.size());
  if (tag == coordinator::kTagJob) {
    SKYQUILT_CHECK(!training_.contains(destination), "a rank trains one block at a time");
    Training training{coordinator::JobFromText(bytes), now_s_, 0.0, ++serial_, false};
    const double left = left_s_[static_cast<size_t>(training.job.block)];
    if (moved_.contains(training.job.block)) training.from_s += save_s_;
    training.until_s = training.from_s + (left > 0.0 ? left / speed_[static_cast<size_t>(destination)] : skip_s_);
    training_[destination] = training;
    events_.push({std::min(now_s_ + status_every_s_, training.until_s), destination, serial_});
  } else if (tag == coordinator::kTagGiveBack) {
    const auto found = training_.find(destination);
    if (found == training_.end() || coordinator::ToText(found->second.job) != bytes) return;
    Training& training = found->second;
    left_s_[static_cast<size_t>(training.job.block)] -= DoneWork(destination, training);
    moved_.insert(training.job.block);
    training.yields = true;
    training.from_s = training.until_s = now_s_ + save_s_;
    training.serial = ++serial_;
    events_.push({training.until_s, destination, serial_});
  }
}

std::optional<comm::Message> SimulatedRanks::TryReceive() {
  while (!events_.empty() && events_.top().serial != SerialOf(events_.top().rank)) events_.pop();
  if (events_.empty()) return std::nullopt;
  const Event event = events_.top();
  if (!fails_at_s_.empty() && fails_at_s_.back() <= event.at_s) {
    now_s_ = std::max(now_s_, fails_at_s_.back());
    throw RankLost{event.rank};
  }
  events_.pop();
  now_s_ = event.at_s;
  const Training& training = training_.at(event.rank);
  const auto block = static_cast<size_t>(training.job.block);
  ++messages_;
  comm::Message message{event.rank, coordinator::kTagStatus, ""};
  if (now_s_ < training.until_s) {
    worker::TrainStatus status;
    status.fraction = 1.0 - (left_s_[block] - DoneWork(event.rank, training)) / work_s_[block];
    status.seconds = now_s_ - training.from_s;
    message.bytes = coordinator::ToText(training.job) + "\n" + coordinator::ToText(status);
    events_.push({std::min(now_s_ + status_every_s_, training.until_s), event.rank, event.serial});
  } else {
    coordinator::FieldOutcome outcome;
    outcome.job = training.job;
    outcome.rank = event.rank;
    outcome.wall_s = training.until_s - training.from_s;
    outcome.result.ok = !training.yields;
    if (training.yields) {
      outcome.failure.kind = coordinator::Failure::kInterrupted;
    } else {
      left_s_[block] = 0.0;
    }
    message.tag = coordinator::kTagOutcome;
    message.bytes = coordinator::ToText(outcome);
    training_.erase(event.rank);
  }
  bytes_ += static_cast<int64_t>(message.bytes.size());
  return message;
}

void SimulatedRanks::Abort(int exit_status) {
  std::_Exit(exit_status);
}

int64_t SimulatedRanks::SerialOf(int rank) const {
  const auto found = training_.find(rank);
  return found == training_.end() ? -1 : found->second.serial;
}

std::vector<double> SimulatedRanks::LeftAfterLoss(double checkpoint_every_s) const {
  std::vector<double> left = left_s_;
  for (const auto& [rank, training] : training_) {
    if (training.yields) continue;
    left[static_cast<size_t>(training.job.block)] -= std::floor(DoneWork(rank, training) / checkpoint_every_s) * checkpoint_every_s;
  }
  return left;
}

}  // namespace skyquilt::bench
