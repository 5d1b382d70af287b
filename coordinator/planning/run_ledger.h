// What a run within a total time has used and decided so far, so that a resumed run goes on with the same: .state/within.json. It is saved every few
// seconds, so that a run that was killed has its time counted.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/project/project.h"
#include "core/config/override.h"
#include "evaluate/metrics/run_times.h"

namespace skyquilt::coordinator {

// One stage of the run. Seconds; NaN: not known.
struct StageRecord {
  std::string stage;
  double planned_s = evaluate::kNotMeasured;    // by the first plan
  double predicted_s = evaluate::kNotMeasured;  // when it was decided
  double took_s = 0.0;                          // earlier runs included
  bool decided = false, begun = false, done = false;
  std::vector<config::Override> changes;  // of options
};

struct GivenUp {
  std::string what, stage, text;  // as in Reduction
};

class RunLedger {
 public:
  using Clock = std::function<double()>;  // seconds since any moment, never backwards

  static std::filesystem::path FileOf(const Project& project) { return project.StateFolder() / "within.json"; }

  // Reads what an earlier run has left; a damaged file is left aside with a warning. save_every_s: 0: only when something changes.
  RunLedger(const Project& project, Clock clock, double save_every_s);
  ~RunLedger();
  RunLedger(const RunLedger&) = delete;
  RunLedger& operator=(const RunLedger&) = delete;

  // Time passes from here on.
  void Start();
  double UsedSeconds() const;  // earlier runs included

  // In the order in which they were first named.
  std::vector<StageRecord> Stages() const;
  StageRecord Of(const std::string& stage) const;  // without any value when it is not there
  std::vector<GivenUp> AllGivenUp() const;

  void SetPlanned(const std::string& stage, double seconds);  // the first value stays
  // The first decision stays.
  void Decide(const std::string& stage, double predicted_s, const std::vector<config::Override>& changes);
  // A stage begins, perhaps once more.
  void Begin(const std::string& stage);
  void End(const std::string& stage);
  // Replaces what was given up for this stage.
  void SetGivenUp(const std::string& stage, const std::vector<GivenUp>& given_up);
  void Forget();  // all of it; for --restart

 private:
  StageRecord& Entry(const std::string& stage);
  double Now() const;
  // What the running stage has taken up to now is added to it.
  void Settle();
  void Save();
  void KeepSaving(double every_s);

  const Project project_;
  const Clock clock_;
  const double save_every_s_;
  mutable std::mutex mutex_;  // guards all below but the thread
  std::condition_variable wake_;
  std::thread saver_;
  bool ends_ = false, started_ = false;
  double used_before_s_ = 0.0, start_s_ = 0.0, settled_s_ = 0.0;
  std::string running_;  // stage
  std::vector<StageRecord> stages_;
  std::vector<GivenUp> given_up_;
};

}  // namespace skyquilt::coordinator
