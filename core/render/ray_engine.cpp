#include "core/render/ray_engine.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/image/srgb.h"
#include "core/render/density_normal.h"
#include "core/render/footprint.h"
#include "core/render/sample_marcher.h"
#include "core/render/scratch_pool.h"

namespace skyquilt::render {
namespace {

// Rays of one task: enough samples that a level's table stays in cache, but in small pictures enough tasks that threads end together.
constexpr int64_t kMaxGroupRays = 1024, kMinGroupRays = 128, kTasks = 32;
// Samples of a ray that are evaluated together. Opaque rays take no part in later rounds, which saves the samples behind surfaces.
constexpr size_t kRoundSamples = 8;
constexpr float kMaxLogTau = 30.0F;               // exp of it times any length is finite
constexpr double kPassed[3] = {0.85, 0.5, 0.15};  // transmittances at the front, in the middle and at the back of a surface

// Samples of a ray: first, next to be evaluated, one past the last.
struct Progress {
  size_t begin = 0, next = 0, end = 0;
};

// Samples of one field in one round, and those of all rounds that need colour.
struct FieldBatch {
  size_t field = 0;            // blocks in order, then the context
  std::vector<float> x, y, z;  // planes of the positions (kernel::Positions)
  std::vector<float> sharpness;
  size_t count = 0;
  std::vector<float> features, geometry;  // rows of `stride`
  std::vector<float> step_depth;          // optical depth of one marching step
  size_t stride = 0;
  std::vector<float> visible_geometry;  // kGeometryRows values per visible sample
  std::vector<float> color_in, color;
  std::vector<float> density_gradient;  // of the visible samples, 3 rows of visible_stride, unit frame
  std::vector<float> predicted_normal;  // of the visible samples of a field with a head: rows of visible_stride, ENU, of any length
  size_t visible = 0, visible_stride = 0;
};

}  // namespace

class RayRenderer::Group {
 public:
  Group(const FieldSet& fields, const EngineOptions& options) : options_(options), marcher_(fields, options.step_scale), all_(fields.blocks) {
    if (fields.context != nullptr) all_.push_back(fields.context);
    batch_of_.assign(all_.size(), kNoBatch);
    scratch_of_.resize(all_.size());
    for (size_t k = 0; k < all_.size(); ++k) {
      if (all_[k]->field) scratch_of_[k] = scratch_.For(*all_[k]->field);
    }
  }

  int64_t Continue(std::span<const Ray> rays, std::span<const Window> windows, std::span<RayState> states) {
    samples_.clear();
    progress_.assign(rays.size(), {});
    for (size_t b = 0; b < in_use_; ++b) batch_of_[batches_[b].field] = kNoBatch;
    in_use_ = 0;
    alive_.clear();
    for (size_t r = 0; r < rays.size(); ++r) {
      progress_[r].begin = progress_[r].next = samples_.size();
      if (!states[r].ended) marcher_.March(rays[r], windows.empty() ? Window{} : windows[r], &samples_);
      progress_[r].end = samples_.size();
      for (size_t s = progress_[r].begin; s < progress_[r].end; ++s) UseField(static_cast<size_t>(samples_[s].field));
      if (progress_[r].end > progress_[r].begin) alive_.push_back(r);
    }
    int64_t evaluated = 0;
    while (!alive_.empty()) {
      evaluated += EvaluateRound(rays);
      size_t kept = 0;
      for (const size_t r : alive_) {
        if (ComposeRound(progress_[r], states[r])) alive_[kept++] = r;
      }
      alive_.resize(kept);
    }
    for (size_t b = 0; b < in_use_; ++b) EvaluateColor(b, rays);
    for (size_t r = 0; r < rays.size(); ++r) ComposeColor(progress_[r], states[r]);
    if (options_.normals) AddNormals(rays, states);
    return evaluated;
  }

 private:
  const TrainedField& FieldOf(const FieldBatch& batch) const { return *all_[batch.field]; }
  const field::Activations& ScratchOf(const FieldBatch& batch) const { return scratch_[scratch_of_[batch.field]]; }
  FieldBatch& BatchOf(const Sample& sample) { return batches_[batch_of_[static_cast<size_t>(sample.field)]]; }
  const FieldBatch& BatchOf(const Sample& sample) const { return batches_[batch_of_[static_cast<size_t>(sample.field)]]; }

  // Gives a field a batch if it has none.
  void UseField(size_t k) {
    if (batch_of_[k] != kNoBatch) return;
    if (in_use_ == batches_.size()) batches_.emplace_back();
    FieldBatch& batch = batches_[in_use_];
    batch.field = k;
    batch.count = batch.visible = 0;
    batch.visible_geometry.clear();
    batch_of_[k] = in_use_++;
  }

  // Evaluates the densities of the next samples of every ray that is not opaque yet.
  int64_t EvaluateRound(std::span<const Ray> rays) {
    for (size_t b = 0; b < in_use_; ++b) batches_[b].count = 0;
    int64_t evaluated = 0;
    for (const size_t r : alive_) {
      const Progress& p = progress_[r];
      const size_t end = std::min(p.end, p.next + kRoundSamples);
      for (size_t s = p.next; s < end; ++s) samples_[s].local = static_cast<int>(BatchOf(samples_[s]).count++);
      evaluated += static_cast<int64_t>(end - p.next);
    }
    for (size_t b = 0; b < in_use_; ++b) MakeRoom(b);
    for (const size_t r : alive_) {
      const Progress& p = progress_[r];
      for (size_t s = p.next; s < std::min(p.end, p.next + kRoundSamples); ++s) PlaceSample(rays[r], samples_[s]);
    }
    for (size_t b = 0; b < in_use_; ++b) EvaluateDensity(b);
    return evaluated;
  }

  // For the positions of batch.count samples.
  void MakeRoom(size_t b) {
    FieldBatch& batch = batches_[b];
    const size_t needed = batch.count * Points(FieldOf(batch));
    for (auto* v : {&batch.x, &batch.y, &batch.z}) v->resize(std::max(v->size(), needed));
    batch.sharpness.resize(std::max(batch.sharpness.size(), batch.count));
  }

  kernel::Positions PlacesOf(const FieldBatch& batch) const {
    const TrainedField& f = FieldOf(batch);
    const float* const sharpness = f.config.Cones() ? batch.sharpness.data() : nullptr;
    return {batch.x.data(), batch.y.data(), batch.z.data(), sharpness, static_cast<int>(Points(f)), batch.count};
  }

  static size_t Points(const TrainedField& f) { return static_cast<size_t>(std::max(1, f.config.multisample)); }

  // Writes the positions and the footprint of a sample to its field's batch.
  void PlaceSample(const Ray& ray, const Sample& sample) {
    const TrainedField& f = *all_[static_cast<size_t>(sample.field)];
    FieldBatch& batch = BatchOf(sample);
    const auto local = static_cast<size_t>(sample.local);
    batch.x[local] = sample.x;
    batch.y[local] = sample.y;
    batch.z[local] = sample.z;
    if (!f.config.Cones()) return;
    const double width_m = TrainedWidth(f, ray.Footprint(sample.t));
    batch.sharpness[local] = SharpnessOf(width_m, f.map.VolumeScale(ray.origin_enu + sample.t * ray.direction_enu), f.config.multisample);
    if (f.config.multisample == 1) return;
    const Cone cone(f.map, ray, f.config.multisample);
    cone.Positions(sample.t, static_cast<double>(sample.length), width_m, Turn::Alternating(sample.odd ? 1 : 0), &batch.x[local], &batch.y[local],
                   &batch.z[local], batch.count);
  }

  void EvaluateDensity(size_t b) {
    FieldBatch& batch = batches_[b];
    const auto n = static_cast<int64_t>(batch.count);
    if (n == 0) return;
    const TrainedField& trained = FieldOf(batch);
    const field::HashField& f = *trained.field;
    const field::Activations& scratch = ScratchOf(batch);
    const int64_t padded = kernel::Padded(n);
    batch.stride = kernel::StrideFor(n);
    const auto rows = static_cast<size_t>(f.FeatureRows());
    batch.features.resize(std::max(batch.features.size(), rows * batch.stride));
    batch.geometry.resize(std::max(batch.geometry.size(), static_cast<size_t>(field::kGeometryRows) * batch.stride));
    f.EncodeSerial(trained.parameters.grid, PlacesOf(batch), n, batch.features.data(), batch.stride);
    for (size_t row = 0; row < rows; ++row) std::fill_n(batch.features.data() + row * batch.stride + n, padded - n, 0.0F);
    for (int64_t begin = 0; begin < padded; begin += field::kChunk) {
      f.Density(trained.weights, batch.features.data() + begin, batch.stride, std::min<int64_t>(field::kChunk, padded - begin),
                scratch.density_hidden, scratch.stride, batch.geometry.data() + begin, batch.stride);
    }
    batch.step_depth.resize(std::max(batch.step_depth.size(), batch.stride));
    f.StepTau(batch.geometry.data(), padded, kMaxLogTau, batch.step_depth.data());
  }

  // Composites the samples of the round in order of distance; false when the ray is finished.
  bool ComposeRound(Progress& p, RayState& state) {
    float* const passed_at[3] = {&state.depth_front, &state.depth_median, &state.depth_back};
    const size_t end = std::min(p.end, p.next + kRoundSamples);
    for (; p.next < end; ++p.next) {
      Sample& sample = samples_[p.next];
      FieldBatch& batch = BatchOf(sample);
      const auto local = static_cast<size_t>(sample.local);
      const double tau = static_cast<double>(batch.step_depth[local] * sample.unit_length * sample.blend);
      const double after = state.transmittance * std::exp(-tau);
      const double weight = state.transmittance - after;
      state.depth_moment += weight * sample.t;
      for (size_t i = 0; i < 3; ++i) {
        if (!(state.transmittance > kPassed[i] && after <= kPassed[i])) continue;
        // Position inside the interval where the transmittance reaches the threshold.
        const double share = tau > 0.0 ? std::clamp(std::log(state.transmittance / kPassed[i]) / tau, 0.0, 1.0) : 0.5;
        *passed_at[i] = static_cast<float>(sample.t + static_cast<double>(sample.length) * (share - 0.5));
      }
      sample.weight = static_cast<float>(weight);
      if (sample.weight > options_.colour_threshold) {
        sample.local = static_cast<int>(batch.visible++);
        for (size_t row = 0; row < field::kGeometryRows; ++row) batch.visible_geometry.push_back(batch.geometry[row * batch.stride + local]);
      }
      state.transmittance = after;
      if (after < options_.end_transmittance) {
        p.end = ++p.next;
        state.ended = true;
        break;
      }
    }
    return p.next < p.end;
  }

  void EvaluateColor(size_t b, std::span<const Ray> rays) {
    FieldBatch& batch = batches_[b];
    const auto n = static_cast<int64_t>(batch.visible);
    if (n == 0) return;
    const TrainedField& trained = FieldOf(batch);
    const field::HashField& f = *trained.field;
    const field::Activations& scratch = ScratchOf(batch);
    const int64_t padded = kernel::Padded(n);
    batch.visible_stride = kernel::StrideFor(n);
    const auto inputs = static_cast<size_t>(f.ColorInputRows());
    batch.color_in.resize(std::max(batch.color_in.size(), inputs * batch.visible_stride));
    batch.color.resize(std::max(batch.color.size(), static_cast<size_t>(field::kColorRows) * batch.visible_stride));
    FillColorInput(b, rays);
    for (size_t row = 0; row < inputs; ++row) std::fill_n(batch.color_in.data() + row * batch.visible_stride + n, padded - n, 0.0F);
    for (int64_t begin = 0; begin < padded; begin += field::kChunk) {
      const int64_t count = std::min<int64_t>(field::kChunk, padded - begin);
      f.Color(trained.weights, batch.color_in.data() + begin, batch.visible_stride, count, scratch.color_hidden, scratch.stride,
              batch.color.data() + begin, batch.visible_stride);
    }
    for (size_t c = 0; c < 3; ++c) {
      float* row = batch.color.data() + c * batch.visible_stride;
      kernel::Sigmoid(row, padded, static_cast<float>(trained.config.color_range), row);
    }
  }

  // Orders visible samples by ray, so that the direction of a ray is encoded once.
  void FillColorInput(size_t b, std::span<const Ray> rays) {
    FieldBatch& batch = batches_[b];
    float* sh = batch.color_in.data() + static_cast<size_t>(field::kGeometryRows) * batch.visible_stride;
    size_t next = 0;
    for (size_t r = 0; r < rays.size(); ++r) {
      const size_t first = next;
      for (size_t s = progress_[r].begin; s < progress_[r].next; ++s) {
        if (samples_[s].field != static_cast<int>(batch.field) || !(samples_[s].weight > options_.colour_threshold)) continue;
        const float* geometry = batch.visible_geometry.data() + static_cast<size_t>(samples_[s].local) * field::kGeometryRows;
        for (size_t row = 0; row < field::kGeometryRows; ++row) batch.color_in[row * batch.visible_stride + next] = geometry[row];
        samples_[s].local = static_cast<int>(next++);
      }
      if (next == first) continue;
      const Eigen::Vector3f d = rays[r].direction_enu.cast<float>();
      FieldOf(batch).field->EncodeDirection(d.data(), static_cast<int64_t>(next - first), sh + first, batch.visible_stride);
    }
  }

  void ComposeColor(const Progress& p, RayState& state) {
    for (size_t s = p.begin; s < p.next; ++s) {
      const Sample& sample = samples_[s];
      if (!(sample.weight > options_.colour_threshold)) continue;
      const FieldBatch& batch = BatchOf(sample);
      for (size_t c = 0; c < 3; ++c) state.rgb_srgb[c] += sample.weight * batch.color[c * batch.visible_stride + static_cast<size_t>(sample.local)];
    }
    if (options_.concealing != Concealing::kNone) ComposeConcealed(p, state);
  }

  // A rendered ray has no neighbours: all seven taps of the convolution get its own luminance.
  void ComposeConcealed(const Progress& p, RayState& state) const {
    for (size_t s = p.begin; s < p.next; ++s) {
      const Sample& sample = samples_[s];
      if (!(sample.weight > options_.colour_threshold)) continue;
      const FieldBatch& batch = BatchOf(sample);
      const float* color = batch.color.data() + static_cast<size_t>(sample.local);
      const auto& taps = all_[static_cast<size_t>(sample.field)]->weights.luminance;
      const float sum = std::accumulate(taps.begin(), taps.end() - 1, 0.0F);
      const float omega = 1.0F / (1.0F + std::exp(-(sum * color[3 * batch.visible_stride] + taps.back())));
      const float share = options_.concealing == Concealing::kProduct ? state.light_passed : omega;
      state.light_passed *= omega;
      for (size_t c = 0; c < 3; ++c) {
        state.concealed_light[c] += sample.weight * share * image::LinearFromSrgb(color[c * batch.visible_stride]);
      }
    }
  }

  bool Visible(const Sample& sample) const { return sample.weight > options_.colour_threshold; }

  // Normals of the samples that have a colour, which are placed again in the order of their colours.
  void AddNormals(std::span<const Ray> rays, std::span<RayState> states) {
    for (size_t b = 0; b < in_use_; ++b) {
      batches_[b].count = batches_[b].visible;
      MakeRoom(b);
    }
    for (size_t r = 0; r < rays.size(); ++r) {
      for (size_t s = progress_[r].begin; s < progress_[r].next; ++s) {
        if (Visible(samples_[s])) PlaceSample(rays[r], samples_[s]);
      }
    }
    for (size_t b = 0; b < in_use_; ++b) {
      EvaluateDensityGradient(b);
      PredictNormals(b);
    }
    for (size_t r = 0; r < rays.size(); ++r) ComposeNormals(rays[r], progress_[r], states[r]);
  }

  void EvaluateDensityGradient(size_t b) {
    FieldBatch& batch = batches_[b];
    const auto n = static_cast<int64_t>(batch.visible);
    if (n == 0) return;
    const TrainedField& f = FieldOf(batch);
    batch.density_gradient.resize(std::max(batch.density_gradient.size(), 3 * batch.visible_stride));
    for (int64_t begin = 0; begin < n; begin += field::kChunk) {
      const int64_t count = std::min<int64_t>(field::kChunk, n - begin);
      f.field->DensityGradient(f.weights, f.parameters.grid, PlacesOf(batch).From(begin), count, slope_);
      for (size_t axis = 0; axis < 3; ++axis) {
        std::copy_n(slope_.gradient + axis * slope_.stride, count, batch.density_gradient.data() + axis * batch.visible_stride + begin);
      }
    }
  }

  void PredictNormals(size_t b) {
    FieldBatch& batch = batches_[b];
    const TrainedField& f = FieldOf(batch);
    if (!f.config.normal_head || batch.visible == 0) return;
    batch.predicted_normal.resize(std::max(batch.predicted_normal.size(), field::kNormalRows * batch.visible_stride));
    f.field->PredictNormals(f.weights, batch.color_in.data(), batch.visible_stride, kernel::Padded(static_cast<int64_t>(batch.visible)),
                            batch.predicted_normal.data(), batch.visible_stride);
  }

  // A sample's column of three rows.
  static Eigen::Vector3d Column(const std::vector<float>& rows, const FieldBatch& batch, const Sample& sample) {
    const float* const first = rows.data() + sample.local;
    return {static_cast<double>(first[0]), static_cast<double>(first[batch.visible_stride]), static_cast<double>(first[2 * batch.visible_stride])};
  }

  static void Add(float weight, const Eigen::Vector3d& normal, float (&sum)[3]) {
    for (size_t axis = 0; axis < 3; ++axis) sum[axis] += weight * static_cast<float>(normal[static_cast<Eigen::Index>(axis)]);
  }

  void ComposeNormals(const Ray& ray, const Progress& p, RayState& state) const {
    for (size_t s = p.begin; s < p.next; ++s) {
      const Sample& sample = samples_[s];
      if (!Visible(sample)) continue;
      const FieldBatch& batch = BatchOf(sample);
      const TrainedField& f = *all_[static_cast<size_t>(sample.field)];
      const Eigen::Matrix3d to_unit = f.map.UnitPerEnu(ray.origin_enu + sample.t * ray.direction_enu);
      Add(sample.weight, OutwardNormal<double>(to_unit.transpose() * Column(batch.density_gradient, batch, sample)), state.density_normal);
      if (f.config.normal_head) Add(sample.weight, UnitNormal<double>(Column(batch.predicted_normal, batch, sample)), state.predicted_normal);
    }
  }

  EngineOptions options_;
  SampleMarcher marcher_;
  std::vector<const TrainedField*> all_;
  // Only the fields that the rays of a call meet have a batch, and batches are used again by other fields: a scene of thousands of blocks would need
  // gigabytes otherwise.
  static constexpr size_t kNoBatch = std::numeric_limits<size_t>::max();
  std::vector<FieldBatch> batches_;
  size_t in_use_ = 0;             // first batches that have a field
  std::vector<size_t> batch_of_;  // per field; kNoBatch: the rays do not meet it
  ScratchPool scratch_;
  std::vector<size_t> scratch_of_;  // per field that is loaded
  field::DensitySlope slope_;
  std::vector<Sample> samples_;
  std::vector<Progress> progress_;
  std::vector<size_t> alive_;
};

EngineOptions EngineOptions::DepthsOnly(double opacity) {
  EngineOptions options;
  options.colour_threshold = 2.0F;
  options.end_transmittance = std::min(1.0 - opacity, kPassed[2]);
  return options;
}

RayRenderer::RayRenderer(const FieldSet& fields, const EngineOptions& options) : group_(std::make_unique<Group>(fields, options)) {}

RayRenderer::~RayRenderer() = default;

int64_t RayRenderer::Continue(std::span<const Ray> rays, std::span<const Window> windows, std::span<RayState> states) {
  SKYQUILT_CHECK(states.size() == rays.size() && (windows.empty() || windows.size() == rays.size()), "one state and window per ray");
  return group_->Continue(rays, windows, states);
}

int64_t RayRenderer::Render(std::span<const Ray> rays, std::span<RayColor> out) {
  states_.assign(rays.size(), {});
  const int64_t samples = group_->Continue(rays, {}, states_);
  for (size_t r = 0; r < rays.size(); ++r) out[r] = FinalColor(states_[r]);
  return samples;
}

void RenderRays(const FieldSet& fields, std::span<const Ray> rays, std::span<RayColor> out, const EngineOptions& options, base::ThreadPool& threads,
                int64_t* samples) {
  if (rays.empty()) return;
  std::vector<std::unique_ptr<RayRenderer>> renderers(static_cast<size_t>(threads.size()));
  const auto n = static_cast<int64_t>(rays.size());
  const int64_t per_task = std::clamp((n + kTasks - 1) / kTasks, kMinGroupRays, kMaxGroupRays);
  std::atomic<int64_t> evaluated{0};
  threads.ParallelFor((n + per_task - 1) / per_task, [&](int64_t task, int thread) {
    base::ThrowIfCancelled();
    auto& renderer = renderers[static_cast<size_t>(thread)];
    if (!renderer) renderer = std::make_unique<RayRenderer>(fields, options);
    const auto begin = static_cast<size_t>(task * per_task);
    const size_t count = std::min(static_cast<size_t>(per_task), rays.size() - begin);
    evaluated += renderer->Render(rays.subspan(begin, count), out.subspan(begin, count));
  });
  if (samples != nullptr) *samples += evaluated;
}

}  // namespace skyquilt::render
