// Normals of rendered rays: what they are, and that nothing else changes with them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/render/density_normal.h"
#include "core/render/march.h"
#include "core/render/ray_engine.h"
#include "tests/core/render/rays_from_above.h"
#include "tests/support/random_field.h"

namespace skyquilt::render {
namespace {

using Eigen::Vector3d;

// Two blocks that are blended, and a context about them. The blocks have heads.
struct Town {
  TrainedField west = WithHead(RandomField(1, {0, 0, 0}, {5, 5, 4}, 0.8, -1.0), 5);
  TrainedField east = WithHead(RandomField(2, {5, 0, 0}, {10, 5, 6}, 0.8, -1.0), 6);
  TrainedField context = RandomField(3, {0, 0, 0}, {10, 5, 6}, 0.0, -3.0, true);
  FieldSet Set() const { return {{&west, &east}, &context}; }
};

std::vector<RayColor> Rendered(const FieldSet& set, const std::vector<Ray>& rays, bool normals, int n_threads = 1) {
  std::vector<RayColor> out(rays.size());
  base::ThreadPool threads(n_threads);
  RenderRays(set, rays, out, {.normals = normals}, threads);
  return out;
}

Vector3d ToVector(const float (&v)[3]) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}
Vector3d NormalOf(const RayColor& color) {
  return ToVector(color.density_normal);
}

bool SameBits(const RayColor& a, const RayColor& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

TEST(RayNormals, ChangeNothingElse) {
  const Town town;
  const std::vector<Ray> rays = RaysFromAbove(200);
  const std::vector<RayColor> without = Rendered(town.Set(), rays, false);
  std::vector<RayColor> with = Rendered(town.Set(), rays, true);
  int found = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(NormalOf(without[i]), Vector3d::Zero());
    if (NormalOf(with[i]) != Vector3d::Zero()) {
      ++found;
      EXPECT_NEAR(NormalOf(with[i]).norm(), 1.0, 1e-6);
    }
    EXPECT_EQ(ToVector(without[i].predicted_normal), Vector3d::Zero());
    std::fill_n(with[i].density_normal, 3, 0.0F);
    std::fill_n(with[i].predicted_normal, 3, 0.0F);
    EXPECT_TRUE(SameBits(with[i], without[i])) << i;
  }
  EXPECT_GT(found, 150);
}

TEST(RayNormals, AreMeansByWeightOverBlendedFields) {
  const Town town;
  FieldSet set = town.Set();
  set.context = nullptr;
  const std::vector<Ray> rays = RaysFromAbove(150);
  const std::vector<RayColor> out = Rendered(set, rays, true);
  int compared = 0, compared_predicted = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    struct Point {
      double t, tau;
      Vector3d normal, predicted;
    };
    std::vector<Point> points;
    for (size_t k = 0; k < 2; ++k) {
      const TrainedField& f = *set.blocks[k];
      March(f, rays[i].origin_enu, rays[i].direction_enu, FieldInterval(f.map, rays[i].origin_enu, rays[i].direction_enu), f.step_m, 0.5F,
            [&](double t, double length, double, int64_t) {
              const Vector3d p = rays[i].origin_enu + t * rays[i].direction_enu;
              const int all[2] = {0, 1};
              double blend[2];
              BlendWeights(set, all, p.x(), p.y(), blend);
              const Eigen::Vector3f x = f.map.UnitFromEnu(p);
              field::DensitySlope slope;
              f.field->DensityGradient(f.weights, f.parameters.grid, {&x[0], &x[1], &x[2]}, 1, slope);
              std::vector<float> geometry(size_t{field::kGeometryRows} * slope.stride);
              f.field->Density(f.weights, slope.features, slope.stride, kernel::kPad, slope.hidden, slope.stride, geometry.data(), slope.stride);
              std::vector<float> raw(size_t{field::kNormalRows} * slope.stride);
              f.field->PredictNormals(f.weights, geometry.data(), slope.stride, kernel::kPad, raw.data(), slope.stride);
              const Vector3d predicted(static_cast<double>(raw[0]), static_cast<double>(raw[slope.stride]),
                                       static_cast<double>(raw[2 * slope.stride]));
              const Vector3d gradient(static_cast<double>(slope.gradient[0]), static_cast<double>(slope.gradient[slope.stride]),
                                      static_cast<double>(slope.gradient[2 * slope.stride]));
              const double tau = std::exp(static_cast<double>(geometry[0]) + f.config.density_bias) * length / f.step_m * blend[k];
              points.push_back({t, tau, OutwardNormal<double>(gradient), predicted.normalized()});
              return true;
            });
    }
    std::stable_sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.t < b.t; });
    double transmittance = 1.0;
    Vector3d sum = Vector3d::Zero(), predicted = Vector3d::Zero();
    for (const Point& point : points) {
      const double after = transmittance * std::exp(-point.tau);
      sum += (transmittance - after) * point.normal;
      predicted += (transmittance - after) * point.predicted;
      transmittance = after;
    }
    // Samples of small weight have no normal, and rays end at 0.5 % transmittance.
    if (sum.norm() > 0.3) {
      EXPECT_LT((NormalOf(out[i]) - sum.normalized()).norm(), 0.03) << i;
      ++compared;
    }
    if (predicted.norm() > 0.3) {
      EXPECT_LT((ToVector(out[i].predicted_normal) - predicted.normalized()).norm(), 0.03) << i;
      ++compared_predicted;
    }
  }
  EXPECT_GT(compared, 20);
  EXPECT_GT(compared_predicted, 20);
}

TEST(RayNormals, HaveTheSameBitsWhereverARayIsCutAndForAnyThreads) {
  const Town town;
  const std::vector<Ray> rays = RaysFromAbove(300);
  const std::vector<RayColor> whole = Rendered(town.Set(), rays, true, 3);
  RayRenderer renderer(town.Set(), {.normals = true});
  std::vector<RayState> states(rays.size());
  base::Random random(11);
  std::vector<Window> first, second;
  for (size_t i = 0; i < rays.size(); ++i) {
    const double cut = random.Uniform(5.0, 15.0);
    first.push_back({0.0, cut});
    second.push_back({.from = cut});
  }
  renderer.Continue(rays, first, states);
  renderer.Continue(rays, second, states);
  for (size_t i = 0; i < rays.size(); ++i) {
    const RayColor color = FinalColor(states[i]);
    EXPECT_TRUE(SameBits(color, whole[i])) << i;
  }
}

TEST(RayNormals, NeedASlope) {
  const TrainedField f = RandomField(1, {0, 0, 0}, {5, 5, 4}, 0.8, 0.0, false, encoding::Kind::kFrequency);
  FieldSet set;
  set.blocks = {&f};
  EXPECT_THROW(Rendered(set, RaysFromAbove(50), true), base::UsageError);
}

}  // namespace
}  // namespace skyquilt::render
