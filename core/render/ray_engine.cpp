#include "core/render/ray_engine.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/base/cancel.h"
#include "core/render/blend.h"
#include "core/render/composite.h"
#include "core/render/march.h"

namespace skyquilt::render {
namespace {

constexpr int64_t kGroupRays = 256;   // one task
constexpr int kMaxRaySamples = 2048;  // per ray and field; beyond, the ray ends

struct Sample {
  float t, length, weight;
  int field, local;
};

// Samples of one field within a group.
struct FieldBatch {
  std::vector<float> x, y, z, unit_length;
  std::vector<float> features, geometry;  // rows, stride
  size_t stride = 0;
  std::vector<int> visible;  // local indices that need colour
  std::vector<float> color_in, color;
  size_t visible_stride = 0;
};

}  // namespace

class RayRenderer::Group {
 public:
  Group(const FieldSet& fields, const EngineOptions& options) : options_(options) {
    for (const TrainedField* f : fields.blocks) all_.push_back(f);
    context_index_ = static_cast<int>(all_.size());
    if (fields.context != nullptr) all_.push_back(fields.context);
    batches_.resize(all_.size());
    fields_ = fields;
    scratch_.resize(all_.size());
    for (size_t k = 0; k < all_.size(); ++k) scratch_[k].Reserve(*all_[k]->field, field::kChunk);
  }

  int64_t Render(std::span<const Ray> rays, std::span<RayColor> out) {
    samples_.clear();
    ray_begin_.assign(1, 0);
    for (FieldBatch& batch : batches_) {
      batch.x.clear();
      batch.y.clear();
      batch.z.clear();
      batch.unit_length.clear();
      batch.visible.clear();
    }
    for (const Ray& ray : rays) {
      MarchRay(ray);
      ray_begin_.push_back(samples_.size());
    }
    weight_.assign(samples_.size(), 0.0F);
    for (size_t k = 0; k < all_.size(); ++k) EvaluateDensity(k);
    for (size_t r = 0; r < rays.size(); ++r) ComposeOpacity(r, out[r]);
    for (size_t k = 0; k < all_.size(); ++k) EvaluateColor(k, rays);
    for (size_t r = 0; r < rays.size(); ++r) ComposeColor(r, out[r]);
    return static_cast<int64_t>(samples_.size());
  }

 private:
  void MarchRay(const Ray& ray) {
    candidates_.clear();
    for (int k = 0; k < static_cast<int>(all_.size()); ++k) {
      // Over its plan a block has its say even above its box: there is nothing there.
      if (k != context_index_ && !PlanStretch(all_[static_cast<size_t>(k)]->map, ray.origin_enu, ray.direction_enu).Empty()) candidates_.push_back(k);
    }
    block_weights_.assign(candidates_.size(), 0.0);
    const size_t begin = samples_.size();
    for (size_t c = 0; c < candidates_.size(); ++c) MarchField(ray, candidates_[c], static_cast<int>(c));
    if (context_index_ < static_cast<int>(all_.size())) MarchField(ray, context_index_, -1);
    const auto first = samples_.begin() + static_cast<ptrdiff_t>(begin);
    std::stable_sort(first, samples_.end(), [](const Sample& a, const Sample& b) { return a.t < b.t; });
  }

  static Stretch Clip(const Ray& ray, const TrainedField& f) {
    Stretch stretch = FieldStretch(f.map, ray.origin_enu, ray.direction_enu);
    stretch.t_near = std::max(stretch.t_near, ray.t_near);
    stretch.t_far = std::min(stretch.t_far, ray.t_far);
    return stretch;
  }

  void MarchField(const Ray& ray, int k, int candidate) {
    const TrainedField& f = *all_[static_cast<size_t>(k)];
    FieldBatch& batch = batches_[static_cast<size_t>(k)];
    int count = 0;
    March(f, ray.origin_enu, ray.direction_enu, Clip(ray, f), f.step_m * options_.step_scale, 0.5F, [&](double t, double length, double unit_length) {
      const Eigen::Vector3d p = ray.origin_enu + t * ray.direction_enu;
      const double context_weight = BlendWeights(fields_, candidates_, p.x(), p.y(), block_weights_);
      const double weight = candidate < 0 ? context_weight : block_weights_[static_cast<size_t>(candidate)];
      if (weight > 1e-4) {
        const Eigen::Vector3f unit = f.map.UnitFromEnu(p);
        samples_.push_back({static_cast<float>(t), static_cast<float>(length), static_cast<float>(weight), k, static_cast<int>(batch.x.size())});
        batch.x.push_back(unit.x());
        batch.y.push_back(unit.y());
        batch.z.push_back(unit.z());
        batch.unit_length.push_back(static_cast<float>(unit_length / f.step_m));
      }
      return ++count < kMaxRaySamples;
    });
  }

  void EvaluateDensity(size_t k) {
    FieldBatch& batch = batches_[k];
    const auto n = static_cast<int64_t>(batch.x.size());
    if (n == 0) return;
    const field::HashField& f = *all_[k]->field;
    const int64_t padded = kernel::Padded(n);
    batch.stride = kernel::StrideFor(n);
    batch.features.assign(static_cast<size_t>(f.FeatureRows()) * batch.stride, 0.0F);
    batch.geometry.resize(static_cast<size_t>(field::kGeometryRows) * batch.stride);
    f.EncodeSerial(all_[k]->grid, batch.x.data(), batch.y.data(), batch.z.data(), n, batch.features.data(), batch.stride);
    for (int64_t begin = 0; begin < padded; begin += field::kChunk) {
      f.Density(all_[k]->weights, batch.features.data() + begin, batch.stride, std::min<int64_t>(field::kChunk, padded - begin),
                scratch_[k].density_hidden, scratch_[k].stride, batch.geometry.data() + begin, batch.stride);
    }
  }

  void ComposeOpacity(size_t r, RayColor& out) {
    double transmittance = 1.0;
    double depth = 0.0;
    out = RayColor{};
    constexpr double kPassed[3] = {0.85, 0.5, 0.15};
    float* const passed_at[3] = {&out.depth_front, &out.depth_median, &out.depth_back};
    for (float* distance : passed_at) *distance = std::numeric_limits<float>::quiet_NaN();
    for (size_t s = ray_begin_[r]; s < ray_begin_[r + 1]; ++s) {
      const Sample& sample = samples_[s];
      FieldBatch& batch = batches_[static_cast<size_t>(sample.field)];
      const double bias = all_[static_cast<size_t>(sample.field)]->config.density_bias;
      const double log_density = std::min(30.0, static_cast<double>(batch.geometry[static_cast<size_t>(sample.local)]) + bias);
      const double tau =
          std::exp(log_density) * static_cast<double>(batch.unit_length[static_cast<size_t>(sample.local)]) * static_cast<double>(sample.weight);
      const double after = transmittance * std::exp(-tau);
      const double weight = transmittance - after;
      depth += weight * static_cast<double>(sample.t);
      for (size_t i = 0; i < 3; ++i) {
        if (!(transmittance > kPassed[i] && after <= kPassed[i])) continue;
        // Inside the interval, where the transmittance passes the mark.
        const double share = tau > 0.0 ? std::clamp(std::log(transmittance / kPassed[i]) / tau, 0.0, 1.0) : 0.5;
        *passed_at[i] = sample.t + sample.length * static_cast<float>(share - 0.5);
      }
      weight_[s] = static_cast<float>(weight);
      if (weight_[s] > options_.colour_threshold) batch.visible.push_back(sample.local);
      transmittance = after;
    }
    out.opacity = static_cast<float>(1.0 - transmittance);
    out.depth = out.opacity > 1e-6F ? static_cast<float>(depth / (1.0 - transmittance)) : std::numeric_limits<float>::quiet_NaN();
  }

  void EvaluateColor(size_t k, std::span<const Ray> rays) {
    FieldBatch& batch = batches_[k];
    const auto n = static_cast<int64_t>(batch.visible.size());
    if (n == 0) return;
    const field::HashField& f = *all_[k]->field;
    const int64_t padded = kernel::Padded(n);
    batch.visible_stride = kernel::StrideFor(n);
    batch.color_in.assign(static_cast<size_t>(f.ColorInputRows()) * batch.visible_stride, 0.0F);
    batch.color.resize(static_cast<size_t>(field::kColorRows) * batch.visible_stride);
    FillDirections(k, rays);
    for (int row = 0; row < field::kGeometryRows; ++row) {
      const float* from = batch.geometry.data() + static_cast<size_t>(row) * batch.stride;
      float* to = batch.color_in.data() + static_cast<size_t>(row) * batch.visible_stride;
      for (size_t i = 0; i < batch.visible.size(); ++i) to[i] = from[batch.visible[i]];
    }
    for (int64_t begin = 0; begin < padded; begin += field::kChunk) {
      const int64_t count = std::min<int64_t>(field::kChunk, padded - begin);
      f.Color(all_[k]->weights, batch.color_in.data() + begin, batch.visible_stride, count, scratch_[k].color_hidden, scratch_[k].stride,
              batch.color.data() + begin, batch.visible_stride);
    }
    for (size_t c = 0; c < 3; ++c) {
      float* row = batch.color.data() + c * batch.visible_stride;
      kernel::Sigmoid(row, padded, static_cast<float>(all_[k]->config.color_range), row);
    }
  }

  // Visible samples were listed in ray order, so the same walk finds each one's ray.
  void FillDirections(size_t k, std::span<const Ray> rays) {
    FieldBatch& batch = batches_[k];
    float* sh = batch.color_in.data() + static_cast<size_t>(field::kGeometryRows) * batch.visible_stride;
    size_t next = 0;
    for (size_t r = 0; r < rays.size(); ++r) {
      const size_t first = next;
      for (size_t s = ray_begin_[r]; s < ray_begin_[r + 1]; ++s) {
        if (samples_[s].field == static_cast<int>(k) && weight_[s] > options_.colour_threshold) samples_[s].local = static_cast<int>(next++);
      }
      const Eigen::Vector3f d = rays[r].direction_enu.cast<float>();
      all_[k]->field->FillDirection(d.data(), static_cast<int64_t>(next - first), sh + first, batch.visible_stride);
    }
  }

  void ComposeColor(size_t r, RayColor& out) {
    for (size_t s = ray_begin_[r]; s < ray_begin_[r + 1]; ++s) {
      if (!(weight_[s] > options_.colour_threshold)) continue;
      const auto k = static_cast<size_t>(samples_[s].field);
      const FieldBatch& batch = batches_[k];
      for (size_t c = 0; c < 3; ++c) out.rgb_srgb[c] += weight_[s] * batch.color[c * batch.visible_stride + static_cast<size_t>(samples_[s].local)];
    }
  }

  EngineOptions options_;
  FieldSet fields_;
  std::vector<const TrainedField*> all_;
  int context_index_ = 0;
  std::vector<FieldBatch> batches_;
  std::vector<field::Activations> scratch_;
  std::vector<Sample> samples_;
  std::vector<size_t> ray_begin_;
  std::vector<float> weight_;
  std::vector<int> candidates_;
  std::vector<double> block_weights_;
};

RayRenderer::RayRenderer(const FieldSet& fields, const EngineOptions& options) : group_(std::make_unique<Group>(fields, options)) {}

RayRenderer::~RayRenderer() = default;

int64_t RayRenderer::Render(std::span<const Ray> rays, std::span<RayColor> out) {
  return group_->Render(rays, out);
}

double BlendWeights(const FieldSet& fields, std::span<const int> candidates, double x, double y, std::span<double> weights) {
  double sum = 0.0;
  for (size_t c = 0; c < candidates.size(); ++c) {
    const TrainedField& f = *fields.blocks[static_cast<size_t>(candidates[c])];
    weights[c] = BlockRamp(f.core_min_enu, f.core_max_enu, f.margin_m, x, y);
    sum += weights[c];
  }
  if (sum > 1.0) {
    for (double& weight : weights) weight /= sum;
    sum = 1.0;
  }
  return 1.0 - sum;
}

void RenderRays(const FieldSet& fields, std::span<const Ray> rays, std::span<RayColor> out, const EngineOptions& options, base::ThreadPool& threads,
                int64_t* samples) {
  if (rays.empty()) return;
  std::vector<std::unique_ptr<RayRenderer>> renderers(static_cast<size_t>(threads.size()));
  const auto n = static_cast<int64_t>(rays.size());
  std::atomic<int64_t> evaluated{0};
  threads.ParallelFor((n + kGroupRays - 1) / kGroupRays, [&](int64_t task, int thread) {
    base::ThrowIfCancelled();
    auto& renderer = renderers[static_cast<size_t>(thread)];
    if (!renderer) renderer = std::make_unique<RayRenderer>(fields, options);
    const auto begin = static_cast<size_t>(task * kGroupRays);
    const size_t count = std::min(static_cast<size_t>(kGroupRays), rays.size() - begin);
    evaluated += renderer->Render(rays.subspan(begin, count), out.subspan(begin, count));
  });
  if (samples != nullptr) *samples += evaluated;
}

}  // namespace skyquilt::render
