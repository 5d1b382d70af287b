// Planes of positions: whatever is appended in whatever order is found again.
#include "worker/rays/ray_batch.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstdint>
#include <vector>

#include "core/field/hash_field.h"

namespace skyquilt::worker {
namespace {

field::FieldConfig ConfigOf(int points) {
  field::FieldConfig config;
  config.multisample = points;
  return config;
}

// A different number for every position of every sample.
float Mark(int64_t sample, int position, int axis) {
  return static_cast<float>(1 + (sample * 6 + position) * 3 + axis);
}

// Appends rays with this many samples each, numbered from 0.
void Fill(const std::vector<int>& counts, int points, RayBatch* batch) {
  int64_t sample = 0;
  for (const int count : counts) {
    std::vector<float> axes[3], sharpness, t, unit_length;
    std::vector<int32_t> cell;
    for (int i = 0; i < count; ++i, ++sample) {
      for (int j = 0; j < points; ++j) {
        for (int axis = 0; axis < 3; ++axis) axes[axis].push_back(Mark(sample, j, axis));
      }
      sharpness.push_back(static_cast<float>(sample) + 0.25F);
      t.push_back(static_cast<float>(sample) + 0.5F);
      unit_length.push_back(static_cast<float>(sample) + 0.75F);
      cell.push_back(static_cast<int32_t>(sample));
    }
    BatchRay ray;
    ray.ray.origin_enu = ray.ray.direction_enu = Eigen::Vector3d::Zero();
    ray.count = count;
    batch->Append(ray, axes[0].data(), axes[1].data(), axes[2].data(), sharpness.data(), t.data(), unit_length.data(), cell.data());
  }
  batch->LayOutFeatures(12);
}

void ExpectFilled(const std::vector<int>& counts, int points, const RayBatch& batch) {
  RC_ASSERT(batch.rays.size() == counts.size());
  const kernel::Positions at = batch.Positions(ConfigOf(points));
  RC_ASSERT(at.points == points);
  RC_ASSERT(points == 1 || at.plane >= static_cast<size_t>(batch.Size()));
  RC_ASSERT(batch.Size() % kernel::kPad == 0);
  std::vector<bool> filled(static_cast<size_t>(batch.Size()), false);
  int64_t sample = 0;
  for (size_t r = 0; r < counts.size(); ++r) {
    RC_ASSERT(batch.rays[r].count == counts[r]);
    for (int64_t i = 0; i < batch.rays[r].count; ++i, ++sample) {
      const auto s = static_cast<size_t>(batch.rays[r].begin + i);
      filled[s] = true;
      RC_ASSERT(batch.cell[s] == static_cast<int32_t>(sample));
      RC_ASSERT(batch.sharpness[s] == static_cast<float>(sample) + 0.25F && batch.t[s] == static_cast<float>(sample) + 0.5F);
      RC_ASSERT(batch.unit_length[s] == static_cast<float>(sample) + 0.75F);
      for (int j = 0; j < points; ++j) {
        const size_t k = static_cast<size_t>(j) * at.plane + s;
        RC_ASSERT(at.x[k] == Mark(sample, j, 0) && at.y[k] == Mark(sample, j, 1) && at.z[k] == Mark(sample, j, 2));
      }
    }
  }
  RC_ASSERT(batch.n_samples == sample);
  for (size_t s = 0; s < filled.size(); ++s) {
    for (int j = 0; j < points && !filled[s]; ++j) {
      const size_t k = static_cast<size_t>(j) * at.plane + s;
      RC_ASSERT(at.x[k] == 0.0F && at.y[k] == 0.0F && at.z[k] == 0.0F && batch.unit_length[s] == 0.0F);
    }
  }
}

std::vector<int> AnyCounts() {
  auto counts = *rc::gen::container<std::vector<int>>(rc::gen::oneOf(rc::gen::inRange(0, 40), rc::gen::inRange(0, field::kChunk + 90)));
  return counts;
}

int AnyPoints() {
  return *rc::gen::element(1, 4, 6);
}

RC_GTEST_PROP(RayBatch, KeepsEveryPositionOfEverySample, ()) {
  const std::vector<int> counts = AnyCounts();
  const int points = AnyPoints();
  RayBatch batch;
  batch.Clear(points);
  Fill(counts, points, &batch);
  ExpectFilled(counts, points, batch);
}

// Nothing of an earlier batch is left, with more positions or fewer.
RC_GTEST_PROP(RayBatch, IsUsedAgain, ()) {
  RayBatch batch;
  for (int round = 0; round < 3; ++round) {
    const std::vector<int> counts = AnyCounts();
    const int points = AnyPoints();
    batch.Clear(points);
    Fill(counts, points, &batch);
    ExpectFilled(counts, points, batch);
  }
}

RC_GTEST_PROP(RayBatch, HasPacketsOfWholeRays, ()) {
  const std::vector<int> counts = AnyCounts();
  const int points = AnyPoints();
  RayBatch batch;
  batch.Clear(points);
  Fill(counts, points, &batch);
  int64_t rays = 0, samples = 0;
  for (const Packet& packet : batch.packets) {
    RC_ASSERT(packet.first_ray == rays);
    RC_ASSERT(packet.begin % kernel::kPad == 0);
    RC_ASSERT(packet.begin + kernel::Padded(packet.count) <= batch.Size());
    RC_ASSERT(packet.count <= field::kChunk || packet.n_rays == 1);
    rays += packet.n_rays;
    samples += packet.count;
  }
  RC_ASSERT(rays == static_cast<int64_t>(counts.size()));
  RC_ASSERT(samples == batch.n_samples);
}

TEST(RayBatch, OfPointsHasNoFootprints) {
  RayBatch batch;
  batch.Clear();
  Fill({3, 4}, 1, &batch);
  EXPECT_EQ(batch.Positions(ConfigOf(0)).sharpness, nullptr);
  EXPECT_EQ(batch.Positions(ConfigOf(1)).sharpness, batch.sharpness.data());
}

}  // namespace
}  // namespace skyquilt::worker
