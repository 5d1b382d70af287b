#include "bench/study/scale_scores.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/study/scales_parts.h"
#include "core/image/srgb.h"

namespace skyquilt::bench {
namespace {

// A pinhole camera that looks straight down from 10 m above the origin; x to the east, 1 rad over half its width.
evaluate::photos::HeldOutPhoto Photo(int width, int height, uint8_t value) {
  evaluate::photos::HeldOutPhoto photo;
  const double focal = 0.5 * width;
  photo.camera = {.model = camera::CameraModel::kPinhole, .width = width, .height = height, .params = {focal, focal, 0.5 * width, 0.5 * height}};
  photo.cam_from_enu.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  photo.cam_from_enu.translation = -(photo.cam_from_enu.rotation * Eigen::Vector3d(0.0, 0.0, 10.0));
  photo.photo = image::Image8(width, height, 3, value);
  return photo;
}

image::ImageF Even(const camera::Camera& camera, float value) {
  return {camera.width, camera.height, 3, value};
}

const ScaledPhoto& At(const std::vector<ScaledPhoto>& scaled, int divisor, bool averaged) {
  return *std::find_if(scaled.begin(), scaled.end(), [&](const ScaledPhoto& s) { return s.divisor == divisor && s.averaged == averaged; });
}

TEST(ScoreAtScales, OfAConstantImageIsTheSameAtAllScales) {
  const TrueView view = SceneLight(Photo(32, 24, 128), {});
  const float rendered = 128.0F / 255.0F + 0.1F;
  const std::vector<ScaledPhoto> scaled = ScoreAtScales(view, {1, 2, 4, 8}, [&](const camera::Camera& c) { return Even(c, rendered); });
  ASSERT_EQ(scaled.size(), 7U);
  for (const ScaledPhoto& s : scaled) {
    EXPECT_NEAR(s.psnr_db, 20.0, 1e-3) << s.divisor << ' ' << s.averaged;
    EXPECT_EQ(s.truth.width, 32 / s.divisor);
    EXPECT_EQ(s.rendering.height, 24 / s.divisor);
  }
}

TEST(ScoreAtScales, AveragesTruthAndFullFrameInLinearLight) {
  evaluate::photos::HeldOutPhoto photo = Photo(4, 2, 0);
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 4; x += 2) std::fill_n(photo.photo.At(x, y), 3, uint8_t{255});
  }
  const TrueView view = SceneLight(photo, {});
  const float grey = image::SrgbFromLinear(0.5F);
  // One ray per pixel always hits a white stripe; the full frame is right.
  const std::vector<ScaledPhoto> scaled = ScoreAtScales(view, {1, 2}, [&](const camera::Camera& c) {
    image::ImageF frame = Even(c, 1.0F);
    for (int y = 0; c.width == 4 && y < 2; ++y) {
      for (int x = 1; x < 4; x += 2) std::fill_n(frame.At(x, y), 3, 0.0F);
    }
    return frame;
  });
  EXPECT_NEAR(At(scaled, 2, false).truth.data[0], grey, 1e-6);
  EXPECT_NEAR(At(scaled, 2, true).rendering.data[0], grey, 1e-6);
  EXPECT_GT(At(scaled, 2, true).psnr_db, 100.0);
  EXPECT_NEAR(At(scaled, 2, false).psnr_db, -20.0 * std::log10(1.0 - static_cast<double>(grey)), 1e-3);
}

TEST(ScoreAtScales, IgnoresMaskedPixels) {
  evaluate::photos::HeldOutPhoto photo = Photo(8, 8, 100);
  photo.mask.assign(64, 255);
  for (size_t i = 0; i < 8; ++i) {
    photo.mask[i] = 0;
    for (size_t c = 0; c < 3; ++c) photo.photo.data[3 * i + c] = 255;
  }
  const auto exact = [](const camera::Camera& c) { return Even(c, 100.0F / 255.0F); };
  EXPECT_GT(At(ScoreAtScales(SceneLight(photo, {}), {1, 2}, exact), 1, false).psnr_db, 100.0);
  EXPECT_GT(At(ScoreAtScales(SceneLight(photo, {}), {1, 2}, exact), 2, false).psnr_db, 100.0);
  photo.mask.clear();
  EXPECT_LT(At(ScoreAtScales(SceneLight(photo, {}), {1, 2}, exact), 1, false).psnr_db, 20.0);
}

TEST(SceneLight, DividesByTheGain) {
  evaluate::photos::PhotoResponse recording;
  recording.log_gain = {std::log(2.0F), 0.0F, std::log(0.25F)};
  const TrueView view = SceneLight(Photo(3, 3, 120), recording);
  const float light = image::LinearFromSrgb(120.0F / 255.0F);
  EXPECT_NEAR(view.light.At(1, 1)[0], light / 2.0F, 1e-6);
  EXPECT_NEAR(view.light.At(1, 1)[1], light, 1e-6);
  EXPECT_NEAR(view.light.At(1, 1)[2], light * 4.0F, 1e-6);
}

TEST(SceneLight, DividesByTheVignetting) {
  evaluate::photos::PhotoResponse recording;
  recording.vignetting = {-0.5F, 0.0F, 0.0F};
  const TrueView view = SceneLight(Photo(9, 9, 120), recording);
  EXPECT_GT(view.light.At(0, 0)[0], 1.2F * view.light.At(4, 4)[0]);
  EXPECT_NEAR(view.light.At(4, 4)[0], image::LinearFromSrgb(120.0F / 255.0F), 1e-6);
}

TEST(KeepArea, ScoresOnlyPixelsWhoseSurfaceIsInside) {
  evaluate::photos::HeldOutPhoto photo = Photo(8, 8, 120);
  photo.true_depth = image::ImageF(8, 8, 1, 10.0F);  // the ground: the photo shows 20 x 20 m of it
  *photo.true_depth.At(7, 0) = std::numeric_limits<float>::quiet_NaN();
  TrueView view = SceneLight(photo, {});
  KeepArea(photo, {{0.0, -100.0}, {100.0, 100.0}}, &view);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) EXPECT_EQ(*view.used.At(x, y) != 0, x >= 4 && !(x == 7 && y == 0)) << x << ' ' << y;
  }
  photo.true_depth = {};
  view = SceneLight(photo, {});
  KeepArea(photo, {{-100.0, -100.0}, {100.0, 100.0}}, &view);
  EXPECT_TRUE(std::isnan(ScoreAtScales(view, {1}, [](const camera::Camera& c) { return Even(c, 0.5F); }).front().psnr_db))
      << "without true depth no pixel is known to be inside";
}

VariantResult Scored(double one_db, double averaged_db) {
  VariantResult r;
  r.scales = {{.divisor = 1, .photos = 2, .width = 640, .psnr_db = 30.0, .render_seconds = 2.0, .frame_seconds = 1.0},
              {.divisor = 8, .photos = 2, .width = 80, .psnr_db = one_db, .render_seconds = 0.02, .frame_seconds = 0.01},
              {.divisor = 8, .averaged = true, .photos = 2, .width = 80, .psnr_db = averaged_db, .render_seconds = 2.0, .frame_seconds = 1.0}};
  return r;
}

std::vector<MethodResults> ExampleMethods() {
  return {{.method = {0, false}, .label = "points, photos", .seeds = {Scored(20.0, 34.0), Scored(22.0, 36.0)}},
          {.method = {1, true}, .label = "cones of 1, pyramid", .seeds = {Scored(31.0, 34.0)}},
          {.method = {1, false}, .label = "cones of 1, photos", .seeds = {Scored(25.0, 34.0)}}};
}

TEST(ScaleTable, HasMediansOverSeedsWithOneAndWithManyRays) {
  const BenchTable table = ScaleTable(ExampleMethods(), "time");
  EXPECT_EQ(table.columns, (std::vector<std::string>{"method", "1 (640 px)", "1/8 (80 px)"}));
  ASSERT_EQ(table.rows.size(), 6U);
  EXPECT_EQ(table.rows[0][2].value, 21.0);
  EXPECT_EQ(table.rows[1][2].value, 35.0);
  EXPECT_EQ(table.rows[1][1].value, 30.0) << "at full width both are the same";
}

TEST(FrameTimeTable, ComparesTheSmallestWithTheFullFrame) {
  const BenchTable table = FrameTimeTable(ExampleMethods(), "time");
  EXPECT_NEAR(table.rows[1][1].value, 1000.0, 1e-9);
  EXPECT_NEAR(table.rows[1][2].value, 10.0, 1e-9);
  EXPECT_NEAR(table.rows[1][3].value, 100.0, 1e-9);
}

TEST(BestCones, AreBestAtSmallWidths) {
  const std::vector<MethodResults> methods = ExampleMethods();
  EXPECT_EQ(BestCones(methods), &methods[1]);
  EXPECT_EQ(BestCones({methods[0]}), nullptr);
  const std::vector<std::string> verdicts = ScaleVerdicts(methods, "Equal time");
  ASSERT_EQ(verdicts.size(), 3U);
  EXPECT_NE(verdicts[0].find("no difference seen (0.00 dB"), std::string::npos) << verdicts[0];
  EXPECT_NE(verdicts[1].find("+11.00 dB"), std::string::npos) << "of the seed that both have: " << verdicts[1];
  EXPECT_NE(verdicts[2].find("met"), std::string::npos) << verdicts[2];
}

TEST(ScaleOptions, IdentityTellsWhatIsScored) {
  ScaleOptions options;
  const std::string all = options.Identity();
  options.groups = {"h060_"};
  EXPECT_NE(options.Identity(), all);
  options = {};
  options.area = GroundArea{{0.0, 0.0}, {1.0, 1.0}};
  EXPECT_NE(options.Identity(), all);
}

}  // namespace
}  // namespace skyquilt::bench
