// Trains one field (the context or one block) from pixels to checkpoint. Knows nothing of other blocks or of ranks.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "core/base/thread_pool.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"
#include "worker/box_view.h"
#include "worker/train_options.h"

namespace skyquilt::worker {

struct TrainStatus {
  int64_t step = 0;
  int64_t total_steps = 0;      // expected; time budgets refine it
  double fraction = 0.0;        // of the budget, 0..1
  double seconds = 0.0;         // trained so far, earlier runs included
  double loss = 0.0;
  double psnr_db = 0.0;         // of the training batches, running mean
  double rays_per_second = 0.0;
  double samples_per_second = 0.0;
  double samples_per_ray = 0.0;
};

struct TrainResult {
  bool ok = false;
  std::string reason;           // when not ok
  int64_t steps = 0;
  double seconds = 0.0;
  int64_t samples = 0;
  int64_t rays = 0;
  int64_t parameters = 0;
  double final_psnr_db = 0.0;
  int dropped_steps = 0;        // non-finite steps that never reached the parameters
};

using Reporter = std::function<void(const TrainStatus&)>;

struct TrainJob {
  const survey::Survey* survey = nullptr;
  const image::PixelCache* pixels = nullptr;   // entry i belongs to survey->photos[i]
  TrainOptions options;                        // steps or seconds budget of this field inside
  std::string config_hash;                     // stored; a checkpoint with another hash is refused
  uint64_t seed = 1;
  std::filesystem::path checkpoint;            // context.h5 or block_<name>.h5
};

// Continues from job.checkpoint if it holds this configuration; writes it every options.checkpoint_every_s and at the end.
// Returns at once when the checkpoint is already complete. Throws base::Interrupted after saving when cancelled.
TrainResult TrainContext(const TrainJob& job, const BoxView& area, base::ThreadPool& threads, const Reporter& report);
TrainResult TrainBlock(const TrainJob& job, const BoxView& block, const std::filesystem::path& context_checkpoint, base::ThreadPool& threads, const Reporter& report);

}  // namespace skyquilt::worker
