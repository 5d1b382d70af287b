// The training results of a scene's fields: train.json, for reports and for resuming.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace skyquilt::scene {

struct FieldTraining {
  std::string name;         // "context" or a block's name
  int block = -1;           // position in the survey's blocks; -1: the context
  bool ok = false;          // finished, with a checkpoint that can be merged
  std::string reason = {};  // when not ok
  int64_t steps = 0;
  double seconds = 0.0;       // trained, earlier runs included
  double wall_seconds = 0.0;  // of the run that finished it
  int64_t samples = 0;
  int64_t rays = 0;
  int64_t parameters = 0;
  double psnr_db = 0.0;  // of recent training rays; NaN when unknown
  int64_t dropped_steps = 0;
  int attempts = 1;
  int rank = 0;
  int threads = 0;
  int64_t peak_rss_bytes = 0;
  std::map<std::string, double> phase_seconds = {};  // work per phase of a step, summed over threads
};

struct TrainReport {
  int ranks = 0;    // 0 when unknown
  int threads = 0;  // per rank that trains
  double wall_seconds = 0.0;
  std::string config_hash;
  std::vector<FieldTraining> fields;

  const FieldTraining* Find(const std::string& name) const;  // nullptr when absent
  std::vector<std::string> Failed() const;                   // "block_r0c1: reason" of each that is not ok
  int64_t Samples() const;                                   // of all fields together, as the next two
  int64_t Parameters() const;
  int64_t PeakRssBytes() const;  // of the rank that needed most
  // Wall time, at least the fields' own time shared by the ranks: a resumed run's last session alone would flatter. NaN when unknown.
  double TrainSeconds() const;
  double SamplesPerRay() const;     // of all fields together; NaN when unknown
  double SamplesPerSecond() const;  // of all ranks together; NaN when unknown
};

// Throws base::InputError when the file cannot be written.
void WriteTrainReport(const TrainReport& report, const std::filesystem::path& file);
// Keys that are missing or of another kind are as above. Throws base::InputError when the file is missing, no JSON object or without fields.
TrainReport ReadTrainReport(const std::filesystem::path& file);
// Nothing when the file is missing or damaged, the latter with a warning.
std::optional<TrainReport> TryReadTrainReport(const std::filesystem::path& file);

}  // namespace skyquilt::scene
