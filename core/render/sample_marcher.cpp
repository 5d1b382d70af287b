#include "core/render/sample_marcher.h"

#include <algorithm>
#include <limits>

#include "core/base/errors.h"
#include "core/render/march.h"

namespace skyquilt::render {
namespace {

constexpr int kMaxRaySamples = 2048;  // per ray and field; later ones are left out
// Marching steps in widths of a pixel, used where they are longer than the field's own step: of fields of points, and of fields with cones, which
// know what a place looks like at this width.
constexpr double kPixelsPerStep = 4.5, kConePixelsPerStep = 1.0;

geo::Interval Clip(const Ray& ray, const TrainedField& f) {
  geo::Interval interval = FieldInterval(f.map, ray.origin_enu, ray.direction_enu);
  interval.t_near = std::max(interval.t_near, ray.t_near);
  interval.t_far = std::min(interval.t_far, ray.t_far);
  return interval;
}

// The interval of a ray where the block's weight is 1.
geo::Interval CoreInterval(const TrainedField& f, const Ray& ray) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double m = f.blend_m;
  return geo::RayBox(ray.origin_enu, ray.direction_enu, {f.box.min_enu.x() + m, f.box.min_enu.y() + m, -kInfinity},
                     {f.box.max_enu.x() - m, f.box.max_enu.y() - m, kInfinity});
}

}  // namespace

SampleMarcher::SampleMarcher(const FieldSet& fields, double step_scale)
    : fields_(fields), all_(fields.blocks), index_(fields.blocks), step_scale_(step_scale) {
  context_index_ = static_cast<int>(all_.size());
  if (fields.context != nullptr) all_.push_back(fields.context);
}

geo::Interval SampleMarcher::Reach(const Ray& ray) const {
  const geo::Interval own{ray.t_near, ray.t_far};
  if (fields_.context == nullptr) return Intersection(index_.HeightInterval(ray), own);
  return Intersection(index_.HeightInterval(ray, fields_.context->map.min_enu().z(), fields_.context->map.max_enu().z()), own);
}

void SampleMarcher::March(const Ray& ray, const Window& window, std::vector<Sample>* samples) {
  gaps_.clear();
  ramps_.clear();
  here_from_ = here_to_ = 0.0;
  const bool with_context = fields_.context != nullptr;
  if (with_context) gaps_.push_back(Clip(ray, *fields_.context));
  index_.Find(ray, Reach(ray), &candidates_);
  // Inside its ground plan a block replaces the context even above its box, where there is free space.
  std::erase_if(candidates_, [&](int k) { return PlanInterval(all_[static_cast<size_t>(k)]->map, ray.origin_enu, ray.direction_enu).Empty(); });
  if (with_context) {
    for (const int k : candidates_) CutCore(*all_[static_cast<size_t>(k)], ray);
  }
  const size_t begin = samples->size();
  int marched = 0;
  for (const int k : candidates_) {
    const TrainedField& f = *all_[static_cast<size_t>(k)];
    const geo::Interval inside = Clip(ray, f);
    if (!window.Overlaps(Intersection(BlendInterval(f, ray), inside))) continue;
    marched += MarchField(ray, window, k, inside, samples) ? 1 : 0;
  }
  for (const geo::Interval& gap : gaps_) {
    if (window.Overlaps(gap)) marched += MarchField(ray, window, context_index_, gap, samples) ? 1 : 0;
  }
  if (marched < 2) return;  // in order already
  const auto first = samples->begin() + static_cast<ptrdiff_t>(begin);
  std::stable_sort(first, samples->end(), [](const Sample& a, const Sample& b) { return a.t < b.t; });
}

void SampleMarcher::FindHere(const Ray& ray, double t) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (ramps_.empty()) {
    const double slack = index_.Slack(ray);
    for (const int k : candidates_) {
      const TrainedField& f = *all_[static_cast<size_t>(k)];
      const Eigen::Vector3d reach(f.blend_m + slack, f.blend_m + slack, kInfinity);
      ramps_.push_back(geo::RayBox(ray.origin_enu, ray.direction_enu, f.box.min_enu - reach, f.box.max_enu + reach));
    }
  }
  here_.clear();
  here_from_ = -kInfinity;
  here_to_ = kInfinity;
  for (size_t c = 0; c < candidates_.size(); ++c) {
    const geo::Interval& ramp = ramps_[c];
    if (ramp.Empty()) continue;
    if (t < ramp.t_near) {
      here_to_ = std::min(here_to_, ramp.t_near);
    } else if (t >= ramp.t_far) {
      here_from_ = std::max(here_from_, ramp.t_far);
    } else {
      here_.push_back(candidates_[c]);
      here_from_ = std::max(here_from_, ramp.t_near);
      here_to_ = std::min(here_to_, ramp.t_far);
    }
  }
  block_weights_.resize(here_.size());
}

// Takes that interval out of the context's intervals.
void SampleMarcher::CutCore(const TrainedField& f, const Ray& ray) {
  const geo::Interval core = CoreInterval(f, ray);
  if (core.Empty()) return;
  const size_t n = gaps_.size();
  for (size_t i = 0; i < n; ++i) {
    const geo::Interval gap = gaps_[i];
    if (core.t_far <= gap.t_near || core.t_near >= gap.t_far) continue;
    gaps_[i].t_far = std::min(gap.t_far, core.t_near);
    if (gap.t_far > core.t_far) gaps_.push_back({core.t_far, gap.t_far});
  }
}

// Steps grow with the pixel: finer detail cannot be seen.
double SampleMarcher::StepScale(const Ray& ray, const TrainedField& f, const geo::Interval& interval) const {
  const double wanted_m = f.config.Cones() ? kConePixelsPerStep * ray.Footprint(interval.t_near)
                                           : kPixelsPerStep * static_cast<double>(ray.pixel_pitch) * interval.t_near;
  return std::max(step_scale_, wanted_m / f.step_m);
}

// True when samples were added.
bool SampleMarcher::MarchField(const Ray& ray, const Window& window, int k, const geo::Interval& interval, std::vector<Sample>* samples) {
  const TrainedField& f = *all_[static_cast<size_t>(k)];
  SKYQUILT_CHECK(f.field != nullptr, "field '" + f.name + "' is not loaded");
  const size_t before = samples->size();
  const UnitRay unit(f.map, ray.origin_enu, ray.direction_enu);
  // No blending where the block's weight is 1.
  const bool is_context = k == context_index_;
  const geo::Interval alone = is_context ? geo::Interval{} : CoreInterval(f, ray);
  int count = 0;
  // Samples are at the same positions as without a window, so that the result does not depend on where a ray is cut.
  const auto emit = [&](double t, double length, double unit_length) {
    if (!(t < window.to)) return false;
    if (t < window.from) return ++count < kMaxRaySamples;
    double weight = 1.0;
    if (!(t > alone.t_near && t < alone.t_far)) {
      if (!(t >= here_from_ && t < here_to_)) FindHere(ray, t);
      const double context_weight = BlendWeights(fields_, here_, ray.origin_enu.x() + t * ray.direction_enu.x(),
                                                 ray.origin_enu.y() + t * ray.direction_enu.y(), block_weights_);
      const auto own = std::find(here_.begin(), here_.end(), k);
      weight = is_context ? context_weight : own == here_.end() ? 0.0 : block_weights_[static_cast<size_t>(own - here_.begin())];
    }
    if (weight > 1e-4) {
      const Eigen::Vector3f p = unit.At(t);
      samples->push_back({t, static_cast<float>(length), static_cast<float>(unit_length / f.step_m), static_cast<float>(weight), p.x(), p.y(), p.z(),
                          count % 2 != 0, k, 0.0F, 0});
    }
    return ++count < kMaxRaySamples;
  };
  const double step_m = f.step_m * StepScale(ray, f, interval);
  if (step_m > 1.01 * f.step_m) {
    MarchCoarse(f, ray.origin_enu, ray.direction_enu, interval, step_m, 0.5F, emit);
  } else {
    render::March(f, ray.origin_enu, ray.direction_enu, interval, step_m, 0.5F,
                  [&](double t, double length, double unit_length, int64_t) { return emit(t, length, unit_length); });
  }
  return samples->size() > before;
}

}  // namespace skyquilt::render
