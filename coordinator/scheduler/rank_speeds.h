// How fast ranks are, from what they have done, and which block a rank with nothing to do should take over from a slow one.
// Pure bookkeeping on the caller's clock. Not thread-safe.
#pragma once

#include <map>
#include <optional>

namespace skyquilt::coordinator {

class RankSpeeds {
 public:
  // Moving a block costs about this: saving, and loading elsewhere.
  static constexpr double kMove_s = 10.0;

  void HandedOut(int rank, double cost, double now_s);
  // fraction of the block's training that is done, earlier runs included; 0..1.
  void Progress(int rank, double fraction, double now_s);
  // The block is finished (fraction 1) or given up with what Progress last said.
  void Finished(int rank, double now_s);
  void GivenUp(int rank, double now_s);

  // This rank's present block stays with it, or was asked for already.
  void Keep(int rank);

  // Cost per second; a rank that has not shown anything yet counts as the mean of the others, 0 when none has.
  double Speed(int rank) const;
  // The rank whose block `idle` had better take over: one that would still be at work after all else is done, and whose rest `idle` finishes in
  // at most three quarters of the time, the move included. waiting_cost: of the blocks nobody has begun. n_ranks: that train.
  std::optional<int> SlowRank(int idle, double waiting_cost, int n_ranks, double now_s) const;

 private:
  struct Block {
    double cost = 0.0;
    double begun_s = 0.0;
    bool seen = false;
    bool kept = false;
    double first_fraction = 0.0, fraction = 0.0;  // of the first and the last report
    double first_s = 0.0;
  };
  struct Done {
    double cost = 0.0;
    double seconds = 0.0;
  };
  void Close(int rank, double now_s);
  double MeanSpeed() const;

  std::map<int, Block> busy_;
  std::map<int, Done> done_;
};

}  // namespace skyquilt::coordinator
