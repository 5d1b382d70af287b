#include "core/comm/silence_watch.h"

namespace skyquilt::comm {

void SilenceWatch::Heard(int rank, double now_s) {
  ranks_.at(static_cast<size_t>(rank)).heard_s = now_s;
}

std::vector<SilenceWatch::Finding> SilenceWatch::Check(double now_s, double limit_s) {
  const bool stood_still = checked_s_ < 0.0 || now_s - checked_s_ > kOwnPause_s;
  checked_s_ = now_s;
  std::vector<Finding> findings;
  for (size_t i = 0; i < ranks_.size(); ++i) {
    Rank& rank = ranks_[i];
    if (stood_still || rank.heard_s < 0.0) rank.heard_s = now_s;
    const double silent_s = now_s - rank.heard_s;
    if (limit_s > 0.0 && silent_s > limit_s) {
      findings.push_back({static_cast<int>(i), What::kLost, silent_s});
    } else if (limit_s > 0.0 && silent_s > limit_s / 4.0) {
      if (!rank.silent) findings.push_back({static_cast<int>(i), What::kSilent, silent_s});
      rank.silent = true;
    } else {
      if (rank.silent) findings.push_back({static_cast<int>(i), What::kBack, silent_s});
      rank.silent = false;
    }
  }
  return findings;
}

}  // namespace skyquilt::comm
