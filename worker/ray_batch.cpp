#include "worker/ray_batch.h"

#include <algorithm>

#include "core/field/hash_field.h"
#include "core/render/footprint.h"
#include "core/render/march.h"

namespace skyquilt::worker {
namespace {

constexpr int kGroupRays = 64;
constexpr int kMaxRaySamples = 1024;
constexpr uint64_t kRayStream = 1;
// Density that is blurred over several cells must not decide which of them are free.
constexpr float kLeastWeightToObserve = 0.5F;
// Marching step of rays from reduced photos in widths of their pixels.
constexpr double kCoarsePixelsPerStep = 2.0;

}  // namespace

uint64_t MixSeed(uint64_t seed, uint64_t step, uint64_t index) {
  uint64_t v = seed * 0x9E3779B97F4A7C15ULL + step * 0xBF58476D1CE4E5B9ULL + index * 0x94D049BB133111EBULL;
  v ^= v >> 31U;
  v *= 0xD6E8FEB86659FD93ULL;
  return v ^ (v >> 32U);
}

void RayBatch::Clear() {
  rays.clear();
  packets.clear();
  for (auto* v : {&x, &y, &z, &sharpness, &t, &unit_length}) v->clear();
  cell.clear();
  n_samples = 0;
}

void RayBatch::Append(BatchRay ray, const float* x_in, const float* y_in, const float* z_in, const float* sharpness_in, const float* t_in, const float* unit_length_in,
                      const int32_t* cell_in) {
  if (packets.empty() || packets.back().count + ray.count > field::kChunk) {
    const auto begin = static_cast<size_t>(kernel::Padded(Size()));
    for (auto* v : {&x, &y, &z, &sharpness, &t, &unit_length}) v->resize(begin, 0.0F);
    cell.resize(begin, 0);
    packets.push_back({static_cast<int64_t>(rays.size()), 0, static_cast<int64_t>(begin), 0, 0, 0});
  }
  Packet& packet = packets.back();
  ray.begin = Size();
  packet.count += ray.count;
  ++packet.n_rays;
  n_samples += ray.count;
  const auto add = [&](auto& to, const auto* from) { to.insert(to.end(), from, from + ray.count); };
  add(x, x_in);
  add(y, y_in);
  add(z, z_in);
  add(sharpness, sharpness_in);
  add(t, t_in);
  add(unit_length, unit_length_in);
  add(cell, cell_in);
  rays.push_back(ray);
}

void RayBatch::LayOutFeatures(int rows) {
  const auto end = static_cast<size_t>(kernel::Padded(Size()));
  for (auto* v : {&x, &y, &z, &sharpness, &t, &unit_length}) v->resize(end, 0.0F);
  cell.resize(end, 0);
  size_t at = 0;
  for (Packet& packet : packets) {
    packet.stride = kernel::StrideFor(packet.count);
    packet.features = at;
    at += packet.stride * static_cast<size_t>(rows);
  }
}

void RayDrawer::Group::MakeRoom(size_t samples) {
  if (x.size() >= count + samples) return;
  const size_t size = 2 * (count + samples);
  for (auto* v : {&x, &y, &z, &sharpness, &t, &unit_length}) v->resize(size);
  cell.resize(size);
}

void RayDrawer::AddRay(BatchRay r, base::Random& random, Group& group) const {
  const float drawn = random.Uniform();
  const float jitter = stratified_ ? drawn : 0.5F;
  for (float& channel : r.background) channel = random.Uniform();
  const geo::Interval interval = render::FieldInterval(target_.map, r.ray.origin_enu, r.ray.direction_enu);
  if (interval.Empty()) return;
  const render::UnitRay unit(target_.map, r.ray.origin_enu, r.ray.direction_enu);
  group.MakeRoom(kMaxRaySamples);
  size_t at = group.count;
  const size_t end = at + kMaxRaySamples;
  const double per_step = 1.0 / target_.step_m;
  const auto pitch = static_cast<double>(r.ray.pixel_pitch);
  const auto finest = static_cast<float>(target_.config.grid.finest_resolution);
  const auto emit = [&](double t, double, double unit_length, int64_t cell) {
    const Eigen::Vector3f p = unit.At(t);
    group.x[at] = p.x();
    group.y[at] = p.y();
    group.z[at] = p.z();
    group.t[at] = static_cast<float>(t);
    group.unit_length[at] = static_cast<float>(unit_length * per_step);
    group.cell[at] = static_cast<int32_t>(cell);
    if (target_.config.cones) {
      const float sharpness = render::SharpnessOf(pitch * t, target_.map.VolumeScale(r.ray.origin_enu + t * r.ray.direction_enu));
      group.sharpness[at] = sharpness;
      if (kernel::FootprintWeight(sharpness, finest) < kLeastWeightToObserve) group.cell[at] = -1;
    }
    return ++at < end;
  };
  const double coarse_step_m = r.ray.level > 0 && target_.config.cones ? kCoarsePixelsPerStep * pitch * interval.t_near : 0.0;
  if (coarse_step_m > 1.01 * target_.step_m) {
    render::MarchCoarse(target_, r.ray.origin_enu, r.ray.direction_enu, interval, coarse_step_m, jitter,
                        [&](double t, double length, double unit_length) { return emit(t, length, unit_length, -1); });
  } else {
    render::March(target_, r.ray.origin_enu, r.ray.direction_enu, interval, target_.step_m, jitter, emit);
  }
  r.count = static_cast<int64_t>(at - group.count);
  group.count = at;
  group.rays.push_back(r);
}

void RayDrawer::Draw(int64_t step, int n_rays, int feature_rows, const PhotoPyramid& pyramid, RayBatch* batch) {
  const int n_groups = (n_rays + kGroupRays - 1) / kGroupRays;
  groups_.resize(static_cast<size_t>(n_groups));
  threads_.ParallelFor(n_groups, [&](int64_t task, int thread) {
    const auto start = PhaseTimes::Clock::now();
    Group& group = groups_[static_cast<size_t>(task)];
    group.rays.clear();
    group.count = 0;
    base::Random random(MixSeed(seed_, static_cast<uint64_t>(step), static_cast<uint64_t>(task)), kRayStream);
    PixelRay patch[kPatchPixels];
    const int per_patch = neighbours_ == Neighbours::kPatch ? kPatchPixels : 1;
    for (int i = 0; i < kGroupRays; i += per_patch) {
      const int n = per_patch > 1 ? source_.DrawPatch(random, pyramid, per_patch, patch) : source_.Draw(random, pyramid, patch) ? 1 : 0;
      for (int k = 0; k < n; ++k) {
        BatchRay r;
        r.ray = patch[k];
        r.patch = task * kGroupRays + (neighbours_ == Neighbours::kBatch ? 0 : i);
        AddRay(r, random, group);
      }
    }
    times_.Add(thread, Phase::kDraw, start);
  });
  const auto start = PhaseTimes::Clock::now();
  batch->Clear();
  for (const Group& group : groups_) {
    size_t at = 0;
    for (const BatchRay& r : group.rays) {
      batch->Append(r, group.x.data() + at, group.y.data() + at, group.z.data() + at, group.sharpness.data() + at, group.t.data() + at, group.unit_length.data() + at,
                    group.cell.data() + at);
      at += static_cast<size_t>(r.count);
    }
  }
  batch->LayOutFeatures(feature_rows);
  times_.Add(0, Phase::kDraw, start);
}

}  // namespace skyquilt::worker
