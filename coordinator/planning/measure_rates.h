// Measures in a few seconds how fast this machine works. What cannot be measured keeps its usual value.
#pragma once

#include <filesystem>

#include "coordinator/planning/rates.h"
#include "coordinator/planning/work_size.h"
#include "coordinator/project/settings.h"
#include "core/base/thread_pool.h"

namespace skyquilt::coordinator {

struct RateSource {
  std::filesystem::path photos;       // folder
  std::filesystem::path model;        // camera model; may be empty
  std::filesystem::path work_folder;  // is made and removed again; nothing else may be in it
  bool poses = true;                  // false: features and matches are not needed any more
  bool photos_to_decode = true;       // false: only training is measured
};

// Training steps on random rays, decoding of photos, COLMAP's features of a few of the photos, matching of random features. Throws base::Interrupted.
Rates MeasureRates(const WorkSize& size, const Settings& settings, const RateSource& source, base::ThreadPool& threads);

}  // namespace skyquilt::coordinator
