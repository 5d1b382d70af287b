// How much work the qualities of OpenDroneMap's options mean here: presets, sizes and time. The table stands in docs/odm.md.
#pragma once

#include <string>

namespace skyquilt::odm {

struct Workload {
  int photos = 0;
  double megapixels = 12.0;  // of a photo
  int cores = 1;
};

struct Effort {
  std::string preset;       // fast, default or quality (app/settings/presets.h)
  double training_s = 0.0;  // for context and blocks together; a whole multiple of 10 s
  int feature_size = 0;     // longer side at which features are searched, pixels
};

// pc_quality, feature_quality: ultra, high, medium, low or lowest. Time is proportional to the photos and to the square root of their pixels, and
// inversely to the cores; at least a minute, at most a day. megapixels <= 0: taken for 12.
Effort EffortOf(const std::string& pc_quality, const std::string& feature_quality, bool fast_orthophoto, const Workload& workload);

}  // namespace skyquilt::odm
