// Writes what a training looks like from inside, one row per step, to find out why it falls apart. Off unless asked for (train.diagnostics): the file
// grows by about 100 bytes per step.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

#include "worker/step/field_step.h"

namespace skyquilt::worker {

class TrainDiagnostics {
 public:
  // file: a CSV; empty: nothing is written. A file of an earlier run is continued.
  explicit TrainDiagnostics(const std::filesystem::path& file) : file_(file) {}

  // Call them before and after a step. networks: the field's. step: its number, 1 for the first.
  void Before(const std::vector<float>& networks);
  // Throws base::InputError when the file cannot be written.
  void After(int64_t step, const StepResult& result, const std::vector<float>& networks, double rate_factor);

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
  std::vector<float> before_;
};

}  // namespace skyquilt::worker
