// Rays that are cones or columns, through fields whose samples have footprints.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/base/random.h"
#include "core/render/footprint.h"
#include "core/render/ray_engine.h"
#include "tests/core/render/rays_from_above.h"
#include "tests/support/random_field.h"

namespace skyquilt::render {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

bool SameColor(const RayColor& a, const RayColor& b) {
  using Bits = std::array<uint32_t, sizeof(RayColor) / sizeof(float)>;  // NaN depths are the same too
  return std::bit_cast<Bits>(a) == std::bit_cast<Bits>(b);
}

TrainedField Coned(TrainedField f, double min_m, double max_m, int multisample = 1) {
  f.config.multisample = multisample;
  f.footprint_min_m = min_m;
  f.footprint_max_m = max_m;
  f.BuildNetworks();
  return f;
}

// Two blocks that overlap, voxels of 0.2 m, in a contracted context.
class Cones : public ::testing::Test {
 protected:
  void Load(bool cones, double min_m = 0.0, double max_m = kEndless, int multisample = 1) {
    west_ = RandomField(1, {0, 0, 0}, {5, 5, 4}, 0.8, -2.0);
    east_ = RandomField(2, {5, 0, 0}, {10, 5, 6}, 0.8, -2.0);
    around_ = RandomField(5, {-10, -10, 0}, {20, 20, 6}, 0.0, -3.0, true);
    if (cones) {
      for (TrainedField* f : {&west_, &east_, &around_}) *f = Coned(std::move(*f), min_m, max_m, multisample);
    }
    fields_.blocks = {&west_, &east_};
    fields_.context = &around_;
  }
  std::vector<RayColor> Rendered(const std::vector<Ray>& rays, const EngineOptions& options = {}, int64_t* samples = nullptr) {
    std::vector<RayColor> out(rays.size());
    RenderRays(fields_, rays, out, options, threads_, samples);
    return out;
  }
  static std::vector<Ray> Rays(int n, float pitch, float width) {
    std::vector<Ray> rays = RaysFromAbove(n);
    for (Ray& ray : rays) {
      ray.pixel_pitch = pitch;
      ray.pixel_width = width;
    }
    return rays;
  }
  static int Different(const std::vector<RayColor>& a, const std::vector<RayColor>& b) {
    int different = 0;
    for (size_t i = 0; i < a.size(); ++i) different += SameColor(a[i], b[i]) ? 0 : 1;
    return different;
  }

  base::ThreadPool threads_{2};
  TrainedField west_, east_, around_;
  FieldSet fields_;
};

TEST_F(Cones, OfNoWidthRenderTheBitsOfPoints) {
  const std::vector<Ray> rays = Rays(150, 0.0F, 0.0F);
  Load(false);
  const std::vector<RayColor> points = Rendered(rays);
  Load(true);
  EXPECT_EQ(Different(Rendered(rays), points), 0);
  EXPECT_GT(Different(Rendered(Rays(150, 0.0F, 0.2F)), points), 40) << "columns as wide as a voxel";
}

TEST_F(Cones, FieldsOfPointsTakeNoNoticeOfColumns) {
  Load(false);
  EXPECT_EQ(Different(Rendered(Rays(100, 0.0F, 0.3F)), Rendered(Rays(100, 0.0F, 0.0F))), 0);
}

class ConesOf : public Cones, public ::testing::WithParamInterface<int> {};

INSTANTIATE_TEST_SUITE_P(Positions, ConesOf, ::testing::Values(1, 4, 6));

TEST_P(ConesOf, CutAnywhereGiveTheSameBits) {
  Load(true, 0.02, 2.0, GetParam());
  std::vector<Ray> rays = Rays(200, 0.0F, 0.0F);
  base::Random random(8);
  for (Ray& ray : rays) {
    ray.pixel_pitch = 0.06F * random.Uniform();
    ray.pixel_width = 0.2F * random.Uniform();
  }
  const std::vector<RayColor> whole = Rendered(rays);
  RayRenderer renderer(fields_, {});
  std::vector<RayState> states(rays.size());
  std::vector<Window> windows(rays.size());
  constexpr int kPieces = 7;
  for (int piece = 0; piece < kPieces; ++piece) {
    for (Window& window : windows) {
      window.from = piece == 0 ? 0.0 : window.to;
      window.to = piece + 1 == kPieces ? kEndless : window.from + random.Uniform(0.0, 5.0);
    }
    renderer.Continue(rays, windows, states);
  }
  int visible = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    EXPECT_TRUE(SameColor(FinalColor(states[i]), whole[i])) << i;
    visible += whole[i].opacity > 0.1F ? 1 : 0;
  }
  EXPECT_GT(visible, 60);
}

TEST_F(Cones, NarrowerThanTrainedRenderAsTheNarrowest) {
  const std::vector<Ray> lines = Rays(150, 0.0F, 0.0F), narrow = Rays(150, 0.0F, 0.02F), narrowest = Rays(150, 0.0F, 0.05F);
  Load(true, static_cast<double>(0.05F), 2.0);
  const std::vector<RayColor> expected = Rendered(narrowest);
  EXPECT_EQ(Different(Rendered(lines), expected), 0);
  EXPECT_EQ(Different(Rendered(narrow), expected), 0);
  // At 0.15 m the steps are longer than the field's own, so that the range's end has to be reached with equal steps.
  const EngineOptions long_steps{.step_scale = 4.0};
  Load(true, static_cast<double>(0.15F), 2.0);
  const std::vector<RayColor> at_end = Rendered(Rays(150, 0.0F, 0.15F), long_steps);
  EXPECT_EQ(Different(Rendered(lines, long_steps), at_end), 0);
  Load(true);
  EXPECT_GT(Different(Rendered(lines, long_steps), at_end), 30);
}

TEST_F(Cones, WiderThanTrainedRenderAsTheWidest) {
  // All steps have the length that the widest rays ask for.
  const EngineOptions long_steps{.step_scale = 12.0};
  const std::vector<Ray> wide = Rays(150, 0.0F, 0.6F), widest = Rays(150, 0.0F, 0.3F);
  Load(true, 0.0, static_cast<double>(0.3F));
  const std::vector<RayColor> expected = Rendered(widest, long_steps);
  EXPECT_EQ(Different(Rendered(wide, long_steps), expected), 0);
  Load(true);
  EXPECT_EQ(Different(Rendered(widest, long_steps), expected), 0);
  EXPECT_GT(Different(Rendered(wide, long_steps), expected), 60);
}

// Alone, together and in another order, on any number of threads: where positions lie must depend on the ray only.
TEST_P(ConesOf, AloneGiveTheSameBitsAsTogether) {
  Load(true, 0.02, 2.0, GetParam());
  const std::vector<Ray> rays = Rays(60, 0.01F, 0.05F);
  const std::vector<RayColor> together = Rendered(rays);
  for (size_t i = 0; i < rays.size(); ++i) {
    ASSERT_TRUE(SameColor(Rendered({rays[i]}).front(), together[i])) << i;
  }
}

TEST_F(Cones, OfSeveralPositionsSeeWhatIsBesideTheirAxis) {
  const std::vector<Ray> columns = Rays(60, 0.0F, 0.4F);
  Load(true);
  const std::vector<RayColor> one = Rendered(columns);
  for (const int points : {4, 6}) {
    Load(true, 0.0, kEndless, points);
    EXPECT_GT(Different(Rendered(columns), one), 40) << points;
  }
}

TEST_F(Cones, LargerPixelsTakeFewerSamples) {
  Load(true);
  const auto samples = [&](float pitch, float width) {
    int64_t n = 0;
    Rendered(Rays(300, pitch, width), {}, &n);
    return n;
  };
  const int64_t of_lines = samples(0.0F, 0.0F);
  int64_t before = of_lines;
  for (const float pitch : {0.045F, 0.09F, 0.18F, 0.36F}) {
    const int64_t here = samples(pitch, 0.0F);
    EXPECT_LT(here, before) << pitch;
    before = here;
  }
  EXPECT_LT(4 * before, of_lines);
  EXPECT_LT(2 * samples(0.0F, 1.35F), of_lines) << "columns";
}

// Rays from far above or outside: steps become longer than the whole field is high, which must not make it disappear.
TEST_F(Cones, LongStepsKeepTheOpacityOfBlocksAndContexts) {
  const std::vector<Ray> rays = Rays(400, 0.0F, 0.0F);
  for (const bool contracted : {false, true}) {
    const TrainedField field = RandomField(5, {-10, -10, 0}, {20, 20, 6}, 0.0, -3.0, contracted);
    FieldSet set;
    (contracted ? set.context : set.blocks.emplace_back()) = &field;
    const auto mean_opacity = [&](double step_scale) {
      std::vector<RayColor> out(rays.size());
      RenderRays(set, rays, out, {.step_scale = step_scale}, threads_);
      double sum = 0.0;
      for (const RayColor& color : out) sum += static_cast<double>(color.opacity);
      return sum / static_cast<double>(out.size());
    };
    const double fine = mean_opacity(1.0);
    EXPECT_GT(fine, 0.2);
    for (const double step_scale : {3.0, 10.0, 30.0, 1000.0}) EXPECT_NEAR(mean_opacity(step_scale) / fine, 1.0, 0.06) << contracted << step_scale;
  }
}

TEST_P(ConesOf, OfAnyWidthRenderFinitely) {
  Load(true, 0.0, kEndless, GetParam());
  for (const float width : {1e-30F, 1e-6F, 1.0F, 1e6F, 1e30F, std::numeric_limits<float>::infinity()}) {
    for (const RayColor& color : Rendered(Rays(60, 0.0F, width))) {
      ASSERT_TRUE(std::isfinite(color.rgb_srgb[0]) && std::isfinite(color.opacity)) << width;
    }
  }
}

TEST(Footprint, OfARayIsItsWidthAndPitchTimesDistance) {
  Ray ray;
  EXPECT_EQ(ray.Footprint(50.0), 0.0);
  ray.pixel_width = 0.25F;
  ray.pixel_pitch = 0.5F;
  EXPECT_EQ(ray.Footprint(10.0), 5.25);
}

// A square of width w has the variance w^2 / 12 along an axis, and Positions::sharpness is 1 / (sqrt(8) s).
TEST(Footprint, HasTheVarianceOfASquareOfItsWidth) {
  const double width_m = 0.4, units_per_metre = 1.0 / 30.0;
  const double deviation = width_m * units_per_metre / std::sqrt(12.0);
  EXPECT_NEAR(static_cast<double>(SharpnessOf(width_m, units_per_metre, 1)), 1.0 / (std::sqrt(8.0) * deviation), 1e-5);
  // Each of several positions stands for a part of it, of half the variance.
  for (const int points : {4, 6}) {
    EXPECT_NEAR(static_cast<double>(SharpnessOf(width_m, units_per_metre, points)), 1.0 / (std::sqrt(4.0) * deviation), 1e-5);
  }
  for (const int points : {1, 4, 6}) {
    EXPECT_EQ(SharpnessOf(0.0, units_per_metre, points), std::numeric_limits<float>::infinity());
    EXPECT_EQ(SharpnessOf(kEndless, units_per_metre, points), 0.0F);
  }
}

}  // namespace
}  // namespace skyquilt::render
