// One optimiser step of one field: rays -> samples -> densities -> live samples -> colours -> loss -> gradients -> Adam.
// Bits do not depend on the number of threads: rays come from (seed, step, group), grid levels have one writer each and network
// gradients are summed in fixed slots.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/field/optimizer.h"
#include "core/render/ray_box.h"
#include "core/render/ray_engine.h"
#include "core/render/trained_field.h"
#include "worker/ray_source.h"
#include "worker/train_options.h"

namespace skyquilt::worker {

struct StepResult {
  int n_rays = 0;
  int64_t n_samples = 0;       // evaluated for density
  int64_t n_live = 0;          // with colour and gradient
  double loss = 0.0;           // mean over rays
  double squared_error = 0.0;  // mean over colour rays and channels, display values
  bool finite = true;          // false: the step was dropped
};

class FieldTrainer {
 public:
  // target.grid and target.networks are not used here (they live in state) except through Publish / Adopt. context may be null.
  FieldTrainer(render::TrainedField& target, const RaySource& source, const render::TrainedField* context, const TrainOptions& options, uint64_t seed,
               base::ThreadPool& threads);

  field::TrainableState& state() { return state_; }
  int& rays_per_step() { return rays_per_step_; }
  void InitializeParameters();

  // progress in [0, 1] of the budget sets the learning rate.
  StepResult Step(double progress, double learning_rate_scale);
  // Looks for matter in cells that are not sampled, then decides which cells are. `grow` also wakes the cells around surfaces.
  void UpdateOccupancy(bool grow);
  // Optical depth of one marching step at unit positions (SoA, n).
  void StepDepths(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z, std::vector<float>* depth);

 private:
  struct RayState {
    PixelRay ray;
    render::Stretch stretch;
    int64_t begin = 0, count = 0;            // all samples
    int64_t live_begin = 0, live_count = 0;  // those before the light is used up
    float front_rgb[3] = {0, 0, 0}, front_transmittance = 1.0F;
    float behind_rgb[3] = {0, 0, 0};
    float transmittance = 1.0F;
    float background[3] = {0, 0, 0};
  };
  // What one task draws.
  struct RayGroup {
    std::vector<RayState> rays;
    std::vector<float> x, y, z, t, unit_length;
  };
  void DrawRays();
  void EvaluateDensity();
  void SelectLive();
  void EvaluateColor();
  void FrozenContext();
  StepResult ComposeAndLoss();
  bool BackwardAndUpdate(double learning_rate);
  // Optical depth of one marching step at a raw density.
  float StepDepth(float raw) const { return std::exp(std::min(15.0F, raw + static_cast<float>(target_.config.density_bias))); }

  render::TrainedField& target_;
  const RaySource& source_;
  const render::TrainedField* context_;
  TrainOptions options_;
  uint64_t seed_;
  base::ThreadPool& threads_;
  field::HashField field_;
  field::TrainableState state_;
  field::NetworkWeights weights_;
  std::vector<field::ChunkScratch> scratch_;
  int rays_per_step_ = 1024;
  double distortion_ = 0.0;  // weight in this step

  // Rays of the current step.
  std::vector<RayGroup> groups_;
  std::vector<RayState> rays_;
  // Samples, then live samples; structures of arrays.
  std::vector<float> x_, y_, z_, t_, unit_length_;
  std::vector<float> features_, geometry_, step_depth_;
  size_t stride_ = 0;
  std::vector<float> live_x_, live_y_, live_z_, live_t_, live_tau_, live_direction_;
  std::vector<float> live_features_, live_geometry_, live_color_, live_rgb_, live_weight_;
  std::vector<float> color_gradient_, tau_gradient_, feature_gradient_;
  std::vector<float> slot_gradients_;
  int64_t n_samples_ = 0, n_live_ = 0;
  size_t live_stride_ = 0;
};

}  // namespace skyquilt::worker
