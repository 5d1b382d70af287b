// A point says what the sample of a ray says there: the ray starts half a step before the point and ends before the next sample.
#include "core/scene/point_query.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "core/base/random.h"
#include "core/render/ray_engine.h"
#include "tests/support/random_scene.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::scene {
namespace {

constexpr double kStep_m = 0.25;  // of a random field
constexpr double kMargin_m = 0.8;
constexpr int kQueryRows = 2, kQueryColumns = 3;

struct Asked {
  std::vector<Eigen::Vector3d> points, directions;
};

Asked RandomPoints(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int n) {
  base::Random random(8);
  Asked asked;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d share{random.Uniform(0.0, 1.0), random.Uniform(0.0, 1.0), random.Uniform(0.0, 1.0)};
    asked.points.emplace_back(low + share.cwiseProduct(high - low));
    asked.directions.emplace_back(Eigen::Vector3d{random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0), random.Uniform(-1.0, -0.1)}.normalized());
  }
  return asked;
}

// What rays through these points with one sample each, of length `step_m`, have. step_scale: of the field's own step.
std::vector<render::RayColor> OneSample(const render::FieldSet& fields, const Asked& asked, double step_m, float width_m, base::ThreadPool& threads,
                                        double step_scale = 1.0) {
  std::vector<render::Ray> rays;
  for (size_t i = 0; i < asked.points.size(); ++i) {
    rays.push_back({.origin_enu = asked.points[i] - 0.5 * step_m * asked.directions[i],
                    .direction_enu = asked.directions[i],
                    .t_far = 0.999 * step_m,
                    .pixel_width = width_m});
  }
  std::vector<render::RayColor> colors(rays.size());
  render::EngineOptions options;
  options.colour_threshold = 0.0F;
  options.step_scale = step_scale;
  render::RenderRays(fields, rays, colors, options, threads);
  return colors;
}

// depth_of_density: optical depth of a sample for a density of 1. blended: several fields have a sample there; of a ray the first hides part of the
// second, the more the denser they are, while a point has both.
void ExpectSame(const std::vector<PointColor>& points, const std::vector<render::RayColor>& rays, double depth_of_density, size_t at_least,
                bool blended = false) {
  size_t compared = 0, differ = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    differ += (points[i].density > 0.0F) == (rays[i].opacity > 0.0F) ? 0 : 1;  // rounding at the faces of cells
    if (!(rays[i].opacity > 1e-3F && rays[i].opacity < 0.98F && points[i].density > 0.0F)) continue;
    ++compared;
    const double depth = -std::log1p(-static_cast<double>(rays[i].opacity));
    EXPECT_NEAR(static_cast<double>(points[i].density) * depth_of_density, depth, 1e-3 * depth) << i;
    const double hidden = blended ? 0.25 * depth : 0.0;
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(points[i].rgb_srgb[c], rays[i].rgb_srgb[c] / rays[i].opacity, 1e-3 + hidden) << i;
  }
  EXPECT_GE(compared, at_least);
  EXPECT_LE(differ, points.size() / 200);
}

class PointQueryTest : public ::testing::Test {
 protected:
  PointQueryTest() {
    WriteRandomScene(folder_ / "scene.h5", kQueryRows, kQueryColumns, kMargin_m, 1.0, true);
    store_ = std::make_unique<FieldStore>(Open(0.0));
    store_->EnsureAllLoaded();
    index_ = std::make_unique<render::GroundIndex>(store_->Blocks());
    fields_ = {store_->Blocks(), &store_->context()};
  }
  FieldStore Open(double memory_bytes) const { return {checkpoint::ArchiveReader(folder_ / "scene.h5"), folder_ / "scene.h5", memory_bytes, false}; }
  std::vector<PointColor> Query(FieldStore& store, const Asked& asked, const PointOptions& options = {}) {
    std::vector<PointColor> out(asked.points.size());
    QueryPoints(store, *index_, asked.points, asked.directions, options, out, threads_);
    return out;
  }

  TemporaryFolder folder_;
  base::ThreadPool threads_{2};
  std::unique_ptr<FieldStore> store_;
  std::unique_ptr<render::GroundIndex> index_;
  render::FieldSet fields_;
};

TEST_F(PointQueryTest, IsTheSampleOfARayWhereBlocksAreBlended) {
  // Farther from the outer faces than the blending with the context, whose samples lie elsewhere, and not where a block's margin ends: a ray that
  // enters it there has its first sample later.
  const Asked all = RandomPoints({1.0, 1.0, 0.3}, {14.0, 9.0, 3.7}, 3000);
  const auto from_face = [](double x) { return std::abs(x - kRandomBlock_m * std::round(x / kRandomBlock_m)); };
  Asked asked;
  for (size_t i = 0; i < all.points.size(); ++i) {
    const double x = from_face(all.points[i].x()), y = from_face(all.points[i].y());
    if ((x > kMargin_m - 0.2 && x < kMargin_m + 0.2) || (y > kMargin_m - 0.2 && y < kMargin_m + 0.2)) continue;
    asked.points.push_back(all.points[i]);
    asked.directions.push_back(all.directions[i]);
  }
  ExpectSame(Query(*store_, asked), OneSample(fields_, asked, kStep_m, 0.0F, threads_), kStep_m, 500, true);
}

TEST_F(PointQueryTest, IsTheSampleOfARayInTheContractedContext) {
  const render::TrainedField& context = store_->context();
  Asked all = RandomPoints({-30.0, -20.0, 0.3}, {-2.0, 30.0, 3.7}, 400);
  // Steps are metres long here: level ones stay between the lower and the upper face.
  for (Eigen::Vector3d& direction : all.directions) direction = Eigen::Vector3d(direction.x(), direction.y(), 0.0).normalized();
  for (size_t i = 0; i < all.points.size(); ++i) {
    // A step is as long as the contraction at its start makes it; its depth is that of a step wherever it is.
    double step_m = kStep_m;
    for (int k = 0; k < 20; ++k) step_m = kStep_m / context.map.LocalScale(all.points[i] - 0.5 * step_m * all.directions[i]);
    const Asked one{{all.points[i]}, {all.directions[i]}};
    ExpectSame(Query(*store_, one), OneSample(fields_, one, step_m, 0.0F, threads_), kStep_m / context.map.LocalScale(all.points[i]), 0);
  }
  const std::vector<PointColor> found = Query(*store_, all);
  EXPECT_GT(std::count_if(found.begin(), found.end(), [](const PointColor& point) { return point.density > 0.0F; }), 50);
}

TEST_F(PointQueryTest, HasTheSameBitsWithLittleMemoryAndManyThreads) {
  const Asked asked = RandomPoints({-4.0, -4.0, -1.0}, {19.0, 14.0, 5.0}, 4000);
  const std::vector<PointColor> whole = Query(*store_, asked);
  FieldStore small = Open(store_->ContextBytes() + 1.5 * store_->Bytes(0));
  ASSERT_FALSE(small.AllFit());
  base::ThreadPool four(4);
  std::vector<PointColor> paged(asked.points.size());
  QueryPoints(small, *index_, asked.points, asked.directions, {}, paged, four);
  EXPECT_EQ(std::memcmp(whole.data(), paged.data(), whole.size() * sizeof(PointColor)), 0);
}

TEST_F(PointQueryTest, SaysNothingInFreeSpaceAndNowhere) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Asked asked{{{3.0, 3.0, 400.0}, {nan, 0.0, 0.0}, {1e9, 0.0, 1.0}}, {{0.0, 0.0, -1.0}}};
  const std::vector<PointColor> found = Query(*store_, asked);
  EXPECT_EQ(found[0].density, 0.0F);
  EXPECT_TRUE(std::isnan(found[0].rgb_srgb[0]));
  EXPECT_TRUE(std::isnan(found[1].density));
  EXPECT_EQ(found[2].density, 0.0F);
  const Asked inside = RandomPoints({1.0, 1.0, 0.3}, {14.0, 9.0, 3.7}, 100);
  const std::vector<PointColor> densities = Query(*store_, inside, {.colors = false}), colors = Query(*store_, inside);
  for (size_t i = 0; i < colors.size(); ++i) {
    EXPECT_EQ(densities[i].density, colors[i].density);
    EXPECT_TRUE(std::isnan(densities[i].rgb_srgb[0]));
  }
}

TEST(PointEvaluator, HasTheFootprintOfASampleOfARay) {
  base::ThreadPool threads(2);
  for (const int multisample : {1, 4, 6}) {
    render::TrainedField f = render::RandomField(3, {0.0, 0.0, 0.0}, {5.0, 5.0, 4.0}, 0.5, 1.0);
    f.config.multisample = multisample;
    f.BuildNetworks();
    f.footprint_min_m = 0.05;
    const Asked asked = RandomPoints({1.0, 1.0, 0.3}, {4.0, 4.0, 3.7}, 300);
    // Renderings of scenes take half a step; pixels that are wider have longer samples.
    for (const float width_m : {0.0F, 0.1F}) {
      const std::vector<render::RayColor> rays = OneSample({{&f}, nullptr}, asked, 0.5 * kStep_m, width_m, threads, 0.5);
      std::vector<render::QueryPoint> points;
      for (size_t i = 0; i < asked.points.size(); ++i) points.push_back({asked.points[i], asked.directions[i], static_cast<double>(width_m), 1.0});
      std::vector<render::PointSum> sums(points.size());
      render::PointEvaluator().Add(f, points, true, sums);
      std::vector<PointColor> found(points.size());
      for (size_t i = 0; i < sums.size(); ++i) {
        found[i].density = static_cast<float>(sums[i].density);
        for (size_t c = 0; c < 3; ++c) found[i].rgb_srgb[c] = static_cast<float>(sums[i].rgb_times_density[c] / sums[i].density);
      }
      SCOPED_TRACE(std::to_string(multisample) + " positions, " + std::to_string(width_m) + " m");
      ExpectSame(found, rays, 0.5 * kStep_m, 50);
    }
  }
}

}  // namespace
}  // namespace skyquilt::scene
