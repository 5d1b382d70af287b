// Simulated ranks, to test the scheduler without a cluster. A Communicator that answers the messages of CoordinateBlocks in simulated time.
// A lost rank ends the whole job, as with MPI.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <queue>
#include <set>
#include <string>
#include <vector>

#include "coordinator/scheduler/field_job.h"
#include "core/comm/communicator.h"

namespace skyquilt::bench {

// Thrown by TryReceive at the moment a rank is lost.
struct RankLost {
  int rank = 0;
};

class SimulatedRanks : public comm::Communicator {
 public:
  // speed: of every rank; the first entry is rank 0, which does not train.
  // work_s, left_s: seconds that every block needs in total, and still needs, on a rank of speed 1.
  // fails_at_s: times at which a rank is lost, ascending.
  // skip_s: time to skip a block that is complete. save_s: time to save a block that is given back, and again to load it on another rank.
  // start_s: the clock's first value.
  SimulatedRanks(std::vector<double> speed, std::vector<double> work_s, std::vector<double> left_s, std::vector<double> fails_at_s, double skip_s,
                 double save_s, double status_every_s, double start_s);

  int rank() const override { return 0; }
  int size() const override { return static_cast<int>(speed_.size()); }
  int local_size() const override { return 1; }
  void Send(int destination, int tag, const std::string& bytes) override;
  std::optional<comm::Message> TryReceive() override;
  std::string Broadcast(const std::string& bytes_on_root) override { return bytes_on_root; }
  void Barrier() override {}
  int64_t bytes_sent() const override { return bytes_; }
  [[noreturn]] void Abort(int exit_status) override;

  double now_s() const { return now_s_; }
  int64_t messages() const { return messages_; }  // both ways
  // Seconds that every block still needs when the job ends now and the work since its last checkpoint is lost.
  std::vector<double> LeftAfterLoss(double checkpoint_every_s) const;

 private:
  struct Training {
    coordinator::FieldJob job;
    double from_s = 0.0, until_s = 0.0;
    int64_t serial = 0;   // events with another number are outdated
    bool yields = false;  // the block is being given back
  };
  struct Event {
    double at_s = 0.0;
    int rank = 0;
    int64_t serial = 0;
    bool operator>(const Event& other) const { return at_s != other.at_s ? at_s > other.at_s : rank > other.rank; }
  };

  int64_t SerialOf(int rank) const;
  double DoneWork(int rank, const Training& training) const;

  std::vector<double> speed_, work_s_, left_s_, fails_at_s_;
  double skip_s_, save_s_, status_every_s_;
  double now_s_;
  int64_t messages_ = 0;
  int64_t bytes_ = 0;
  int64_t serial_ = 0;
  std::set<int> moved_;  // blocks that were given back
  std::map<int, Training> training_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
};

}  // namespace skyquilt::bench
