// Trains one field (the context or one block) from pixels to checkpoint. Knows nothing of other blocks or of ranks.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/brightness/luminance.h"
#include "core/brightness/response_learner.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"
#include "worker/block_spec.h"
#include "worker/phase_times.h"
#include "worker/train_options.h"

namespace skyquilt::worker {

struct TrainStatus {
  int64_t step = 0;
  int64_t total_steps = 0;  // expected; a time budget refines it
  double fraction = 0.0;    // of the budget, 0..1
  double seconds = 0.0;     // trained so far, earlier runs included
  double loss = 0.0;
  double psnr_db = 0.0;  // of recent training rays
  double rays_per_second = 0.0;
  double samples_per_second = 0.0;
  double samples_per_ray = 0.0;
};

struct TrainResult {
  bool ok = false;
  std::string reason;  // when not ok
  int64_t steps = 0;
  double seconds = 0.0;
  int64_t samples = 0;
  int64_t rays = 0;
  int64_t parameters = 0;
  double final_psnr_db = 0.0;  // of recent training rays
  int dropped_steps = 0;       // non-finite steps that never reached the parameters
  // Seconds of work per phase (kPhaseNames), summed over threads; of this run alone when training was resumed.
  std::array<double, kPhases> phase_seconds = {};
};

using Reporter = std::function<void(const TrainStatus&)>;

struct TrainJob {
  const survey::Survey* survey = nullptr;
  const image::PixelCache* pixels = nullptr;  // entry i belongs to survey->photos[i]
  // What tags say of the photos' brightness, and what is to be learned beside that. The context learns; blocks take over what it found.
  brightness::Response response;
  brightness::LearnerOptions learn;
  brightness::Luminance luminance;   // of the context; blocks take over its own
  TrainOptions options;              // steps or seconds budget of this field inside
  int min_views = 2;                 // training photos that must see a place for fields to learn it
  double learning_rate_scale = 1.0;  // below 1 on retries
  std::string config_hash;           // stored; a checkpoint with another hash is refused
  uint64_t seed = 1;
  std::filesystem::path checkpoint;  // context.h5 or block_<name>.h5
};

// Both continue from job.checkpoint when it holds this configuration, write it every options.checkpoint_every_s and at the end, and
// return at once when it is complete. Steps that are not finite are dropped and counted; when they persist the result is not ok.
// Throw base::Interrupted after saving when cancelled, base::UsageError for a checkpoint of another configuration,
// base::InputError for a checkpoint that cannot be written.
TrainResult TrainContext(const TrainJob& job, const BlockSpec& area, base::ThreadPool& threads, const Reporter& report);
TrainResult TrainBlock(const TrainJob& job, const BlockSpec& block, const std::filesystem::path& context_checkpoint, base::ThreadPool& threads,
                       const Reporter& report);

}  // namespace skyquilt::worker
