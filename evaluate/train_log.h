// What training left behind for the report: train.json of the scheduler and one <field>.log.csv per field.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace skyquilt::evaluate {

struct CurvePoint {
  double step = 0.0;
  double seconds = 0.0;
  double loss = 0.0;     // NaN when the column is absent or unreadable
  double psnr_db = 0.0;  // of the training batches
};

struct FieldLog {
  std::string name;  // "context" or a block's name
  bool ok = false;
  std::string reason;  // when not ok
  int64_t steps = 0;
  double seconds = 0.0;
  int64_t samples = 0;
  int64_t rays = 0;
  int64_t parameters = 0;
  double psnr_db = 0.0;  // NaN when unknown
  int64_t dropped_steps = 0;
  std::vector<std::pair<std::string, double>> stage_seconds;  // work per stage of a step, summed over threads
  std::vector<CurvePoint> curve;
};

struct TrainLog {
  bool found = false;
  int ranks = 0;  // 0 when unknown
  int threads = 0;
  double wall_seconds = 0.0;
  int64_t peak_rss_bytes = 0;
  std::vector<FieldLog> fields;

  const FieldLog* Find(const std::string& name) const;  // nullptr when absent
  // Wall time, at least the fields' own time shared by the ranks: a resumed run's last session alone would flatter. NaN when unknown.
  double TrainSeconds() const;
  double SamplesPerRay() const;     // of all fields together; NaN when unknown
  double SamplesPerSecond() const;  // of all ranks together; NaN when unknown
};

// Missing files give an empty log or empty curves. A damaged train.json counts as missing, with a warning.
TrainLog ReadTrainLog(const std::filesystem::path& train_json, const std::filesystem::path& checkpoint_folder);
// Columns by the names in the header: step, seconds, loss, psnr. Lines that do not parse (a write cut short) are skipped.
std::vector<CurvePoint> ParseCurve(const std::string& csv);

}  // namespace skyquilt::evaluate
