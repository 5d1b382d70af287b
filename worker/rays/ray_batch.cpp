#include "worker/rays/ray_batch.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "core/field/hash_field.h"
#include "core/render/footprint.h"
#include "core/render/march.h"

namespace skyquilt::worker {
namespace {

constexpr int kGroupRays = 64;
constexpr int kMaxRaySamples = 1024;
constexpr uint64_t kRayStream = 1;
// Density that is blurred over several cells must not decide which of them are free where sharper samples do: least sharpness in cells, where the
// finest level's weight is a half.
constexpr float kLeastSharpnessToObserve = 0.4769F;
// Of a sample of a coarse march that is sharp enough: it crosses several cells and says nothing about any. ~kNoCell is no cell of a grid.
constexpr int32_t kNoCell = std::numeric_limits<int32_t>::min();
// Marching step of rays from reduced photos in widths of their pixels.
constexpr double kCoarsePixelsPerStep = 1.0;

}  // namespace

uint64_t MixSeed(uint64_t seed, uint64_t step, uint64_t index) {
  uint64_t v = seed * 0x9E3779B97F4A7C15ULL + step * 0xBF58476D1CE4E5B9ULL + index * 0x94D049BB133111EBULL;
  v ^= v >> 31U;
  v *= 0xD6E8FEB86659FD93ULL;
  return v ^ (v >> 32U);
}

void RayBatch::Clear(int positions) {
  rays.clear();
  packets.clear();
  for (auto* v : {&sharpness, &t, &unit_length}) v->clear();
  cell.clear();
  n_samples = 0;
  if (positions != points) plane = 0;
  points = positions;
}

void RayBatch::MakeRoom(size_t samples) {
  if (samples <= plane) return;
  const size_t wider = 2 * samples;
  for (auto* v : {&x, &y, &z}) {
    v->resize(std::max(v->size(), wider * static_cast<size_t>(points)));
    for (auto j = static_cast<size_t>(points); j-- > 1;) {
      const float* const from = v->data() + j * plane;
      std::copy_backward(from, from + t.size(), v->data() + j * wider + t.size());
    }
  }
  plane = wider;
}

void RayBatch::PadTo(size_t end) {
  MakeRoom(end);
  for (auto* v : {&x, &y, &z}) {
    for (size_t j = 0; j < static_cast<size_t>(points); ++j) std::fill(v->data() + j * plane + t.size(), v->data() + j * plane + end, 0.0F);
  }
  for (auto* v : {&sharpness, &t, &unit_length}) v->resize(end, 0.0F);
  cell.resize(end, 0);
}

void RayBatch::Append(BatchRay ray, const float* x_in, const float* y_in, const float* z_in, const float* sharpness_in, const float* t_in,
                      const float* unit_length_in, const int32_t* cell_in) {
  const int64_t together = std::clamp<int64_t>(ray.segment_samples, ray.count, std::max<int64_t>(ray.count, field::kChunk));
  if (packets.empty() || packets.back().count + together > field::kChunk) {
    const int64_t begin = kernel::Padded(Size());
    PadTo(static_cast<size_t>(begin));
    packets.push_back({static_cast<int64_t>(rays.size()), 0, begin, 0, 0, 0});
  }
  Packet& packet = packets.back();
  ray.begin = Size();
  packet.count += ray.count;
  ++packet.n_rays;
  n_samples += ray.count;
  MakeRoom(t.size() + static_cast<size_t>(ray.count));
  const auto add_positions = [&](std::vector<float>& to, const float* from) {
    if (points == 1) {
      std::copy_n(from, ray.count, to.data() + t.size());
      return;
    }
    for (size_t j = 0; j < static_cast<size_t>(points); ++j) {
      float* const plane_of_j = to.data() + j * plane + t.size();
      for (size_t s = 0; s < static_cast<size_t>(ray.count); ++s) plane_of_j[s] = from[s * static_cast<size_t>(points) + j];
    }
  };
  add_positions(x, x_in);
  add_positions(y, y_in);
  add_positions(z, z_in);
  const auto add = [&](auto& to, const auto* from) { to.insert(to.end(), from, from + ray.count); };
  add(sharpness, sharpness_in);
  add(t, t_in);
  add(unit_length, unit_length_in);
  add(cell, cell_in);
  rays.push_back(ray);
}

void RayBatch::LayOutFeatures(int rows) {
  PadTo(static_cast<size_t>(kernel::Padded(Size())));
  size_t at = 0;
  for (Packet& packet : packets) {
    packet.stride = kernel::StrideFor(packet.count);
    packet.features = at;
    at += packet.stride * static_cast<size_t>(rows);
  }
}

void RayDrawer::Group::MakeRoom(size_t samples, int points) {
  if (t.size() >= count + samples && x.size() >= (count + samples) * static_cast<size_t>(points)) return;
  const size_t size = 2 * (count + samples);
  for (auto* v : {&x, &y, &z}) v->resize(size * static_cast<size_t>(points));
  for (auto* v : {&sharpness, &t, &unit_length}) v->resize(size);
  cell.resize(size);
}

class RayDrawer::SampleWriter {
 public:
  SampleWriter(const render::TrainedField& target, const PixelRay& ray, size_t most, base::Random& random, Group& group)
      : target_(target),
        ray_(ray),
        points_(std::max(1, target.config.multisample)),
        cone_axis_{.origin_enu = ray.origin_enu, .direction_enu = ray.direction_enu, .pixel_pitch = ray.pixel_pitch},
        cone_(target.map, cone_axis_, points_),
        observing_(kLeastSharpnessToObserve * static_cast<float>(target.config.grid.finest_resolution)),
        per_step_(1.0 / target.step_m),
        random_(random),
        group_(group),
        at_(group.count),
        end_(group.count + most) {
    group.MakeRoom(most, points_);
  }
  const render::Ray& axis() const { return cone_axis_; }
  int64_t count() const { return static_cast<int64_t>(at_ - group_.count); }

  // False when there is no room for more.
  bool operator()(double t, double length, double unit_length, int64_t cell) {
    const double width_m = cone_axis_.Footprint(t);
    render::Turn turn;
    if (points_ > 1) {
      turn.angle = 2.0 * std::numbers::pi * static_cast<double>(random_.Uniform());
      turn.reversed = random_.Uniform() < 0.5F;
    }
    const size_t first = at_ * static_cast<size_t>(points_);
    cone_.Positions(t, length, width_m, turn, &group_.x[first], &group_.y[first], &group_.z[first], 1);
    group_.t[at_] = static_cast<float>(t);
    group_.unit_length[at_] = static_cast<float>(unit_length * per_step_);
    group_.cell[at_] = static_cast<int32_t>(cell);
    if (target_.config.Cones()) {
      const float sharpness = render::SharpnessOf(width_m, target_.map.VolumeScale(ray_.origin_enu + t * ray_.direction_enu), points_);
      group_.sharpness[at_] = sharpness;
      if (sharpness < observing_) {
        const double shares_z = random_.UniformDouble(), shares_y = random_.UniformDouble(), shares_x = random_.UniformDouble();
        const Eigen::Vector3d shares(shares_x, shares_y, shares_z);
        const Eigen::Vector3f place = cone_.Within(t, length, width_m, shares);
        group_.cell[at_] = ~static_cast<int32_t>(target_.occupancy.IndexAt(place.x(), place.y(), place.z()));
      }
    }
    return ++at_ < end_;
  }

 private:
  const render::TrainedField& target_;
  const PixelRay& ray_;
  int points_;
  render::Ray cone_axis_;
  render::Cone cone_;
  float observing_;
  double per_step_;
  base::Random& random_;
  Group& group_;
  size_t at_, end_;
};

void RayDrawer::AddRay(BatchRay r, base::Random& random, Group& group) const {
  const float drawn = random.Uniform();
  const float jitter = stratified_ ? drawn : 0.5F;
  for (float& channel : r.background) channel = random.Uniform();
  const geo::Interval interval = render::FieldInterval(target_.map, r.ray.origin_enu, r.ray.direction_enu);
  if (interval.Empty()) return;
  if (sampler_ != nullptr) {
    group.binned.push_back({r.ray.origin_enu, r.ray.direction_enu, interval});
    group.rays.push_back(r);
    return;
  }
  SampleWriter emit(target_, r.ray, kMaxRaySamples, random, group);
  // A concealing field may dim by every sample that light passes, so their number must not depend on the photo's size.
  const bool may_step_far = target_.config.Cones() && r.ray.level > 0 && neighbours_ == Neighbours::kNone;
  const double coarse_step_m = may_step_far ? kCoarsePixelsPerStep * emit.axis().Footprint(interval.t_near) : 0.0;
  if (coarse_step_m > 1.01 * target_.step_m) {
    render::MarchCoarse(target_, r.ray.origin_enu, r.ray.direction_enu, interval, coarse_step_m, jitter,
                        [&](double t, double length, double unit_length) { return emit(t, length, unit_length, kNoCell); });
  } else {
    render::March(target_, r.ray.origin_enu, r.ray.direction_enu, interval, target_.step_m, jitter, emit);
  }
  r.count = emit.count();
  group.count += static_cast<size_t>(r.count);
  group.rays.push_back(r);
}

void RayDrawer::AddBins(int64_t task, base::Random& random, int thread, Group& group) const {
  const std::span<const float> edges = sampler_->Place(task, group.binned, random, thread);
  const auto bins = static_cast<size_t>(sampler_->LastBins());
  for (size_t i = 0; i < group.rays.size(); ++i) {
    BatchRay& r = group.rays[i];
    SampleWriter emit(target_, r.ray, bins, random, group);
    const RayPlaces places(target_, group.binned[i]);
    const float* const edge = edges.data() + i * (bins + 1);
    for (size_t k = 0; k < bins; ++k) {
      const RayPlaces::Bin bin = places.Of(static_cast<double>(edge[k]), static_cast<double>(edge[k + 1]));
      emit(bin.t, bin.length_m, bin.unit_length_m, kNoCell);
    }
    r.count = emit.count();
    group.count += bins;
  }
}

int RayDrawer::AddPriorRays(const PriorRays& priors, int64_t task, base::Random& random, Group& group) const {
  const int n_segments = priors.segments == nullptr ? 0 : static_cast<int>(std::lround(priors.segment_share * kGroupRays / kSegmentRays));
  const int n_points = priors.points == nullptr ? 0 : static_cast<int>(std::lround(priors.point_share * kGroupRays));
  PixelRay rays[kSegmentRays];
  for (int s = 0; s < n_segments; ++s) {
    int drawn = 0;
    const bool together = source_.DrawSegment(random, *priors.segments, rays, &drawn);
    for (int k = 0; k < drawn; ++k) {
      BatchRay r;
      r.ray = rays[k];
      r.patch = task * kGroupRays + s * kSegmentRays + k;
      if (together) r.segment = task * kGroupRays + s;
      AddRay(r, random, group);
    }
  }
  for (int i = 0; i < n_points; ++i) {
    BatchRay r;
    r.patch = task * kGroupRays + n_segments * kSegmentRays + i;
    if (source_.PointRay(priors.points->Draw(random), &r.ray)) AddRay(r, random, group);
  }
  return n_segments * kSegmentRays + n_points;
}

int64_t RayDrawer::Groups(int n_rays) {
  return (n_rays + kGroupRays - 1) / kGroupRays;
}

void RayDrawer::Draw(int64_t step, int n_rays, int feature_rows, const PhotoPyramid& pyramid, const PriorRays& priors, RayBatch* batch) {
  const int64_t n_groups = Groups(n_rays);
  groups_.resize(static_cast<size_t>(n_groups));
  threads_.ParallelFor(n_groups, [&](int64_t task, int thread) {
    auto start = PhaseTimes::Clock::now();
    Group& group = groups_[static_cast<size_t>(task)];
    group.rays.clear();
    group.binned.clear();
    group.count = 0;
    base::Random random(MixSeed(seed_, static_cast<uint64_t>(step), static_cast<uint64_t>(task)), kRayStream);
    PixelRay patch[kPatchPixels];
    const int per_patch = neighbours_ == Neighbours::kPatch ? kPatchPixels : 1;
    for (int i = AddPriorRays(priors, task, random, group); i < kGroupRays; i += per_patch) {
      const int n = per_patch > 1 ? source_.DrawPatch(random, pyramid, per_patch, patch) : source_.Draw(random, pyramid, patch) ? 1 : 0;
      for (int k = 0; k < n; ++k) {
        BatchRay r;
        r.ray = patch[k];
        r.patch = task * kGroupRays + (neighbours_ == Neighbours::kBatch ? 0 : i);
        AddRay(r, random, group);
      }
    }
    start = times_.Add(thread, Phase::kDraw, start);
    if (sampler_ == nullptr) return;
    AddBins(task, random, thread, group);
    times_.Add(thread, Phase::kSampler, start);
  });
  const auto start = PhaseTimes::Clock::now();
  const int points = std::max(1, target_.config.multisample);
  batch->Clear(points);
  batch->uneven = sampler_ != nullptr;
  for (const Group& group : groups_) {
    size_t at = 0;
    for (size_t i = 0; i < group.rays.size(); ++i) {
      BatchRay r = group.rays[i];
      const bool starts_segment = r.segment >= 0 && (i == 0 || group.rays[i - 1].segment != r.segment);
      for (size_t k = i; starts_segment && k < group.rays.size() && group.rays[k].segment == r.segment; ++k) r.segment_samples += group.rays[k].count;
      const size_t first = at * static_cast<size_t>(points);
      batch->Append(r, group.x.data() + first, group.y.data() + first, group.z.data() + first, group.sharpness.data() + at, group.t.data() + at,
                    group.unit_length.data() + at, group.cell.data() + at);
      at += static_cast<size_t>(r.count);
    }
  }
  batch->LayOutFeatures(feature_rows);
  times_.Add(0, Phase::kDraw, start);
}

}  // namespace skyquilt::worker
