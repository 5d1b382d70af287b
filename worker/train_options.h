// Options of training one field: [context] and [train] in the configuration.
#pragma once

#include <string>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::worker {

struct TrainOptions {
  int steps = 0;              // > 0: exactly this many
  double seconds = 0.0;       // time budget of this field when steps = 0; both 0: kDefaultSteps
  int batch_samples = 32768;  // samples per step; the number of rays adapts to it
  std::string encoding = "hash";
  int levels = 8;
  int features = 4;
  int base_resolution = 16;
  int hidden = 64;
  int density_hidden_layers = 1;
  int color_hidden_layers = 1;
  int sh_degree = 3;
  double learning_rate = 3e-2;
  double final_learning_rate_share = 0.1;
  double step_voxels = 2.0;
  bool stratified = true;
  double network_l2 = 1e-6;
  double distortion = 1e-2;
  double empty_ray_share = 0.05;
  double checkpoint_every_s = 20.0;
  std::string coupling = "guided";
  std::string start = "surfaces";

  static std::vector<config::Field<TrainOptions>> Fields();
  // Throws base::UsageError naming the option and the rule it broke; `section` is its name in the configuration.
  void Check(const std::string& section) const;
};

constexpr int kDefaultSteps = 2000;

}  // namespace skyquilt::worker
