// Which ranks have been silent for too long: only the times, without MPI.
#pragma once

#include <vector>

namespace skyquilt::comm {

class SilenceWatch {
 public:
  explicit SilenceWatch(int ranks) : ranks_(static_cast<size_t>(ranks)) {}

  // now_s: seconds of a clock that never goes back. Ranks that were never heard count from the first call of Check.
  void Heard(int rank, double now_s);

  enum class What {
    kSilent,  // for a quarter of the limit: said once
    kBack,    // heard again after that
    kLost,    // for longer than the limit
  };
  struct Finding {
    int rank = 0;
    What what = What::kSilent;
    double silent_s = 0.0;
  };
  // To be called about every second. After a pause of more than kOwnPause_s this process itself stood still, and nobody is judged by that time.
  // limit_s: 0: nobody is ever lost or silent.
  std::vector<Finding> Check(double now_s, double limit_s);

  static constexpr double kOwnPause_s = 5.0;

 private:
  struct Rank {
    double heard_s = -1.0;  // negative: not yet
    bool silent = false;    // said
  };
  std::vector<Rank> ranks_;
  double checked_s_ = -1.0;
};

}  // namespace skyquilt::comm
