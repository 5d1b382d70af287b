// Learning brightness together with a field: gains, vignetting and concealing field, on photos with known ones and on nearly useless photos.
#include <gtest/gtest.h>

#include <cmath>

#include "core/image/srgb.h"
#include "core/scene/field_file.h"
#include "tests/worker/small_survey.h"
#include "worker/block_session.h"
#include "worker/start/tie_point_gains.h"

namespace skyquilt::worker {
namespace {

namespace fs = std::filesystem;
using brightness::LuminanceMode;

double Exposed(double display, double gain) {
  return static_cast<double>(image::SrgbFromLinear(static_cast<float>(gain) * image::LinearFromSrgb(static_cast<float>(display))));
}

// Exposure of photo i in stops: jumps between photos, up to +-1.2.
double Stops(int photo) {
  return 1.2 * std::sin(2.4 * photo);
}

class BrightnessTest : public SmallSurvey {
 protected:
  void AddGroundPoints() {
    for (double x = -28.0; x < 28.0; x += 1.5) {
      for (double y = -28.0; y < 28.0; y += 1.5) {
        if (std::abs(x) < 5.0 && std::abs(y) < 5.0) continue;
        survey_.points.emplace_back();
        survey_.points.back().x_in_enu = {x, y, 0.0};
      }
    }
  }
  TrainJob Learning(const std::string& name, int steps, bool vignetting) const {
    TrainJob job = Job(name, steps);
    for (size_t i = 0; i < survey_.photos.size(); ++i) job.learn.learns_gain[i] = survey_.photos[i].is_test ? 0 : 1;
    job.learn.vignetting = vignetting;
    return job;
  }
  TrainJob JobWithLight(LuminanceMode mode, double start_log_gain, int steps) const {
    TrainJob job = Job("context.h5", steps);
    job.luminance.mode = mode;
    job.luminance.start_log_gain = start_log_gain;
    return job;
  }
  // The response estimated from tie points; *complete: result of GainsFromTiePoints, may be null.
  brightness::Response FromTiePoints(const TrainJob& job, bool* complete = nullptr) const {
    brightness::Response response = job.response;
    const RaySource source(survey_, *pixels_, response);
    base::ThreadPool threads(2);
    const bool known = GainsFromTiePoints(survey_, *pixels_, source, job.learn, response, threads).gains;
    if (complete != nullptr) *complete = known;
    return response;
  }
  // Root mean square error of the training photos' gains in stops, after subtracting the mean error.
  double RmsStops(const brightness::Response& response, const std::function<double(int, int)>& truth_stops) const {
    double squares = 0.0, n = 0.0;
    for (int c = 0; c < 3; ++c) {
      double mean = 0.0, count = 0.0;
      const auto error = [&](size_t i) {
        return static_cast<double>(response.log_gain[3 * i + static_cast<size_t>(c)]) / std::log(2.0) - truth_stops(static_cast<int>(i), c);
      };
      for (size_t i = 0; i < survey_.photos.size(); ++i) {
        if (survey_.photos[i].is_test) continue;
        mean += error(i);
        count += 1.0;
      }
      for (size_t i = 0; i < survey_.photos.size(); ++i) {
        if (survey_.photos[i].is_test) continue;
        squares += std::pow(error(i) - mean / count, 2);
        n += 1.0;
      }
    }
    return std::sqrt(squares / n);
  }
  // Rays straight down from 30 m, a metre apart, over a square in the middle of the survey.
  static std::vector<render::Ray> RaysDown(double reach_m) {
    std::vector<render::Ray> rays;
    for (double x = -reach_m; x <= reach_m; x += 1.0) {
      for (double y = -reach_m; y <= reach_m; y += 1.0) rays.push_back({{x, y, 30.0}, {0.0, 0.0, -1.0}});
    }
    return rays;
  }
  // Mean display value of the middle of the survey in one of the two renderings.
  double MeanShown(const LoadedContext& context, bool concealed, base::ThreadPool& threads) const {
    render::FieldSet set;
    set.context = &context.field;
    const std::vector<render::Ray> rays = RaysDown(14.0);
    std::vector<render::RayColor> out(rays.size());
    render::RenderRays(set, rays, out, render::EngineOptions::For(context.luminance), threads);
    double sum = 0.0;
    for (const render::RayColor& color : out) {
      for (size_t c = 0; c < 3; ++c) {
        sum += static_cast<double>(concealed ? image::SrgbFromLinear(color.concealed_light[c]) : color.rgb_srgb[c]) /
               (3.0 * static_cast<double>(out.size()));
      }
    }
    return sum;
  }
};

TEST_F(BrightnessTest, TiePointsGiveTheGains) {
  const auto stops = [](int photo, int c) { return Stops(photo) + 0.2 * (c - 1) * std::sin(photo); };
  Photograph([&](int photo, int c, double value, double) { return Exposed(0.6 * value, std::exp2(stops(photo, c))); });
  AddGroundPoints();
  bool complete = false;
  const brightness::Response response = FromTiePoints(Learning("context.h5", 1, false), &complete);
  EXPECT_TRUE(complete);
  EXPECT_LT(RmsStops(response, stops), 0.05);
  for (size_t c = 0; c < 3; ++c) {
    double mean = 0.0;
    for (size_t i = 0; i < survey_.photos.size(); ++i) mean += static_cast<double>(response.log_gain[3 * i + c]);
    EXPECT_NEAR(mean, 0.0, 1e-5);
  }
}

TEST_F(BrightnessTest, TiePointsGiveTheVignetting) {
  Photograph([](int photo, int, double value, double r2) { return Exposed(0.6 * value, std::exp2(Stops(photo)) * std::exp(-0.5 * r2)); });
  AddGroundPoints();
  const brightness::Response response = FromTiePoints(Learning("context.h5", 1, true));
  EXPECT_LT(RmsStops(response, [](int photo, int) { return Stops(photo); }), 0.05);
  for (const float r2 : {0.2F, 0.5F, 0.9F}) EXPECT_NEAR(response.LogVignetting(0, r2), -0.5F * r2, 0.05F) << r2;
}

TEST_F(BrightnessTest, WithoutPointsNothingIsEstimated) {
  bool complete = true;
  const brightness::Response response = FromTiePoints(Learning("context.h5", 1, true), &complete);
  EXPECT_FALSE(complete);
  for (const float gain : response.log_gain) EXPECT_EQ(gain, 0.0F);
}

TEST_F(BrightnessTest, TiePointsKeepAnchors) {
  Photograph([&](int photo, int, double value, double) { return Exposed(0.6 * value, std::exp2(photo == 5 ? -1.0 : 0.5)); });
  AddGroundPoints();
  TrainJob job = Learning("context.h5", 1, false);
  job.learn.learns_gain.assign(survey_.photos.size(), 0);
  job.learn.learns_gain[5] = 1;
  job.learn.anchored = true;
  const brightness::Response response = FromTiePoints(job);
  EXPECT_NEAR(response.log_gain[15] / std::log(2.0F), -1.5F, 0.05F);
  EXPECT_EQ(response.log_gain[18], 0.0F);
}

TEST_F(BrightnessTest, TrainingLearnsGainsWithoutTiePoints) {
  Photograph([](int photo, int, double value, double) { return Exposed(0.6 * value, std::exp2(0.5 * Stops(photo))); });
  base::ThreadPool threads(2);
  const TrainResult result = TrainContext(Learning("context.h5", 900, true), Box(20.0, 0.0), threads, {});
  ASSERT_TRUE(result.ok) << result.reason;
  const LoadedContext context = LoadContext(folder_ / "context.h5");
  EXPECT_LT(RmsStops(context.response, [](int photo, int) { return 0.5 * Stops(photo); }), 0.1);
  // The gains of held-out photos are predicted, and blocks use all gains.
  EXPECT_NE(context.response.log_gain[0], 0.0F);
  const TrainResult block = TrainBlock(Learning("block.h5", 50, true), Box(12.0, 1.0), folder_ / "context.h5", threads, {});
  EXPECT_TRUE(block.ok) << block.reason;
}

TEST_F(BrightnessTest, LearningResumesAfterAnInterruptionWithTheSameBits) {
  Photograph([](int photo, int, double value, double) { return Exposed(0.6 * value, std::exp2(0.5 * Stops(photo))); });
  base::ThreadPool one(1), three(3);
  TrainContext(Learning("a.h5", 80, true), Box(20.0, 0.0), three, {});
  TrainInterrupted(Learning("b.h5", 80, true), [&](const TrainJob& job) { TrainContext(job, Box(20.0, 0.0), one, {}); });
  EXPECT_EQ(Bytes("a.h5"), Bytes("b.h5"));
  EXPECT_EQ(LoadContext(folder_ / "a.h5").response.log_gain, LoadContext(folder_ / "b.h5").response.log_gain);
}

struct Form {
  bool product, patches;
};

class LuminanceTest : public BrightnessTest, public ::testing::WithParamInterface<Form> {};

TEST_P(LuminanceTest, ShowsAnUnderExposedSurveyAtTheWantedBrightness) {
  Photograph([](int, int, double value, double) { return Exposed(value, 0.08); });
  TrainJob job = JobWithLight(LuminanceMode::kUnder, -2.0, 600);
  job.luminance.product = GetParam().product;
  job.luminance.patches = GetParam().patches;
  base::ThreadPool threads(2);
  const TrainResult result = TrainContext(job, Box(20.0, 0.0), threads, {});
  ASSERT_TRUE(result.ok) << result.reason;
  EXPECT_GT(result.final_psnr_db, 27.0);  // of dark photos
  const LoadedContext context = LoadContext(folder_ / "context.h5");
  EXPECT_LT(MeanShown(context, true, threads), 0.2);
  if (GetParam().product) {
    // The first sample of a surface is not dimmed, because no sample is in front of it, so this form brightens less.
    EXPECT_GT(MeanShown(context, false, threads), 1.3 * MeanShown(context, true, threads));
    return;
  }
  EXPECT_NEAR(MeanShown(context, false, threads), 0.4, 0.08);
  EXPECT_LT(context.luminance_state.mean_log_gain, -0.5);
}

INSTANTIATE_TEST_SUITE_P(Forms, LuminanceTest, ::testing::Values(Form{false, true}, Form{true, true}, Form{false, false}), [](const auto& one) {
  return std::string(one.param.product ? "product" : "gain") + (one.param.patches ? "Patch" : "Batch");
});

// Colours that reach the end of their range in the first steps must still be learned.
TEST_F(BrightnessTest, DarkAndBrightSurveysAreLearnedWithoutIt) {
  base::ThreadPool threads(2);
  for (const double gain : {0.02, 8.0}) {
    fs::remove_all(folder_);
    Photograph([&](int, int, double value, double) { return Exposed(value, gain); });
    ASSERT_TRUE(TrainContext(Job("context.h5", 400), Box(20.0, 0.0), threads, {}).ok);
    const LoadedContext context = LoadContext(folder_ / "context.h5");
    double recorded = 0.0, pixels = 0.0;
    for (size_t i = 0; i < survey_.photos.size(); ++i) {
      for (const uint8_t value : pixels_->Rgb(i)) {
        recorded += value / 255.0;
        pixels += 1.0;
      }
    }
    EXPECT_NEAR(MeanShown(context, false, threads), recorded / pixels, 0.25 * recorded / pixels) << gain;
  }
}

TEST_F(BrightnessTest, ShowsAnOverExposedSurveyDarker) {
  Photograph([](int, int, double value, double) { return Exposed(value, 4.0); });
  base::ThreadPool threads(2);
  ASSERT_TRUE(TrainContext(JobWithLight(LuminanceMode::kOver, -1.0, 400), Box(20.0, 0.0), threads, {}).ok);
  const LoadedContext context = LoadContext(folder_ / "context.h5");
  const double plain = MeanShown(context, false, threads);
  EXPECT_GT(plain, 0.5);
  EXPECT_NEAR(MeanShown(context, true, threads), 0.4, 0.08);
}

TEST_F(BrightnessTest, BlocksUseTheContextsBrightness) {
  Photograph([](int, int, double value, double) { return Exposed(value, 0.08); });
  base::ThreadPool threads(2);
  ASSERT_TRUE(TrainContext(JobWithLight(LuminanceMode::kUnder, -2.0, 300), Box(20.0, 0.0), threads, {}).ok);
  const TrainResult block = TrainBlock(Job("block.h5", 400), Box(12.0, 1.0), folder_ / "context.h5", threads, {});
  ASSERT_TRUE(block.ok) << block.reason;
  const LoadedContext context = LoadContext(folder_ / "context.h5");
  const checkpoint::ArchiveReader reader(folder_ / "block.h5");
  const render::TrainedField field = scene::GetField(reader, folder_ / "block.h5", "");
  render::FieldSet coarse, fine;
  coarse.context = &context.field;
  fine.blocks = {&field};
  const std::vector<render::Ray> rays = RaysDown(10.0);
  const auto mean_shown = [&](const render::FieldSet& fields) {
    std::vector<render::RayColor> out(rays.size());
    render::RenderRays(fields, rays, out, {}, threads);
    double sum = 0.0;
    for (const render::RayColor& color : out) sum += static_cast<double>(color.rgb_srgb[0] + color.rgb_srgb[1] + color.rgb_srgb[2]);
    return sum / (3.0 * static_cast<double>(out.size()));
  };
  EXPECT_NEAR(mean_shown(fine), mean_shown(coarse), 0.05);
}

// Extreme photos: training must end with finite results.
struct Odd {
  const char* name;
  double (*recorded)(int photo, double value);
};

class OddPhotosTest : public BrightnessTest, public ::testing::WithParamInterface<Odd> {};

TEST_P(OddPhotosTest, TrainToTheEnd) {
  Photograph([](int photo, int, double value, double) { return GetParam().recorded(photo, value); });
  AddGroundPoints();
  base::ThreadPool threads(2);
  for (const LuminanceMode mode : {LuminanceMode::kNone, LuminanceMode::kUnder, LuminanceMode::kOver}) {
    TrainJob job = Learning("context" + std::to_string(static_cast<int>(mode)) + ".h5", 120, true);
    job.luminance.mode = mode;
    job.luminance.start_log_gain = -1.0;
    const TrainResult result = TrainContext(job, Box(20.0, 0.0), threads, {});
    ASSERT_TRUE(result.ok) << result.reason;
    EXPECT_EQ(result.dropped_steps, 0);
    const LoadedContext context = LoadContext(job.checkpoint);
    for (const float gain : context.response.log_gain) EXPECT_TRUE(std::isfinite(gain));
    for (const float weight : context.field.parameters.networks) ASSERT_TRUE(std::isfinite(weight));
  }
}

INSTANTIATE_TEST_SUITE_P(All, OddPhotosTest,
                         ::testing::Values(Odd{"black", [](int, double) { return 0.0; }}, Odd{"white", [](int, double) { return 1.0; }},
                                           Odd{"halfClipped", [](int, double value) { return value > 0.25 ? 1.0 : value; }},
                                           Odd{"tenStops",
                                               [](int photo, double value) { return Exposed(value, std::exp2(photo % 2 == 0 ? 10.0 : -10.0)); }},
                                           Odd{"oneBlackPhoto", [](int photo, double value) { return photo == 3 ? 0.0 : value; }}),
                         [](const auto& one) { return std::string(one.param.name); });

TEST_F(BrightnessTest, TagsOfTenStopsTrainToTheEnd) {
  TrainJob job = Job("context.h5", 150);
  for (size_t i = 0; i < survey_.photos.size(); ++i) job.response.exif_gain[i] = i % 2 == 0 ? 1024.0F : 1.0F / 1024.0F;
  base::ThreadPool threads(2);
  const TrainResult result = TrainContext(job, Box(20.0, 0.0), threads, {});
  EXPECT_TRUE(result.ok) << result.reason;
  EXPECT_EQ(result.dropped_steps, 0);
}

TEST_F(BrightnessTest, ASinglePhotoLearnsNothingAboutItself) {
  for (size_t i = 0; i < survey_.photos.size(); ++i) survey_.photos[i].is_test = i != 5;
  TrainJob job = Learning("context.h5", 40, false);
  job.min_views = 1;
  base::ThreadPool threads(1);
  const TrainResult result = TrainContext(job, Box(20.0, 0.0), threads, {});
  ASSERT_TRUE(result.ok) << result.reason;
  // Its gain and the field's colours are determined only up to a common factor: the projection keeps the gain at 1.
  for (const float gain : LoadContext(job.checkpoint).response.log_gain) EXPECT_NEAR(gain, 0.0F, 1e-6F);
}

}  // namespace
}  // namespace skyquilt::worker
