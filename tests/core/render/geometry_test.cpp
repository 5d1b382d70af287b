#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <set>

#include "core/base/random.h"
#include "core/geo/ray_box.h"
#include "core/render/blend.h"
#include "core/render/march.h"

namespace skyquilt::render {
namespace {

const Eigen::Vector3d kMin(-1.0, -2.0, 0.0), kMax(3.0, 2.0, 5.0);

TEST(Blend, NeighboursSumToOneAcrossTheirBorder) {
  const Eigen::Vector3d a_min(0, 0, 0), a_max(10, 10, 5), b_min(10, 0, 0), b_max(20, 10, 9);
  for (double x = 3.0; x < 17.0; x += 0.1) {
    const double sum = BlockRamp(a_min, a_max, 2.0, x, 5.0) + BlockRamp(b_min, b_max, 2.0, x, 5.0);
    EXPECT_NEAR(sum, 1.0, 1e-12) << x;
  }
  EXPECT_EQ(BlockRamp(a_min, a_max, 0.0, 10.5, 5.0), 0.0);
  EXPECT_EQ(BlockRamp(a_min, a_max, 0.0, 9.5, 5.0), 1.0);
}

TrainedField BoxField() {
  TrainedField f;
  f.map = encoding::SpaceMap::Box(kMin, kMax);
  const double extent[3] = {f.map.extent().x(), f.map.extent().y(), f.map.extent().z()};
  f.occupancy = field::OccupancyGrid::Make(extent, 0.05, 1 << 20);
  f.step_m = 0.1;
  return f;
}

TEST(March, FullOccupancyGivesEverySampleOnce) {
  const TrainedField f = BoxField();
  base::Random random(41);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d origin{random.Uniform(-6, 6), random.Uniform(-6, 6), random.Uniform(-3, 9)};
    const Eigen::Vector3d target{random.Uniform(-1, 3), random.Uniform(-2, 2), random.Uniform(0, 5)};
    const Eigen::Vector3d direction = (target - origin).normalized();
    const geo::Interval s = FieldInterval(f.map, origin, direction);
    if (s.Empty()) continue;
    std::vector<double> ts;
    March(f, origin, direction, s, f.step_m, 0.5F, [&](double t, double, double, int64_t) {
      ts.push_back(t);
      return true;
    });
    EXPECT_NEAR(static_cast<double>(ts.size()), (s.t_far - s.t_near) / f.step_m, 1.01);
    for (size_t k = 1; k < ts.size(); ++k) EXPECT_NEAR(ts[k] - ts[k - 1], f.step_m, 1e-9);
  }
}

// For any step, the samples' lengths add up to the length of the ray inside occupied cells: nothing thin is skipped.
RC_GTEST_PROP(March, LongStepsMissNothing, ()) {
  TrainedField f;
  f.map = encoding::SpaceMap::Box({0.0, 0.0, 0.0}, {10.0, 10.0, 10.0});
  const double extent[3] = {1.0, 1.0, 1.0};
  f.occupancy = field::OccupancyGrid::Make(extent, 0.05, 8000);
  f.step_m = 0.2;
  std::fill(f.occupancy.occupied.begin(), f.occupancy.occupied.end(), false);
  const int layer = *rc::gen::inRange(0, 20);
  const int thick = *rc::gen::inRange(1, 4);
  for (int z = layer; z < std::min(20, layer + thick); ++z) {
    for (int i = 0; i < 400; ++i) f.occupancy.occupied[400 * static_cast<size_t>(z) + static_cast<size_t>(i)] = true;
  }
  const double x = *rc::gen::inRange(100, 900) / 100.0, y = *rc::gen::inRange(100, 900) / 100.0;
  const double slope = *rc::gen::inRange(-5, 6) / 100.0;
  const Eigen::Vector3d origin(x, y, 12.0), direction = Eigen::Vector3d(slope, 0.0, -1.0).normalized();
  const double step_m = *rc::gen::inRange(1, 40) / 10.0;
  const geo::Interval s = geo::RayBox(origin, direction, f.map.min_enu(), f.map.max_enu());
  double length = 0.0, last = 0.0;
  MarchCoarse(f, origin, direction, s, step_m, 0.5F, [&](double t, double sample_m, double) {
    RC_ASSERT(sample_m <= step_m * 1.000001);
    RC_ASSERT(t > last);
    last = t;
    length += sample_m;
    return true;
  });
  const double expected = 0.5 * (std::min(20, layer + thick) - layer) / -direction.z();
  RC_ASSERT(std::abs(length - expected) < 1e-6);
}

TEST(March, SamplesAreInOccupiedCellsOnly) {
  TrainedField f = BoxField();
  base::Random random(43);
  for (auto&& cell : f.occupancy.occupied) cell = random.Below(3) == 0;
  int samples = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d origin{random.Uniform(-6, 6), random.Uniform(-6, 6), 8.0};
    const Eigen::Vector3d direction = Eigen::Vector3d{random.Uniform(-0.5, 0.5), random.Uniform(-0.5, 0.5), -1.0}.normalized();
    const geo::Interval s = FieldInterval(f.map, origin, direction);
    std::set<int64_t> expected, got;
    // Tests every sample position; positions within rounding of a cell face may be on either side.
    int64_t k = 0;
    for (double t = s.t_near + 0.05; t < s.t_far && !s.Empty(); t += f.step_m, ++k) {
      const Eigen::Vector3f p = f.map.UnitFromEnu(origin + t * direction);
      if (f.occupancy.occupied[static_cast<size_t>(f.occupancy.IndexAt(p.x(), p.y(), p.z()))]) expected.insert(k);
    }
    March(f, origin, direction, s, f.step_m, 0.5F, [&](double t, double, double, int64_t) {
      got.insert(static_cast<int64_t>(std::lround((t - s.t_near - 0.05) / f.step_m)));
      ++samples;
      return true;
    });
    std::vector<int64_t> difference;
    std::set_symmetric_difference(expected.begin(), expected.end(), got.begin(), got.end(), std::back_inserter(difference));
    EXPECT_LE(difference.size(), 1U);
  }
  EXPECT_GT(samples, 100);
}

}  // namespace
}  // namespace skyquilt::render
