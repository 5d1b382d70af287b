// What programs that start OpenDroneMap watch: lines on standard output when a stage begins and ends, and the progress of the whole as datagrams to
// port 6367 of this machine ("PGUP/<process>/<dataset>/<percent>"), where NodeODM listens. Nobody has to.
#pragma once

#include <chrono>
#include <mutex>
#include <string>
#include <vector>

#include "odm/stage_names.h"

namespace skyquilt::odm {

class StageLines {
 public:
  static constexpr int kPort = 6367;

  // dataset: its name, which is the identity of NodeODM's task. Listens to base::Progress until it is destroyed.
  explicit StageLines(std::string dataset, int port = kPort);
  ~StageLines();
  StageLines(const StageLines&) = delete;
  StageLines& operator=(const StageLines&) = delete;

  // "[INFO]    Running opensfm stage" and "[INFO]    Finished opensfm stage" for each of the step's names.
  void Begin(const Step& step);
  void End(const Step& step);
  // One line of a message.
  void Say(const std::string& line);

 private:
  void Report(const std::string& label, double share);
  void Send(double percent, bool now);  // mutex_ must be locked

  std::mutex mutex_;  // progress comes from other threads too; guards all below
  std::string dataset_;
  int socket_ = -1;
  int port_;
  const Step* step_ = nullptr;
  std::string label_;     // of the progress that was heard last
  double begin_ = 0.0;    // percent where it began
  double percent_ = 0.0;  // told last, never falls
  std::chrono::steady_clock::time_point last_sent_;
};

}  // namespace skyquilt::odm
