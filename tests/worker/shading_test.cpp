// Shading of photos in training: from tie points, by gradients, and what it is worth.
#include "core/brightness/shading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/brightness/exposure.h"
#include "tests/support/gradient_check.h"
#include "tests/worker/small_survey.h"
#include "worker/losses/photo_loss.h"
#include "worker/rays/ray_source.h"
#include "worker/start/tie_point_gains.h"
#include "worker/step/ray_loss.h"

namespace skyquilt::worker {
namespace {

constexpr brightness::ShadingGrid kKnots = {4, 3};

class ShadingTest : public SmallSurvey {
 protected:
  // Stops by which photo i is darker or brighter at a place: the edge of a shadow in another direction in every photo, no light lost on the whole.
  static double TrueStops(int photo, double u, double v) {
    return 0.8 * std::sin(2.1 * photo) * (u - 0.5) * 2.0 + 0.6 * std::cos(1.3 * photo) * (v - 0.5) * 2.0;
  }
  void Shade() {
    std::vector<image::PixelSource> sources;
    for (size_t i = 0; i < survey_.photos.size(); ++i) {
      image::Image8 picture = image::LoadRgb8(folder_ / survey_.photos[i].name);
      for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x) {
          const double factor = 0.5 * std::exp2(TrueStops(static_cast<int>(i), (x + 0.5) / picture.width, (y + 0.5) / picture.height));
          for (int c = 0; c < 3; ++c) {
            uint8_t& value = picture.At(x, y)[c];
            const float light = static_cast<float>(factor) * image::LinearFromSrgb(static_cast<float>(value) / 255.0F);
            value = static_cast<uint8_t>(std::lround(255.0F * std::clamp(image::SrgbFromLinear(light), 0.0F, 1.0F)));
          }
        }
      }
      const std::filesystem::path file = folder_ / ("shaded_" + survey_.photos[i].name);
      image::SavePng(picture, file);
      sources.push_back({file, {}});
    }
    base::ThreadPool threads(1);
    pixels_ = std::make_unique<image::PixelCache>(image::PixelCache::Open(folder_ / "shaded.bin", sources, 0, threads));
  }
  void AddGroundPoints() {
    for (double x = -24.5; x <= 25.0; x += 1.0) {
      for (double y = -24.5; y <= 25.0; y += 1.0) {
        if (std::abs(x) < 6.0 && std::abs(y) < 6.0) continue;  // the box and what it hides
        survey_.points.emplace_back();
        survey_.points.back().x_in_enu = {x, y, 0.0};
      }
    }
  }
  TrainJob Shaded(const std::string& name, int steps) const {
    TrainJob job = Job(name, steps);
    job.response.AddShading(kKnots, 0.5F);
    job.learn.shading = {kKnots, {}, 0.5F};
    for (size_t i = 0; i < survey_.photos.size(); ++i) {
      job.learn.shading.learns.push_back(survey_.photos[i].is_test ? 0 : 1);
      job.learn.learns_gain[i] = job.learn.shading.learns.back();
    }
    return job;
  }
  // Root mean square error of shading in stops over training photos and places, and that of no shading; both without what the projection takes out.
  std::pair<double, double> RmsStops(const brightness::Response& response) const {
    brightness::Response truth = response;
    std::vector<uint8_t> learns;
    for (size_t i = 0; i < survey_.photos.size(); ++i) {
      learns.push_back(survey_.photos[i].is_test ? 0 : 1);
      for (size_t k = 0; k < kKnots.knots(); ++k) {
        const double u = static_cast<double>(k % 4) / 3.0, v = static_cast<double>(k / 4) / 2.0;
        truth.shading[i * kKnots.knots() + k] = static_cast<float>(std::numbers::ln2 * TrueStops(static_cast<int>(i), u, v));
      }
    }
    brightness::CentreShading(kKnots, learns, truth.shading);
    double error = 0.0, all = 0.0, n = 0.0;
    for (size_t i = 0; i < truth.shading.size(); ++i) {
      if (learns[i / kKnots.knots()] == 0) continue;
      error += std::pow(static_cast<double>(response.shading[i] - truth.shading[i]) / std::numbers::ln2, 2);
      all += std::pow(static_cast<double>(truth.shading[i]) / std::numbers::ln2, 2);
      n += 1.0;
    }
    return {std::sqrt(error / n), std::sqrt(all / n)};
  }
};

TEST_F(ShadingTest, TiePointsGiveTheShading) {
  Shade();
  AddGroundPoints();
  const TrainJob job = Shaded("context.h5", 1);
  brightness::Response response = job.response;
  const RaySource source(survey_, *pixels_, response);
  base::ThreadPool threads(2);
  const KnownFromTiePoints known = GainsFromTiePoints(survey_, *pixels_, source, job.learn, response, threads);
  EXPECT_TRUE(known.gains);
  EXPECT_TRUE(known.shading);
  const auto [error, all] = RmsStops(response);
  EXPECT_GT(all, 0.4);
  // Light that bends over the whole survey cannot be told from shadings that change evenly from photo to photo: there the prior decides.
  EXPECT_LT(error, 0.4 * all);
  for (size_t k = 0; k < kKnots.knots(); ++k) EXPECT_EQ(response.shading[k], 0.0F);  // photo 0 is held out
}

TEST_F(ShadingTest, WithoutPointsTrainingLearnsItAndTheSceneIsBetter) {
  Shade();
  base::ThreadPool threads(2);
  TrainJob off = Shaded("off.h5", 300);
  off.learn.shading = {};
  off.response = brightness::Response::Neutral(survey_.photos.size(), 1);
  const TrainResult without = TrainContext(off, Box(20.0, 2.0), threads, {});
  const TrainResult with = TrainContext(Shaded("context.h5", 300), Box(20.0, 2.0), threads, {});
  EXPECT_GT(with.final_psnr_db, without.final_psnr_db + 2.0);
  const auto [error, all] = RmsStops(LoadContext(folder_ / "context.h5").response);
  EXPECT_LT(error, 0.5 * all);
}

TEST_F(ShadingTest, ResumesWithTheSameBits) {
  Shade();
  base::ThreadPool threads(1);
  TrainContext(Shaded("whole.h5", 60), Box(20.0, 2.0), threads, {});
  TrainInterrupted(Shaded("context.h5", 60), [&](const TrainJob& job) { TrainContext(job, Box(20.0, 2.0), threads, {}); });
  EXPECT_EQ(LoadContext(folder_ / "context.h5").response.shading, LoadContext(folder_ / "whole.h5").response.shading);
  EXPECT_EQ(Bytes("context.h5"), Bytes("whole.h5"));
}

TEST(ShadingGradient, AgreesWithDifferencesInDouble) {
  constexpr int kPixels = 12;
  brightness::Response response = brightness::Response::Neutral(1, 1);
  response.AddShading(kKnots, 0.5F);
  for (size_t k = 0; k < kKnots.knots(); ++k) response.shading[k] = 0.3F * std::sin(static_cast<float>(k));
  brightness::LearnerOptions options;
  options.learns_gain = {0};
  options.shading = {kKnots, {1}, 0.5F};
  brightness::ResponseLearner learner(response, options);
  const auto place = [](int i) { return brightness::PicturePlace{static_cast<float>(i % 5) / 4.3F, static_cast<float>(i % 7) / 6.2F}; };
  const auto shown = [](int i, size_t c) { return 0.3F + 0.04F * static_cast<float>(i) + 0.05F * static_cast<float>(c); };
  const auto wanted = [](int i, size_t c) { return 0.5F + 0.2F * std::sin(static_cast<float>(3 * i) + static_cast<float>(c)); };
  for (int i = 0; i < kPixels; ++i) {
    BatchRay ray;
    ComposedRay composed;
    composed.transmittance = 0.0F;
    ray.ray.exposure = response.ExposureOf(0, 0.0F, place(i));
    for (size_t c = 0; c < 3; ++c) {
      composed.rgb[c] = shown(i, c);
      ray.ray.target_srgb[c] = wanted(i, c);
    }
    LossSums sums;
    const ComposedGradient gradient = LossOfRay(ray, RayView{}, composed, 1.0F / kPixels, sums);
    learner.shading().Add(0, place(i), gradient.log_gain[0] + gradient.log_gain[1] + gradient.log_gain[2], 1.0F / kPixels);
  }
  // The same loss in double: sRGB is a power law here.
  const auto value = [&](const std::vector<double>& knots) {
    double sum = 0.0;
    for (int i = 0; i < kPixels; ++i) {
      const brightness::KnotWeights at = brightness::KnotsAt(kKnots, place(i));
      double log_gain = 0.0;
      for (size_t j = 0; j < 4; ++j) log_gain += static_cast<double>(at.weight[j]) * knots[at.knot[j]];
      for (size_t c = 0; c < 3; ++c) {
        const double root = std::exp(log_gain / 2.4);
        const double seen = root * (static_cast<double>(shown(i, c)) + 0.055) - 0.055;
        sum += SquaredPhotoLoss(seen, static_cast<double>(wanted(i, c))).value / kPixels;
      }
    }
    return sum;
  };
  const std::vector<double> knots(response.shading.begin(), response.shading.end());
  testing::ExpectGradient(value, knots, learner.shading().gradient(), 1e-5);
}

}  // namespace
}  // namespace skyquilt::worker
