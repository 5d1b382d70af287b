// Signs of life between ranks. Once a second a thread of each rank sends one to rank 0, and rank 0 sends one to each of them, whatever else they
// compute. A rank that is stopped, or whose machine hangs, is named after a quarter of the time limit; after all of it the job ends with
// kStandstillStatus, because MPI cannot go on without one of its ranks. A rank of which only the working thread waits, for a disk for instance, still
// gives signs.
#pragma once

#include <mpi.h>

#include <atomic>
#include <condition_variable>
#include <list>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "core/comm/silence_watch.h"

namespace skyquilt::comm {

class LifeSigns {
 public:
  static constexpr double kUsualLimit_s = 120.0;

  // `mpi` is held during each of its MPI calls. comm: a communicator for these signs alone; it stays the caller's. hosts: of each rank.
  LifeSigns(std::mutex& mpi, MPI_Comm comm, std::vector<std::string> hosts);
  ~LifeSigns();  // ends the thread
  LifeSigns(const LifeSigns&) = delete;
  LifeSigns& operator=(const LifeSigns&) = delete;

  // On rank 0, for all ranks: 0: never.
  void SetLimit(double seconds) { limit_s_ = seconds; }

 private:
  struct Sign {
    MPI_Request request = MPI_REQUEST_NULL;
    double limit_s = 0.0;
  };
  void Run();
  void Exchange();           // sends and receives
  void Judge(double now_s);  // may end the job

  std::mutex& mpi_;
  const MPI_Comm comm_;
  const std::vector<std::string> hosts_;
  int rank_ = 0;
  std::atomic<double> limit_s_ = kUsualLimit_s;
  SilenceWatch watch_;
  std::list<Sign> sent_;
  std::mutex ending_;
  std::condition_variable wake_;
  bool ended_ = false;
  std::thread thread_;
};

}  // namespace skyquilt::comm
