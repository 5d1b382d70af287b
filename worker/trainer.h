// Trains one field, the context or one block, from pixels to checkpoint. Blocks are independent of each other and of ranks, so they can be trained in
// any order on any machine; all they share is the finished context.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/brightness/luminance.h"
#include "core/brightness/response_learner.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"
#include "worker/block_spec.h"
#include "worker/context_comparison.h"
#include "worker/fall_guard.h"
#include "worker/phase_times.h"
#include "worker/prior_options.h"
#include "worker/robust/rejected_pixels.h"
#include "worker/train_options.h"

namespace skyquilt::worker {

// Progress of a training.
struct TrainStatus {
  int64_t step = 0;
  int64_t total_steps = 0;   // expected; a time budget refines it
  double fraction = 0.0;     // of the budget, 0..1
  double seconds = 0.0;      // training time so far, earlier runs included
  double run_seconds = 0.0;  // of this run alone
  double loss = 0.0;
  double psnr_db = 0.0;  // of recent training rays
  double rays_per_second = 0.0;
  double samples_per_second = 0.0;
  double samples_per_ray = 0.0;
};

struct TrainResult {
  bool ok = false;
  std::string reason;  // why not, when ok is false
  int64_t steps = 0;
  double seconds = 0.0;
  int64_t samples = 0;
  int64_t rays = 0;
  int64_t parameters = 0;
  double final_psnr_db = 0.0;                   // of recent training rays
  int dropped_steps = 0;                        // steps left out because their gradients were not finite
  std::vector<Fall> falls;                      // trainings that fell apart and were taken back
  bool ended_early = false;                     // after too many falls, at its best state
  std::optional<ContextComparison> comparison;  // of a finished block that is guided by the context
  // Whether the scene should show the context where this block is.
  bool ShowsContext() const { return comparison && comparison->block_is_worse; }
  // Working time per phase (kPhaseNames) in seconds, summed over threads; only of this run when training was resumed.
  std::array<double, kPhases> phase_seconds = {};
};

// Called about twice per second during training.
using Reporter = std::function<void(const TrainStatus&)>;

struct TrainJob {
  const survey::Survey* survey = nullptr;
  const image::PixelCache* pixels = nullptr;  // entry i belongs to survey->photos[i]
  // Brightness of the photos: from tags, and what to learn beyond them. Only the context learns; blocks use the response stored with the context.
  brightness::Response response;
  brightness::LearnerOptions learn;
  brightness::Luminance luminance;           // for the context; blocks use the one stored with it
  TrainOptions options;                      // with the budget of this field
  PriorOptions priors;                       // of blocks; the context has none
  trust::LeftOutTiles left_out;              // that nothing is learned from
  const RejectedPixels* rejected = nullptr;  // that blocks do not learn from; null: none
  int min_views = 2;                         // number of training photos that must see a place for the field to learn it
  int attempt = 0;                           // 0, then one more for every retry
  double learning_rate_scale = 1.0;          // factor on the learning rate; below 1 in retries
  std::string config_hash;                   // stored in the checkpoint; one with another hash is refused
  uint64_t seed = 1;
  std::filesystem::path checkpoint;   // context.h5 or block_<name>.h5
  std::filesystem::path diagnostics;  // CSV (train_diagnostics.h); empty: none
  // For tests: a factor on the learning rate of a step, given the number of steps before it.
  std::function<double(int64_t step)> rate_fault;
};

// Both resume from job.checkpoint when it exists and was made with this configuration, write it every options.checkpoint_every_s seconds and at the
// end, and return at once when it is complete. Steps that are not finite are left out and counted; a training that falls apart is taken back
// (train_loop.h); after 20 steps in a row that are not finite, with no good state yet, the result is not ok. Throw base::Interrupted after saving
// when cancelled, base::UsageError for a checkpoint of another configuration, base::InputError for a checkpoint that cannot be written. A block is
// compared with the context at its end. One that was worse is trained anew when job.attempt is higher than before.
TrainResult TrainContext(const TrainJob& job, const BlockSpec& area, base::ThreadPool& threads, const Reporter& report);
TrainResult TrainBlock(const TrainJob& job, const BlockSpec& block, const std::filesystem::path& context_checkpoint, base::ThreadPool& threads,
                       const Reporter& report);

}  // namespace skyquilt::worker
