// Measures how fast each rank trains, to decide which block of a slow rank an idle rank should take over.
// All times are on the caller's clock. Not thread-safe.
#pragma once

#include <map>
#include <optional>

namespace skyquilt::coordinator {

class RankSpeeds {
 public:
  // Assumed time to move a block: save it on one rank, load it on another.
  static constexpr double kMove_s = 10.0;

  void Started(int rank, double cost, double now_s);
  // fraction: how much of the block's training is done, earlier runs included; 0..1.
  void Progress(int rank, double fraction, double now_s);
  // The block is finished (fraction 1), or given up at the fraction that Progress reported last.
  void Finished(int rank, double now_s);
  void Stopped(int rank, double now_s);

  // SlowRank no longer proposes this rank's present block.
  void Keep(int rank);

  // Cost per second, from blocks that ended. A rank without any has the mean speed of the others; 0 when no rank has any.
  double Speed(int rank) const;
  // The rank whose block `idle` should take over, if any: the slow rank would finish after all other work is done, and `idle` needs less than three
  // quarters of its remaining time, the move included. waiting_cost: cost of all blocks not yet started. n_ranks: ranks that train.
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
