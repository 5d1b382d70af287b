#include "coordinator/scheduler/rank_speeds.h"

#include <algorithm>

namespace skyquilt::coordinator {
namespace {

constexpr double kJudge_s = 20.0;      // the speed of a block is judged only after this time
constexpr double kWorthwhile = 0.75;   // a move must reduce the remaining time to this fraction or less
constexpr double kAfterAllElse = 1.1;  // a rank is slow when its block takes this many times as long as all remaining work on all ranks

}  // namespace

void RankSpeeds::Started(int rank, double cost, double now_s) {
  Block& block = busy_[rank];
  block = {};
  block.cost = cost;
  block.begun_s = now_s;
}

void RankSpeeds::Progress(int rank, double fraction, double now_s) {
  const auto busy = busy_.find(rank);
  if (busy == busy_.end()) return;
  Block& block = busy->second;
  block.fraction = std::clamp(fraction, 0.0, 1.0);
  if (block.seen) return;
  block.seen = true;
  block.first_fraction = block.fraction;
  block.first_s = now_s;
}

void RankSpeeds::Close(int rank, double now_s) {
  const auto busy = busy_.find(rank);
  if (busy == busy_.end()) return;
  const Block& block = busy->second;
  // Blocks that were already complete when handed out tell nothing about the speed.
  if (block.seen && block.fraction > block.first_fraction && now_s > block.begun_s) {
    Done& done = done_[rank];
    done.cost += block.cost * (block.fraction - block.first_fraction);
    done.seconds += now_s - block.begun_s;
  }
  busy_.erase(busy);
}

void RankSpeeds::Finished(int rank, double now_s) {
  Progress(rank, 1.0, now_s);
  Close(rank, now_s);
}

void RankSpeeds::Stopped(int rank, double now_s) {
  Close(rank, now_s);
}

void RankSpeeds::Keep(int rank) {
  if (const auto busy = busy_.find(rank); busy != busy_.end()) busy->second.kept = true;
}

double RankSpeeds::MeanSpeed() const {
  double sum = 0.0;
  for (const auto& [rank, done] : done_) sum += done.cost / done.seconds;
  return done_.empty() ? 0.0 : sum / static_cast<double>(done_.size());
}

double RankSpeeds::Speed(int rank) const {
  const auto found = done_.find(rank);
  return found == done_.end() ? MeanSpeed() : found->second.cost / found->second.seconds;
}

std::optional<int> RankSpeeds::SlowRank(int idle, double waiting_cost, int n_ranks, double now_s) const {
  const double speed = Speed(idle);
  if (!(speed > 0.0)) return std::nullopt;
  double left = waiting_cost;
  for (const auto& [rank, block] : busy_) left += block.cost * (1.0 - block.fraction);
  const double all_else_s = left / (MeanSpeed() * n_ranks);
  std::optional<int> slow;
  double longest_s = kAfterAllElse * all_else_s;
  for (const auto& [rank, block] : busy_) {
    const double watched_s = now_s - block.first_s;
    if (!block.seen || block.kept || watched_s < kJudge_s) continue;
    // Avoids a division by zero for a block without any progress.
    const double per_second = std::max(1e-6, block.fraction - block.first_fraction) / watched_s;
    const double here_s = (1.0 - block.fraction) / per_second;
    const double there_s = block.cost * (1.0 - block.fraction) / speed + kMove_s;
    if (here_s > longest_s && there_s < kWorthwhile * here_s) {
      slow = rank;
      longest_s = here_s;
    }
  }
  return slow;
}

}  // namespace skyquilt::coordinator
