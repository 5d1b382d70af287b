// Reads and writes train.json, the training record of all fields of a scene, for the report and for resuming.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace skyquilt::scene {

// A training that fell apart and was taken back to an earlier state.
struct FieldFall {
  int64_t step = 0;                          // at which it was noticed
  double best_psnr_db = 0.0, psnr_db = 0.0;  // of recent training rays, before and after the fall; NaN: not finite
  int64_t restored_step = 0;
};

struct FieldTraining {
  std::string name;         // "context" or a block's name
  int block = -1;           // position in the survey's blocks; -1: the context
  bool ok = false;          // finished, with a checkpoint that can be merged
  std::string reason = {};  // why not, when ok is false
  int64_t steps = 0;
  double seconds = 0.0;       // training time, earlier runs included
  double wall_seconds = 0.0;  // in the run that finished it
  int64_t samples = 0;        // evaluated in all steps together
  int64_t rays = 0;
  int64_t parameters = 0;
  double psnr_db = 0.0;               // of recent training rays; NaN when unknown
  int64_t dropped_steps = 0;          // steps left out because they were not finite
  std::vector<FieldFall> falls = {};  // of the training
  bool ended_early = false;           // after too many of them, at its best state
  // Of a finished block that the context guided, over the same training pixels; NaN when unknown. The scene shows the context where it is clearly
  // better.
  double block_psnr_db = std::numeric_limits<double>::quiet_NaN(), context_psnr_db = std::numeric_limits<double>::quiet_NaN();
  bool shows_context = false;
  int attempts = 1;
  int rank = 0;
  int threads = 0;
  int64_t peak_rss_bytes = 0;
  std::map<std::string, double> phase_seconds = {};  // working time per phase of a step, summed over threads
};

struct TrainReport {
  int ranks = 0;    // 0 when unknown
  int threads = 0;  // per rank that trains
  double wall_seconds = 0.0;
  std::string config_hash;
  std::vector<FieldTraining> fields;

  const FieldTraining* Find(const std::string& name) const;  // nullptr when absent
  std::vector<std::string> Failed() const;                   // "block_r0c1: reason" of each that is not ok
  int64_t Samples() const;                                   // of all fields together
  int64_t Parameters() const;                                // of all fields together
  int64_t PeakRssBytes() const;                              // of the rank that needed most
  // Training time of the scene: wall_seconds, but at least the fields' training time divided by the number of ranks, because wall_seconds of a
  // resumed run covers only its last session. NaN when unknown.
  double TrainSeconds() const;
  double SamplesPerRay() const;     // of all fields together; NaN when unknown
  double SamplesPerSecond() const;  // of all ranks together; NaN when unknown
};

// Throws base::InputError when the file cannot be written.
void WriteTrainReport(const TrainReport& report, const std::filesystem::path& file);
// Missing keys, and keys of the wrong type, give the defaults above. Throws base::InputError when the file is missing, is not a JSON object, or has
// no "fields".
TrainReport ReadTrainReport(const std::filesystem::path& file);
// Empty when the file is missing, or damaged (with a warning).
std::optional<TrainReport> TryReadTrainReport(const std::filesystem::path& file);

}  // namespace skyquilt::scene
