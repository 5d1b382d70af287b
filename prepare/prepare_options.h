// What a person may choose about `prepare`. Defaults live only here.
#pragma once

#include <string>

#include "core/config/options.h"

namespace skyquilt::prepare {

struct PrepareOptions {
  std::string holdout = "every:8";
  double ransac_threshold_m = 10.0;
  std::string camera_model = "OPENCV";
  std::string colmap = "colmap";
  int max_image_size = 1600;
  int max_features = 8192;
  bool use_gpu = false;
  std::string masks;
  double flight_gap_s = 900.0;
  std::string flight_offsets = "auto";
  int seed = 1;

  void Visit(config::OptionVisitor& v);
  // Throws base::UsageError naming the option, its value and what is allowed.
  void Validate() const;
};

}  // namespace skyquilt::prepare
