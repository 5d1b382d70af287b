#include "worker/field_trainer.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::worker {
namespace {

// The distortion loss starts when surfaces are roughly known; earlier it would concentrate density at wrong distances.
constexpr double kDistortionFrom = 0.05, kDistortionTo = 0.5;
constexpr double kDecayFrom = 0.2;  // of the learning rate
constexpr double kWarmUpSteps = 50.0;
constexpr float kOccupancyLimit = 0.01F;
// tau of a step. A cell above kSolidTau (a third of the light stopped in a step) is a surface. Its neighbours get kWakeTau: they are free again after
// about a dozen samples that find no density.
constexpr float kSolidTau = 0.4F, kWakeTau = 0.03F;
constexpr int kFewestRays = 64;
// Share of the training from which samplers of bins mark the cells where rays end.
constexpr double kMarkLitFrom = 0.5;
// Streams of the random generator, so that cells, parameters and rays use independent random numbers.
constexpr uint64_t kCellStream = 2, kInitStream = 3;

Neighbours NeighboursOf(const brightness::Luminance& luminance) {
  if (!luminance.On()) return Neighbours::kNone;
  return luminance.patches ? Neighbours::kPatch : Neighbours::kBatch;
}

// With reduced photos, a field in which light is dimmed by every sample that it passes brightens nothing (tests/worker/brightness_test.cpp); why is
// not known.
TrainOptions WithoutPyramid(TrainOptions options) {
  options.pyramid = {1.0};
  options.pyramid_start.clear();
  return options;
}

std::optional<BinSampler> MakeSampler(const TrainOptions& options, const render::TrainedField& target, const field::HashField& field, uint64_t seed,
                                      base::ThreadPool& threads, PhaseTimes& times) {
  const Sampler sampler = SamplerNamed(options.sampler);
  if (sampler == Sampler::kOccupancy) return std::nullopt;
  return std::make_optional<BinSampler>(sampler, SamplesPerPass(sampler, options.ray_samples), options.stratified, target, field, seed, threads,
                                        times);
}

}  // namespace

FieldTrainer::FieldTrainer(render::TrainedField& target, RaySource& source, const render::TrainedField* context, const TrainOptions& options,
                           AppearanceCodes codes, uint64_t seed, const LuminancePlan& luminance, brightness::ResponseLearner* learner,
                           const FieldPriors& priors, base::ThreadPool& threads, PoseLearner* poses)
    : target_(target),
      options_(luminance.luminance.On() && luminance.luminance.product ? WithoutPyramid(options) : options),
      start_log_gain_(luminance.start.mean_log_gain),
      seed_(seed),
      threads_(threads),
      times_(threads.size()),
      field_(target.config),
      sampler_(MakeSampler(options, target, field_, seed, threads, times_)),
      drawer_(target, source, seed, NeighboursOf(luminance.luminance), options.stratified, sampler(), threads, times_),
      step_(target, field_, context, luminance, threads, times_),
      learner_(learner),
      codes_(std::move(codes)),
      poses_(poses != nullptr && poses->On() ? poses : nullptr),
      priors_(priors),
      source_(source),
      rays_per_step_(std::max(kFewestRays, options.batch_samples / (sampler_ ? sampler_->LastBins() : 24))),
      evaluators_(static_cast<size_t>(threads.size())) {
  target.parameters.Allocate(field_);
  state_.Allocate(field_);
}

void FieldTrainer::InitializeParameters() {
  base::Random random(seed_, kInitStream);
  field_.Initialize(random, target_.parameters.grid, target_.parameters.networks);
  if (sampler_) sampler_->InitializeParameters();
  if (!target_.config.luminance) return;
  const double omega = std::clamp(std::exp(start_log_gain_), 1e-4, 1.0 - 1e-4);
  target_.parameters.networks[static_cast<size_t>(field_.LuminanceOffset() + field::kLuminanceTaps)] =
      static_cast<float>(std::log(omega / (1.0 - omega)));
}

void FieldTrainer::MeasureFootprints() {
  if (!target_.config.Cones()) return;
  constexpr int kRays = 8192;
  constexpr uint64_t kNoStep = ~uint64_t{0};
  if (sampler_) sampler_->Begin(0.0, RayDrawer::Groups(kRays));
  // At full size, so that the range does not depend on the drawn levels.
  drawer_.Draw(static_cast<int64_t>(kNoStep >> 1U), kRays, field_.FeatureRows(), PhotoPyramid(), {}, &batch_);
  std::vector<double> widths;
  for (const BatchRay& ray : batch_.rays) {
    for (int64_t s = ray.begin; s < ray.begin + ray.count; ++s) {
      widths.push_back(static_cast<double>(ray.ray.pixel_pitch) * static_cast<double>(batch_.t[static_cast<size_t>(s)]));
    }
  }
  if (widths.empty()) return;
  std::sort(widths.begin(), widths.end());
  const size_t rare = widths.size() / 100;  // on each side
  const PyramidRange range = RangeOf(options_.pyramid, options_.pyramid_start);
  target_.footprint_min_m = widths[rare] * (1 << range.finest);
  target_.footprint_max_m = widths[widths.size() - 1 - rare] * (1 << range.coarsest);
}

StepResult FieldTrainer::Step(double progress, double learning_rate_scale) {
  const PhotoPyramid pyramid(options_.pyramid, options_.pyramid_start, kPyramidUntil, progress);
  StepOptions step;
  step.priors = priors_.StepAt(progress, target_.step_m / options_.step_voxels);
  if (sampler_) sampler_->Begin(progress, RayDrawer::Groups(rays_per_step_));
  drawer_.Draw(state_.step, rays_per_step_, field_.FeatureRows(), pyramid, priors_.RaysFor(step.priors), &batch_);
  const double warm_up = std::min(1.0, static_cast<double>(state_.step + 1) / kWarmUpSteps);
  const double decay = std::pow(options_.final_learning_rate_share, std::clamp((progress - kDecayFrom) / (1.0 - kDecayFrom), 0.0, 1.0));
  step.learning_rate = options_.learning_rate * learning_rate_scale * warm_up * decay;
  step.network_l2 = kNetworkL2;
  step.distortion = options_.distortion * std::clamp((progress - kDistortionFrom) / (kDistortionTo - kDistortionFrom), 0.0, 1.0);
  brightness::ResponseLearner* learner = learner_ != nullptr && learner_->active() ? learner_ : nullptr;
  const bool refines = poses_ != nullptr && poses_->ActiveAt(progress);
  if (refines) ray_gradients_.level_shares = PoseLearner::LevelShares(progress, field_.encoding().parts());
  const StepResult result = step_.Train(batch_, step, target_.parameters, state_, learner, &codes_, refines ? &ray_gradients_ : nullptr);
  if (learner != nullptr && result.finite) {
    learner->Step(progress);
    source_.UpdateExposures();
  }
  if (refines && result.finite) RefinePoses(progress);
  if (!sampler_) ObserveSamples();
  if (sampler_ && result.finite) UseFoundWeights(progress, step.learning_rate);
  // Chooses the next number of rays so that the batch is full at this step's samples per ray; it changes by a quarter at most.
  if (result.n_rays > 0 && result.n_samples > 0) {
    const double wanted = static_cast<double>(options_.batch_samples) * result.n_rays / static_cast<double>(result.n_samples);
    const double next = std::clamp(wanted, 0.8 * rays_per_step_, 1.25 * rays_per_step_);
    rays_per_step_ = std::clamp(static_cast<int>(next), kFewestRays, options_.batch_samples / 2);
  }
  return result;
}

void FieldTrainer::RefinePoses(double progress) {
  const double ray_share = 1.0 / static_cast<double>(batch_.rays.size());
  for (size_t k = 0; k < batch_.rays.size(); ++k) {
    if (!batch_.rays[k].ray.empty) poses_->Add(batch_.rays[k].ray, ray_gradients_.rays[k], ray_share);
  }
  poses_->Step(progress, source_);
}

// Updates the occupancy of sampled cells. Each task updates a range of cells in the order of the samples, so that bits do not depend on threads. A
// cell that is always behind surfaces becomes free like an empty one.
void FieldTrainer::ObserveSamples() {
  field::OccupancyGrid& grid = target_.occupancy;
  const std::vector<float>& depth = step_.ObservedTaus();
  const int64_t tasks = std::min(threads_.size(), 8);
  threads_.ParallelFor(tasks, [&](int64_t task, int thread) {
    const auto start = PhaseTimes::Clock::now();
    const int64_t first = task * grid.CellCount() / tasks;
    const int64_t end = (task + 1) * grid.CellCount() / tasks;
    for (const Packet& packet : batch_.packets) {
      for (auto s = static_cast<size_t>(packet.begin); s < static_cast<size_t>(packet.begin + packet.count); ++s) {
        const bool sharp = batch_.cell[s] >= 0;
        const int64_t cell = sharp ? batch_.cell[s] : ~batch_.cell[s];
        if (cell >= first && cell < end) grid.Observe(cell, depth[s], sharp);
      }
    }
    times_.Add(thread, Phase::kOccupancy, start);
  });
}

void FieldTrainer::UseFoundWeights(double progress, double learning_rate) {
  const bool marks = progress >= kMarkLitFrom, learns = sampler_->Learns(progress, state_.step);
  if (!marks && !learns) return;
  const auto start = PhaseTimes::Clock::now();
  // Compositing weights of the last step's samples. Behind the last sample that light reached all are 0.
  const std::vector<float>& taus = step_.ObservedTaus();
  const auto bins = static_cast<size_t>(sampler_->LastBins());
  found_.resize(batch_.rays.size() * bins);
  for (size_t r = 0; r < batch_.rays.size(); ++r) {
    const auto begin = static_cast<size_t>(batch_.rays[r].begin);
    const std::span<float> weights(found_.data() + r * bins, bins);
    for (size_t i = 0; i < bins; ++i) weights[i] = taus[begin + i] * batch_.unit_length[begin + i];
    WeightsOfTaus(std::span<const float>(weights), weights.data());
  }
  if (marks) sampler_->MarkLit(found_, target_.occupancy);
  times_.Add(0, Phase::kSampler, start);
  if (learns) sampler_->Learn(found_, learning_rate);
}

void FieldTrainer::DensityAt(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z, std::vector<float>* depth) {
  const auto n = static_cast<int64_t>(x.size());
  depth->assign(x.size(), 0.0F);
  constexpr int64_t kRun = 16 * field::kChunk;
  const field::NetworkWeights weights = field_.Prepare(target_.parameters.networks);
  threads_.ParallelFor((n + kRun - 1) / kRun, [&](int64_t task, int thread) {
    const auto start = PhaseTimes::Clock::now();
    const int64_t begin = task * kRun;
    evaluators_[static_cast<size_t>(thread)].Evaluate(field_, weights, target_.parameters.grid,
                                                      {x.data() + begin, y.data() + begin, z.data() + begin}, std::min(kRun, n - begin),
                                                      depth->data() + begin);
    times_.Add(thread, Phase::kOccupancy, start);
  });
}

void FieldTrainer::FindOccupied() {
  constexpr int64_t kCellsAtOnce = 1 << 16;
  constexpr int kPlacesPerCell = 8;  // one in each eighth
  field::OccupancyGrid& grid = target_.occupancy;
  // The lit cells and their neighbours, as not every cell of a surface was hit.
  field::OccupancyGrid lit = grid;
  lit.occupied.assign(grid.judged.begin(), grid.judged.end());
  // A training that ended before any were marked may have density everywhere.
  if (lit.OccupiedShare() == 0.0) lit.occupied.flip();
  lit.Dilate(1);
  std::vector<int64_t> chosen;
  std::vector<float> x, y, z, depth;
  base::Random random(MixSeed(seed_, static_cast<uint64_t>(state_.step), 1), kCellStream);
  for (int64_t first = 0; first < grid.CellCount(); first += kCellsAtOnce) {
    for (auto* v : {&x, &y, &z}) v->clear();
    chosen.clear();
    for (int64_t index = first; index < std::min(grid.CellCount(), first + kCellsAtOnce); ++index) {
      float& tau = grid.tau[static_cast<size_t>(index)];
      if (tau < 0.0F) continue;
      tau = 0.0F;
      if (!lit.occupied[static_cast<size_t>(index)]) continue;
      chosen.push_back(index);
      const int64_t at[3] = {index % grid.size[0], index / grid.size[0] % grid.size[1], index / grid.size[0] / grid.size[1]};
      for (int place = 0; place < kPlacesPerCell; ++place) {
        x.push_back((static_cast<float>(at[0]) + 0.5F * (static_cast<float>(place & 1) + random.Uniform())) * grid.cell);
        y.push_back((static_cast<float>(at[1]) + 0.5F * (static_cast<float>(place >> 1 & 1) + random.Uniform())) * grid.cell);
        z.push_back((static_cast<float>(at[2]) + 0.5F * (static_cast<float>(place >> 2) + random.Uniform())) * grid.cell);
      }
    }
    DensityAt(x, y, z, &depth);
    for (size_t i = 0; i < chosen.size(); ++i) {
      const auto places = depth.begin() + static_cast<ptrdiff_t>(i) * kPlacesPerCell;
      grid.tau[static_cast<size_t>(chosen[i])] = *std::max_element(places, places + kPlacesPerCell);
    }
  }
  grid.UpdateOccupied(kOccupancyLimit);
}

void FieldTrainer::UpdateOccupancy(bool grow) {
  if (sampler_) return;
  field::OccupancyGrid& grid = target_.occupancy;
  base::Random random(MixSeed(seed_, static_cast<uint64_t>(state_.step), 0), kCellStream);
  std::vector<int64_t> chosen;
  std::vector<float> x, y, z, depth;
  // Random samples in free cells find density that has appeared where rays are not sampled.
  const int64_t budget = options_.batch_samples / 2;
  for (int64_t i = 0; i < budget; ++i) {
    const int64_t index = random.Below(static_cast<uint32_t>(grid.CellCount()));
    if (grid.tau[static_cast<size_t>(index)] < 0.0F || grid.occupied[static_cast<size_t>(index)]) continue;
    const int64_t cell_x = index % grid.size[0], cell_y = index / grid.size[0] % grid.size[1], cell_z = index / grid.size[0] / grid.size[1];
    chosen.push_back(index);
    x.push_back((static_cast<float>(cell_x) + random.Uniform()) * grid.cell);
    y.push_back((static_cast<float>(cell_y) + random.Uniform()) * grid.cell);
    z.push_back((static_cast<float>(cell_z) + random.Uniform()) * grid.cell);
  }
  DensityAt(x, y, z, &depth);
  const auto start = PhaseTimes::Clock::now();
  for (size_t i = 0; i < chosen.size(); ++i) grid.UpdateTau(chosen[i], depth[i]);
  if (grow) grid.RaiseNeighbours(kSolidTau, kWakeTau);
  grid.UpdateOccupied(kOccupancyLimit);
  times_.Add(0, Phase::kOccupancy, start);
}

}  // namespace skyquilt::worker
