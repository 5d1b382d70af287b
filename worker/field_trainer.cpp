#include "worker/field_trainer.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/brightness/exposure.h"
#include "core/render/composite.h"
#include "core/render/march.h"

namespace skyquilt::worker {
namespace {

constexpr int kGroupRays = 64;
constexpr int kMaxRaySamples = 1024;
constexpr int kGradientSlots = 16;
// Matter is drawn together once photos have said roughly where it is; sooner, it would settle in the wrong place.
constexpr double kDistortionFrom = 0.05, kDistortionTo = 0.5;
constexpr float kLiveTransmittance = 1e-3F;
constexpr float kOccupancyLimit = 0.01F;
// A surface stops a third of the light in a step; a woken cell falls asleep again after a dozen samples that find nothing.
constexpr float kSolidDepth = 0.4F, kWakeDepth = 0.03F;
// Streams of the random generator, so that rays and cells never share numbers.
constexpr uint64_t kRayStream = 1, kCellStream = 2, kInitStream = 3;

uint64_t Mix(uint64_t seed, uint64_t step, uint64_t index) {
  uint64_t v = seed * 0x9E3779B97F4A7C15ULL + step * 0xBF58476D1CE4E5B9ULL + index * 0x94D049BB133111EBULL;
  v ^= v >> 31U;
  v *= 0xD6E8FEB86659FD93ULL;
  return v ^ (v >> 32U);
}

// All exponents below the one of infinity and NaN; integer form, so that it runs at memory speed.
bool AllFinite(const float* values, int64_t n) {
  constexpr uint32_t kExponent = 0x7F800000U;
  uint32_t bad = 0;
  for (int64_t i = 0; i < n; ++i) bad |= (std::bit_cast<uint32_t>(values[i]) & kExponent) == kExponent ? 1U : 0U;
  return bad == 0;
}

template <typename T>
void Grow(std::vector<T>& v, size_t n) {
  if (v.size() < n) v.resize(n + n / 4);
}

}  // namespace

FieldTrainer::FieldTrainer(render::TrainedField& target, const RaySource& source, const render::TrainedField* context, const TrainOptions& options,
                           uint64_t seed, base::ThreadPool& threads)
    : target_(target), source_(source), context_(context), options_(options), seed_(seed), threads_(threads), field_(target.config) {
  state_.Allocate(field_);
  for (int i = 0; i < threads.size(); ++i) scratch_.push_back(field_.MakeScratch());
  rays_per_step_ = std::max(64, options.batch_samples / 24);
}

void FieldTrainer::InitializeParameters() {
  base::Random random(seed_, kInitStream);
  field_.Initialize(random, state_.grid, state_.networks);
}

void FieldTrainer::DrawRays() {
  const int n_groups = (rays_per_step_ + kGroupRays - 1) / kGroupRays;
  groups_.resize(static_cast<size_t>(n_groups));
  threads_.ParallelFor(n_groups, [&](int64_t task, int) {
    RayGroup& group = groups_[static_cast<size_t>(task)];
    group.rays.clear();
    for (auto* v : {&group.x, &group.y, &group.z, &group.t, &group.unit_length}) v->clear();
    base::Random random(Mix(seed_, static_cast<uint64_t>(state_.step), static_cast<uint64_t>(task)), kRayStream);
    for (int i = 0; i < kGroupRays; ++i) {
      RayState r;
      if (!source_.Draw(random, &r.ray)) continue;
      const float jitter = random.Uniform();
      for (float& channel : r.background) channel = random.Uniform();
      r.stretch = render::FieldStretch(target_.map, r.ray.origin_enu, r.ray.direction_enu);
      if (r.stretch.Empty()) continue;
      r.begin = static_cast<int64_t>(group.x.size());
      render::March(target_, r.ray.origin_enu, r.ray.direction_enu, r.stretch, target_.step_m, jitter, [&](double t, double, double unit_length) {
        const Eigen::Vector3f p = target_.map.UnitFromEnu(r.ray.origin_enu + t * r.ray.direction_enu);
        group.x.push_back(p.x());
        group.y.push_back(p.y());
        group.z.push_back(p.z());
        group.t.push_back(static_cast<float>(t));
        group.unit_length.push_back(static_cast<float>(unit_length / target_.step_m));
        return ++r.count < kMaxRaySamples;
      });
      group.rays.push_back(r);
    }
  });
  rays_.clear();
  n_samples_ = 0;
  for (const RayGroup& group : groups_) {
    for (RayState r : group.rays) {
      r.begin += n_samples_;
      rays_.push_back(r);
    }
    n_samples_ += static_cast<int64_t>(group.x.size());
  }
  stride_ = kernel::StrideFor(n_samples_);
  for (auto* v : {&x_, &y_, &z_, &t_, &unit_length_}) Grow(*v, stride_);
  int64_t at = 0;
  for (const RayGroup& group : groups_) {
    const auto offset = static_cast<ptrdiff_t>(at);
    std::copy(group.x.begin(), group.x.end(), x_.begin() + offset);
    std::copy(group.y.begin(), group.y.end(), y_.begin() + offset);
    std::copy(group.z.begin(), group.z.end(), z_.begin() + offset);
    std::copy(group.t.begin(), group.t.end(), t_.begin() + offset);
    std::copy(group.unit_length.begin(), group.unit_length.end(), unit_length_.begin() + offset);
    at += static_cast<int64_t>(group.x.size());
  }
}

void FieldTrainer::EvaluateDensity() {
  const auto rows = static_cast<size_t>(field_.FeatureRows());
  Grow(features_, rows * stride_);
  Grow(step_depth_, stride_);
  Grow(geometry_, static_cast<size_t>(field::kGeometryRows) * stride_);
  field_.Encode(state_.grid, x_.data(), y_.data(), z_.data(), n_samples_, features_.data(), stride_, threads_);
  for (size_t row = 0; row < rows; ++row) {
    std::fill(features_.begin() + static_cast<ptrdiff_t>(row * stride_ + static_cast<size_t>(n_samples_)),
              features_.begin() + static_cast<ptrdiff_t>((row + 1) * stride_), 0.0F);
  }
  const int64_t padded = kernel::Padded(n_samples_);
  threads_.ParallelFor((padded + field::kChunk - 1) / field::kChunk, [&](int64_t task, int thread) {
    const int64_t begin = task * field::kChunk;
    const int64_t n = std::min<int64_t>(field::kChunk, padded - begin);
    field_.Density(weights_, features_.data() + begin, stride_, n, scratch_[static_cast<size_t>(thread)], geometry_.data() + begin, stride_);
    for (int64_t s = begin; s < begin + n; ++s) step_depth_[static_cast<size_t>(s)] = StepDepth(geometry_[static_cast<size_t>(s)]);
  });
}

// Keeps the samples that light still reaches; what lies behind an opaque surface gets neither colour nor gradient.
void FieldTrainer::SelectLive() {
  n_live_ = 0;
  field::OccupancyGrid& grid = target_.occupancy;
  const float limit = -std::log(kLiveTransmittance);
  for (RayState& r : rays_) {
    float depth = 0.0F;
    r.live_begin = n_live_;
    for (int64_t i = 0; i < r.count; ++i) {
      const auto s = static_cast<size_t>(r.begin + i);
      const bool live = depth < limit;
      if (live) {
        depth += step_depth_[s] * unit_length_[s];
        ++n_live_;
      }
      // A cell that only ever lies behind surfaces is let go like an empty one.
      grid.Observe(grid.IndexAt(x_[s], y_[s], z_[s]), live ? step_depth_[s] : 0.0F);
    }
    r.live_count = n_live_ - r.live_begin;
  }
  live_stride_ = kernel::StrideFor(n_live_);
  for (auto* v : {&live_x_, &live_y_, &live_z_, &live_t_, &live_tau_, &live_weight_, &tau_gradient_}) Grow(*v, live_stride_);
  for (auto* v : {&live_direction_, &live_rgb_}) Grow(*v, 3 * live_stride_);
  for (auto* v : {&live_color_, &color_gradient_}) Grow(*v, static_cast<size_t>(field::kColorRows) * live_stride_);
  const auto rows = static_cast<size_t>(field_.FeatureRows());
  for (auto* v : {&live_features_, &feature_gradient_}) Grow(*v, rows * live_stride_);
  Grow(live_geometry_, static_cast<size_t>(field::kGeometryRows) * live_stride_);

  constexpr size_t kRaysPerTask = 128;
  threads_.ParallelFor(static_cast<int64_t>((rays_.size() + kRaysPerTask - 1) / kRaysPerTask), [&](int64_t task, int) {
    const size_t first = static_cast<size_t>(task) * kRaysPerTask;
    for (size_t k = first; k < std::min(first + kRaysPerTask, rays_.size()); ++k) {
      const RayState& r = rays_[k];
      const auto from = static_cast<size_t>(r.begin);
      const auto to = static_cast<size_t>(r.live_begin);
      const auto n = static_cast<size_t>(r.live_count);
      const Eigen::Vector3f direction = r.ray.direction_enu.cast<float>();
      for (size_t i = 0; i < n; ++i) {
        live_x_[to + i] = x_[from + i];
        live_y_[to + i] = y_[from + i];
        live_z_[to + i] = z_[from + i];
        live_t_[to + i] = t_[from + i];
        live_tau_[to + i] = step_depth_[from + i] * unit_length_[from + i];
        for (size_t axis = 0; axis < 3; ++axis) live_direction_[axis * live_stride_ + to + i] = direction[static_cast<int>(axis)];
      }
      for (size_t row = 0; row < rows; ++row) {
        std::copy_n(features_.begin() + static_cast<ptrdiff_t>(row * stride_ + from), n,
                    live_features_.begin() + static_cast<ptrdiff_t>(row * live_stride_ + to));
      }
      for (size_t row = 0; row < field::kGeometryRows; ++row) {
        std::copy_n(geometry_.begin() + static_cast<ptrdiff_t>(row * stride_ + from), n,
                    live_geometry_.begin() + static_cast<ptrdiff_t>(row * live_stride_ + to));
      }
    }
  });
  // Padding: zero features, zero gradients.
  for (auto n = static_cast<size_t>(n_live_); n < live_stride_; ++n) {
    for (size_t row = 0; row < rows; ++row) live_features_[row * live_stride_ + n] = 0.0F;
    for (size_t row = 0; row < field::kGeometryRows; ++row) live_geometry_[row * live_stride_ + n] = 0.0F;
    for (size_t row = 0; row < field::kColorRows; ++row) color_gradient_[row * live_stride_ + n] = 0.0F;
    for (size_t axis = 0; axis < 3; ++axis) live_direction_[axis * live_stride_ + n] = 0.0F;
    tau_gradient_[n] = 0.0F;
  }
}

void FieldTrainer::EvaluateColor() {
  const int64_t padded = kernel::Padded(n_live_);
  const auto range = static_cast<float>(target_.config.color_range);
  threads_.ParallelFor((padded + field::kChunk - 1) / field::kChunk, [&](int64_t task, int thread) {
    const int64_t begin = task * field::kChunk;
    const int64_t n = std::min<int64_t>(field::kChunk, padded - begin);
    field_.Color(weights_, live_geometry_.data() + begin, live_stride_, live_direction_.data() + begin, live_stride_, n,
                 scratch_[static_cast<size_t>(thread)], live_color_.data() + begin, live_stride_);
    for (size_t c = 0; c < 3; ++c) {
      for (auto s = static_cast<size_t>(begin); s < static_cast<size_t>(begin + n); ++s) {
        live_rgb_[c * live_stride_ + s] = range / (1.0F + std::exp(-live_color_[c * live_stride_ + s]));
      }
    }
  });
}

// What the frozen context shows in front of the box's ground plan and, where light passes through, behind it.
void FieldTrainer::FrozenContext() {
  if (context_ == nullptr) return;
  std::vector<render::Ray> pieces;
  std::vector<std::pair<size_t, bool>> owner;  // ray, is it the piece behind
  for (size_t k = 0; k < rays_.size(); ++k) {
    const RayState& r = rays_[k];
    if (r.ray.empty) continue;
    const render::Stretch all = render::FieldStretch(context_->map, r.ray.origin_enu, r.ray.direction_enu);
    if (all.Empty()) continue;
    const render::Stretch plan = render::PlanStretch(target_.map, r.ray.origin_enu, r.ray.direction_enu);
    if (plan.t_near > all.t_near + context_->step_m) {
      pieces.push_back({r.ray.origin_enu, r.ray.direction_enu, all.t_near, plan.t_near, 0.0F});
      owner.emplace_back(k, false);
    }
    float depth = 0.0F;
    for (int64_t i = 0; i < r.live_count; ++i) depth += live_tau_[static_cast<size_t>(r.live_begin + i)];
    if (depth < 4.0F && all.t_far > plan.t_far) {
      pieces.push_back({r.ray.origin_enu, r.ray.direction_enu, plan.t_far, all.t_far, 0.0F});
      owner.emplace_back(k, true);
    }
  }
  std::vector<render::RayColor> colors(pieces.size());
  render::FieldSet set;
  set.context = context_;
  render::RenderRays(set, pieces, colors, render::EngineOptions{}, threads_);
  for (size_t i = 0; i < pieces.size(); ++i) {
    RayState& r = rays_[owner[i].first];
    for (size_t c = 0; c < 3; ++c) {
      if (owner[i].second) {
        // Whatever the context leaves open shows the random background.
        r.behind_rgb[c] = colors[i].rgb_srgb[c];
        r.background[c] *= 1.0F - colors[i].opacity;
      } else {
        r.front_rgb[c] = colors[i].rgb_srgb[c];
      }
    }
    if (!owner[i].second) r.front_transmittance = 1.0F - colors[i].opacity;
  }
}

StepResult FieldTrainer::ComposeAndLoss() {
  StepResult result;
  result.n_rays = static_cast<int>(rays_.size());
  result.n_samples = n_samples_;
  result.n_live = n_live_;
  const float ray_share = 1.0F / static_cast<float>(std::max<size_t>(1, rays_.size()));
  const auto range = static_cast<float>(target_.config.color_range);
  // The distortion loss sees distances in units of the box height, so its weight means the same for every scene.
  const auto distance_unit = static_cast<float>(1.0 / std::max(1.0, target_.map.max_enu().z() - target_.map.min_enu().z()));
  constexpr size_t kRaysPerTask = 128;
  const size_t n_tasks = (rays_.size() + kRaysPerTask - 1) / kRaysPerTask;
  std::vector<double> loss(n_tasks, 0.0), squared(n_tasks, 0.0);
  std::vector<int64_t> color_rays(n_tasks, 0);
  threads_.ParallelFor(static_cast<int64_t>(n_tasks), [&](int64_t task, int) {
    const size_t first = static_cast<size_t>(task) * kRaysPerTask;
    std::vector<float> weight_gradient, mid, width;
    for (size_t k = first; k < std::min(first + kRaysPerTask, rays_.size()); ++k) {
      RayState& r = rays_[k];
      const auto begin = static_cast<size_t>(r.live_begin);
      const auto n = static_cast<size_t>(r.live_count);
      float rgb[3];
      float* weights = live_weight_.data() + begin;
      r.transmittance = render::CompositeForward(static_cast<int>(n), live_tau_.data() + begin, live_rgb_.data() + begin, live_stride_, weights, rgb);
      float rgb_gradient[3] = {0, 0, 0};
      float transmittance_gradient = 0.0F;
      double ray_loss = 0.0;
      weight_gradient.assign(n, 0.0F);
      if (r.ray.empty) {
        const float opacity = 1.0F - r.transmittance;
        ray_loss = static_cast<double>(opacity * opacity);
        transmittance_gradient = -2.0F * opacity * ray_share;
      } else {
        for (size_t c = 0; c < 3; ++c) {
          const float behind = r.behind_rgb[c] + r.background[c];
          const float shown = r.front_rgb[c] + r.front_transmittance * (rgb[c] + r.transmittance * behind);
          const auto [value, slope] = brightness::Expose(shown, r.ray.gain);
          const float target = r.ray.target_srgb[c];
          const float residual = value - target;
          squared[static_cast<size_t>(task)] += static_cast<double>(residual) * static_cast<double>(residual);
          // A saturated pixel says only "at least this bright", a black one "at most".
          const bool satisfied = (target >= 254.5F / 255.0F && residual > 0.0F) || (target <= 0.5F / 255.0F && residual < 0.0F);
          if (satisfied) continue;
          ray_loss += static_cast<double>(residual) * static_cast<double>(residual);
          const float gradient = 2.0F * residual * slope * r.front_transmittance * ray_share;
          rgb_gradient[c] = gradient;
          transmittance_gradient += gradient * behind;
        }
        ++color_rays[static_cast<size_t>(task)];
        if (distortion_ > 0.0 && n > 0) {
          mid.resize(n);
          width.resize(n);
          for (size_t i = 0; i < n; ++i) {
            mid[i] = (live_t_[begin + i] - live_t_[begin]) * distance_unit;
            width[i] = static_cast<float>(target_.step_m) * distance_unit;
          }
          ray_loss += static_cast<double>(render::DistortionLoss(static_cast<int>(n), weights, mid.data(), width.data(),
                                                                 static_cast<float>(distortion_) * ray_share, weight_gradient.data())) /
                      static_cast<double>(ray_share);
        }
      }
      loss[static_cast<size_t>(task)] += ray_loss;
      render::CompositeBackward(static_cast<int>(n), live_rgb_.data() + begin, live_stride_, weights, r.transmittance, rgb_gradient,
                                transmittance_gradient, weight_gradient.data(), tau_gradient_.data() + begin, color_gradient_.data() + begin,
                                live_stride_);
      for (size_t i = begin; i < begin + n; ++i) {
        tau_gradient_[i] *= live_tau_[i];  // d tau / d log density = tau
        for (size_t c = 0; c < 3; ++c) {
          const float share = live_rgb_[c * live_stride_ + i] / range;
          color_gradient_[c * live_stride_ + i] *= range * share * (1.0F - share);
        }
        color_gradient_[3 * live_stride_ + i] = 0.0F;
      }
    }
  });
  int64_t n_color = 0;
  for (size_t i = 0; i < n_tasks; ++i) {
    result.loss += loss[i];
    result.squared_error += squared[i];
    n_color += color_rays[i];
  }
  result.loss *= static_cast<double>(ray_share);
  result.squared_error /= 3.0 * static_cast<double>(std::max<int64_t>(1, n_color));
  return result;
}

bool FieldTrainer::BackwardAndUpdate(double learning_rate) {
  const int64_t padded = kernel::Padded(n_live_);
  const int64_t chunks = (padded + field::kChunk - 1) / field::kChunk;
  const auto network_size = static_cast<size_t>(field_.NetworkParameters());
  slot_gradients_.assign(network_size * kGradientSlots, 0.0F);
  const auto rows = static_cast<size_t>(field_.FeatureRows());
  std::vector<uint8_t> slot_finite(kGradientSlots, 1);
  threads_.ParallelFor(kGradientSlots, [&](int64_t slot, int thread) {
    for (int64_t chunk = slot; chunk < chunks; chunk += kGradientSlots) {
      const int64_t begin = chunk * field::kChunk;
      field_.Backward(weights_, live_features_.data() + begin, live_stride_, live_direction_.data() + begin, live_stride_,
                      std::min<int64_t>(field::kChunk, padded - begin), color_gradient_.data() + begin, live_stride_, tau_gradient_.data() + begin,
                      scratch_[static_cast<size_t>(thread)], feature_gradient_.data() + begin, live_stride_,
                      slot_gradients_.data() + static_cast<size_t>(slot) * network_size);
      for (size_t row = 0; row < rows; ++row) {
        const int64_t n = std::min<int64_t>(field::kChunk, padded - begin);
        if (!AllFinite(feature_gradient_.data() + row * live_stride_ + begin, n)) slot_finite[static_cast<size_t>(slot)] = 0;
      }
    }
  });
  for (size_t slot = 0; slot < kGradientSlots; ++slot) {
    for (size_t i = 0; i < network_size; ++i) state_.network_gradient[i] += slot_gradients_[slot * network_size + i];
  }
  const bool finite = AllFinite(state_.network_gradient.data(), static_cast<int64_t>(network_size)) &&
                      std::find(slot_finite.begin(), slot_finite.end(), 0) == slot_finite.end();
  if (!finite) {
    field::DropGradients(state_);
    return false;
  }
  field::AccumulateGrid(field_, live_x_.data(), live_y_.data(), live_z_.data(), n_live_, feature_gradient_.data(), live_stride_, state_, threads_);
  field::ApplyAdam(field_, learning_rate, options_.network_l2, state_, threads_);
  return true;
}

StepResult FieldTrainer::Step(double progress, double learning_rate_scale) {
  weights_ = field_.Prepare(state_.networks);
  distortion_ = options_.distortion * std::clamp((progress - kDistortionFrom) / (kDistortionTo - kDistortionFrom), 0.0, 1.0);
  DrawRays();
  EvaluateDensity();
  SelectLive();
  EvaluateColor();
  FrozenContext();
  StepResult result = ComposeAndLoss();
  const double warm_up = std::min(1.0, static_cast<double>(state_.step + 1) / 50.0);
  const double decay = std::pow(options_.final_learning_rate_share, std::clamp((progress - 0.2) / 0.8, 0.0, 1.0));
  result.finite = std::isfinite(result.loss);
  if (!result.finite) {
    ++state_.step;  // the same rays would fail the same way
  } else if (!BackwardAndUpdate(options_.learning_rate * learning_rate_scale * warm_up * decay)) {
    result.finite = false;
    ++state_.step;
  }
  // The next step's rays fill the batch at this step's samples per ray, changing slowly.
  if (result.n_rays > 0 && n_samples_ > 0) {
    const double wanted = static_cast<double>(options_.batch_samples) * result.n_rays / static_cast<double>(n_samples_);
    const double next = std::clamp(wanted, 0.8 * rays_per_step_, 1.25 * rays_per_step_);
    rays_per_step_ = std::clamp(static_cast<int>(next), kGroupRays, options_.batch_samples / 2);
  }
  return result;
}

void FieldTrainer::StepDepths(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z, std::vector<float>* depth) {
  const auto n = static_cast<int64_t>(x.size());
  depth->assign(x.size(), 0.0F);
  constexpr int64_t kStretch = 16 * field::kChunk;
  const auto rows = static_cast<size_t>(field_.FeatureRows());
  threads_.ParallelFor((n + kStretch - 1) / kStretch, [&](int64_t task, int thread) {
    const int64_t begin = task * kStretch;
    const int64_t count = std::min(kStretch, n - begin);
    const size_t stride = kernel::StrideFor(count);
    std::vector<float> features(rows * stride, 0.0F), geometry(static_cast<size_t>(field::kGeometryRows) * field::kChunkStride);
    field_.EncodeSerial(state_.grid, x.data() + begin, y.data() + begin, z.data() + begin, count, features.data(), stride);
    for (int64_t s = 0; s < count; s += field::kChunk) {
      const int64_t size = std::min<int64_t>(field::kChunk, kernel::Padded(count) - s);
      field_.Density(weights_, features.data() + s, stride, size, scratch_[static_cast<size_t>(thread)], geometry.data(), field::kChunkStride);
      for (int64_t i = 0; i < std::min(size, count - s); ++i) {
        (*depth)[static_cast<size_t>(begin + s + i)] = StepDepth(geometry[static_cast<size_t>(i)]);
      }
    }
  });
}

void FieldTrainer::UpdateOccupancy(bool grow) {
  weights_ = field_.Prepare(state_.networks);
  field::OccupancyGrid& grid = target_.occupancy;
  const int64_t cells = grid.CellCount();
  base::Random random(Mix(seed_, static_cast<uint64_t>(state_.step), 0), kCellStream);
  std::vector<int64_t> chosen;
  std::vector<float> x, y, z, depth;
  // Training samples tell about occupied cells; a few random ones look whether matter has come up in the others.
  const int64_t budget = options_.batch_samples / 2;
  for (int64_t i = 0; i < budget; ++i) {
    const int64_t index = random.Below(static_cast<uint32_t>(cells));
    if (grid.depth[static_cast<size_t>(index)] < 0.0F || grid.occupied[static_cast<size_t>(index)] != 0) continue;
    const int64_t plane = static_cast<int64_t>(grid.size[0]) * grid.size[1];
    chosen.push_back(index);
    x.push_back((static_cast<float>(index % grid.size[0]) + random.Uniform()) * grid.cell);
    y.push_back((static_cast<float>((index % plane) / grid.size[0]) + random.Uniform()) * grid.cell);
    z.push_back((static_cast<float>(index / plane) + random.Uniform()) * grid.cell);
  }
  StepDepths(x, y, z, &depth);
  for (size_t i = 0; i < chosen.size(); ++i) grid.Observe(chosen[i], depth[i]);
  if (grow) grid.WakeNeighbours(kSolidDepth, kWakeDepth);
  grid.Refresh(kOccupancyLimit);
}

}  // namespace skyquilt::worker
