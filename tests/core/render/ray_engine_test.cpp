// Fields with random parameters: the engine, which composites in rounds, agrees with a simple loop along the ray.
#include "core/render/ray_engine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/render/march.h"
#include "tests/core/render/rays_from_above.h"
#include "tests/support/random_field.h"

namespace skyquilt::render {
namespace {

struct Plain {
  double rgb[3] = {0, 0, 0};
  double transmittance = 1.0;
};

// Of one marching step, from row 0 of the geometry (core/field/density_activation.h).
double StepTau(double raw, const field::FieldConfig& config) {
  const double start = std::exp(config.density_bias);
  if (config.density_activation == field::DensityActivation::kSoftplus) return std::log1p(std::exp(raw) * std::expm1(start));
  if (config.density_activation == field::DensityActivation::kRelu) return std::max(0.0, raw + start);
  return std::exp(raw) * start;
}

// The simple loop: one sample after the other, in order of distance.
Plain WalkPlainly(const FieldSet& set, const Ray& ray) {
  struct Point {
    double t, length, weight;
    const TrainedField* f;
  };
  std::vector<Point> points;
  std::vector<int> all(set.blocks.size());
  for (size_t k = 0; k < all.size(); ++k) all[k] = static_cast<int>(k);
  std::vector<double> weights(all.size());
  for (size_t k = 0; k < all.size(); ++k) {
    const TrainedField& f = *set.blocks[k];
    March(f, ray.origin_enu, ray.direction_enu, FieldInterval(f.map, ray.origin_enu, ray.direction_enu), f.step_m, 0.5F,
          [&](double t, double length, double, int64_t) {
            const Eigen::Vector3d p = ray.origin_enu + t * ray.direction_enu;
            BlendWeights(set, all, p.x(), p.y(), weights);
            points.push_back({t, length / f.step_m, weights[k], &f});
            return true;
          });
  }
  std::stable_sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.t < b.t; });
  Plain result;
  for (const Point& point : points) {
    const TrainedField& f = *point.f;
    const Eigen::Vector3f x = f.map.UnitFromEnu(ray.origin_enu + point.t * ray.direction_enu);
    field::Activations a;
    a.Reserve(*f.field, kernel::kPad);
    std::vector<float> features(static_cast<size_t>(f.field->FeatureRows()) * kernel::kPad, 0.0F);
    f.field->EncodeSerial(f.parameters.grid, {&x.x(), &x.y(), &x.z()}, 1, features.data(), kernel::kPad);
    f.field->Density(f.weights, features.data(), kernel::kPad, kernel::kPad, a.density_hidden, a.stride, a.geometry(), a.stride);
    const Eigen::Vector3f d = ray.direction_enu.cast<float>();
    f.field->EncodeDirection(d.data(), 1, a.color_in + static_cast<size_t>(field::kGeometryRows) * a.stride, a.stride);
    f.field->Color(f.weights, a.color_in, a.stride, kernel::kPad, a.color_hidden, a.stride, a.color_raw, a.stride);
    const double tau = StepTau(static_cast<double>(a.geometry()[0]), f.config) * point.length * point.weight;
    const double after = result.transmittance * std::exp(-tau);
    for (size_t c = 0; c < 3; ++c) {
      const double raw = static_cast<double>(a.color_raw[c * a.stride]);
      result.rgb[c] += (result.transmittance - after) * f.config.color_range / (1.0 + std::exp(-raw));
    }
    result.transmittance = after;
  }
  return result;
}

struct Matter {
  double density_bias;
  encoding::Kind encoding;
  int density_hidden_layers;
  field::DensityActivation activation = field::DensityActivation::kExp;
};

class RayEngine : public ::testing::TestWithParam<Matter> {};

TEST_P(RayEngine, AgreesWithASimpleLoopThroughBlendedBlocks) {
  const auto [density_bias, encoding, density_hidden_layers, activation] = GetParam();
  TrainedField west = RandomField(1, {0, 0, 0}, {5, 5, 4}, 0.8, density_bias, false, encoding, density_hidden_layers);
  west.config.density_activation = activation;
  west.BuildNetworks();
  const TrainedField east = RandomField(2, {5, 0, 0}, {10, 5, 6}, 0.8, density_bias);
  FieldSet set;
  set.blocks = {&west, &east};
  const std::vector<Ray> rays = RaysFromAbove(150);
  std::vector<RayColor> out(rays.size());
  base::ThreadPool threads(2);
  int64_t samples = 0;
  RenderRays(set, rays, out, {}, threads, &samples);
  int dark = 0, clear = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const Plain plain = WalkPlainly(set, rays[i]);
    // A ray that ends early leaves out at most 0.5 % of its light and counts as opaque.
    const bool ended = plain.transmittance < 5e-3;
    const double tolerance = ended ? 6e-3 : 5e-4;
    EXPECT_NEAR(static_cast<double>(out[i].opacity), ended ? 1.0 : 1.0 - plain.transmittance, tolerance) << i;
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(static_cast<double>(out[i].rgb_srgb[c]), plain.rgb[c], tolerance) << i;
    dark += ended ? 1 : 0;
    clear += plain.transmittance > 0.5 ? 1 : 0;
  }
  if (density_bias > -1.0) {
    EXPECT_GT(dark, 20);
  } else {
    EXPECT_GT(clear, 20);
  }
  EXPECT_GT(samples, 100);
}

INSTANTIATE_TEST_SUITE_P(ThinAndDense, RayEngine,
                         ::testing::Values(Matter{-4.0, encoding::Kind::kHash, 1}, Matter{0.0, encoding::Kind::kHash, 1},
                                           Matter{0.0, encoding::Kind::kHash, 3}, Matter{0.0, encoding::Kind::kVoxels, 1},
                                           Matter{0.0, encoding::Kind::kPlanes, 1}, Matter{0.0, encoding::Kind::kFrequency, 2},
                                           Matter{0.0, encoding::Kind::kHash, 1, field::DensityActivation::kSoftplus},
                                           Matter{-4.0, encoding::Kind::kHash, 1, field::DensityActivation::kSoftplus},
                                           Matter{0.0, encoding::Kind::kHash, 1, field::DensityActivation::kRelu}));

// A field that was trained with codes renders as its networks without the inputs for codes.
TEST(RayEngineWork, FieldsWithCodesShowTheCodeOfZeros) {
  const TrainedField plain = RandomField(1, {0, 0, 0}, {10, 5, 6}, 0.5, 0.0);
  TrainedField coded = RandomField(1, {0, 0, 0}, {10, 5, 6}, 0.5, 0.0);
  coded.config.appearance = 5;
  const field::HashField& shape = *plain.field;
  const auto hidden = static_cast<size_t>(shape.config().hidden), inputs = static_cast<size_t>(shape.ColorInputRows());
  // Before the colour network: the density network's two layers.
  const size_t first = hidden * static_cast<size_t>(shape.FeatureRows()) + field::kGeometryRows * hidden;
  for (size_t row = hidden; row > 0; --row) {
    const auto end = coded.parameters.networks.begin() + static_cast<std::ptrdiff_t>(first + row * inputs);
    coded.parameters.networks.insert(end, static_cast<size_t>(kernel::PaddedRows(5)), 3.0F);
  }
  coded.BuildNetworks();
  FieldSet with, without;
  with.blocks = {&coded};
  without.blocks = {&plain};
  const std::vector<Ray> rays = RaysFromAbove(200);
  std::vector<RayColor> seen(rays.size()), expected(rays.size());
  base::ThreadPool threads(1);
  RenderRays(with, rays, seen, {}, threads);
  RenderRays(without, rays, expected, {}, threads);
  for (size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(seen[i].opacity, expected[i].opacity);
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(seen[i].rgb_srgb[c], expected[i].rgb_srgb[c], 1e-6F) << i;
  }
}

TEST(RayEngineWork, SamplesBehindSurfacesAreSkipped) {
  base::ThreadPool threads(1);
  const std::vector<Ray> rays = RaysFromAbove(300);
  std::vector<RayColor> out(rays.size());
  int64_t thin = 0, dense = 0;
  for (const bool opaque : {false, true}) {
    const TrainedField f = RandomField(1, {0, 0, 0}, {10, 5, 6}, 0.5, opaque ? 4.0 : -9.0);
    FieldSet set;
    set.blocks = {&f};
    RenderRays(set, rays, out, {}, threads, opaque ? &dense : &thin);
  }
  EXPECT_LT(3 * dense, 2 * thin);
}

TEST(RayEngineWork, DepthsAloneAreTheSameWithFewerSamples) {
  base::ThreadPool threads(2);
  const std::vector<Ray> rays = RaysFromAbove(300);
  int passed = 0;
  for (const double bias : {-4.0, 0.0, 2.0}) {
    const TrainedField f = RandomField(3, {0, 0, 0}, {10, 5, 6}, 0.5, bias);
    FieldSet set;
    set.blocks = {&f};
    std::vector<RayColor> whole(rays.size()), depths(rays.size());
    int64_t whole_samples = 0, depth_samples = 0;
    RenderRays(set, rays, whole, {}, threads, &whole_samples);
    RenderRays(set, rays, depths, EngineOptions::DepthsOnly(0.9), threads, &depth_samples);
    EXPECT_LE(depth_samples, whole_samples);
    const auto same = [](float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    for (size_t i = 0; i < rays.size(); ++i) {
      EXPECT_TRUE(same(depths[i].depth_front, whole[i].depth_front));
      EXPECT_TRUE(same(depths[i].depth_median, whole[i].depth_median));
      EXPECT_TRUE(same(depths[i].depth_back, whole[i].depth_back));
      EXPECT_EQ(depths[i].opacity >= 0.9F, whole[i].opacity >= 0.9F);
      EXPECT_EQ(depths[i].rgb_srgb[0], 0.0F);
      passed += std::isfinite(depths[i].depth_back) ? 1 : 0;
    }
  }
  EXPECT_GT(passed, 100);
}

TEST(RayEngineWork, WiderPixelsTakeFewerSamplesOfTheSameDensity) {
  base::ThreadPool threads(1);
  const TrainedField f = RandomField(4, {0, 0, 0}, {10, 5, 6}, 0.5, -2.0);
  FieldSet set;
  set.blocks = {&f};
  std::vector<Ray> rays = RaysFromAbove(300);
  std::vector<RayColor> fine(rays.size()), coarse(rays.size());
  int64_t fine_samples = 0, coarse_samples = 0;
  RenderRays(set, rays, fine, {}, threads, &fine_samples);
  for (Ray& ray : rays) ray.pixel_pitch = 0.04F;  // 0.3 m wide at 8 m: steps of 1.4 m
  RenderRays(set, rays, coarse, {}, threads, &coarse_samples);
  EXPECT_LT(2 * coarse_samples, fine_samples);
  double difference = 0.0;
  for (size_t i = 0; i < rays.size(); ++i) difference += std::abs(static_cast<double>(fine[i].opacity - coarse[i].opacity));
  EXPECT_LT(difference / static_cast<double>(rays.size()), 0.1);
}

TEST(RayEngineWork, OnlyTheContextIsRenderedOutsideAllBlocks) {
  base::ThreadPool threads(1);
  const TrainedField block = RandomField(1, {0, 0, 0}, {5, 5, 4}, 0.5, -1.0);
  const TrainedField context = RandomField(5, {-10, -10, 0}, {20, 20, 6}, 0.0, -2.0);
  FieldSet both, alone, only_block;
  both.blocks = only_block.blocks = {&block};
  both.context = alone.context = &context;
  Ray outside, inside;
  outside.origin_enu = {15.0, 15.0, 20.0};
  inside.origin_enu = {2.5, 2.5, 20.0};
  outside.direction_enu = inside.direction_enu = {0.0, 0.0, -1.0};
  const std::vector<Ray> rays = {outside, inside};
  std::vector<RayColor> with(2), without(2), plain(2);
  RenderRays(both, rays, with, {}, threads);
  RenderRays(alone, rays, without, {}, threads);
  RenderRays(only_block, rays, plain, {}, threads);
  for (size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(with[0].rgb_srgb[c], without[0].rgb_srgb[c]);
    EXPECT_EQ(with[1].rgb_srgb[c], plain[1].rgb_srgb[c]) << "in a block's core the context is not rendered";
  }
  EXPECT_GT(with[0].opacity, 0.01F);
  EXPECT_EQ(plain[0].opacity, 0.0F);
}

}  // namespace
}  // namespace skyquilt::render
