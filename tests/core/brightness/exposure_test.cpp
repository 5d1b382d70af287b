#include "core/brightness/exposure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/image/srgb.h"

namespace skyquilt::brightness {
namespace {

TEST(ExifExposure, FollowsTheFormula) {
  EXPECT_DOUBLE_EQ(*ExifExposure(1.0 / 200.0, 2.0, 400.0), (1.0 / 200.0) * 4.0 / 4.0);
  EXPECT_DOUBLE_EQ(*ExifExposure(0.01, std::nullopt, std::nullopt), 0.01);
  EXPECT_FALSE(ExifExposure(std::nullopt, 2.0, 100.0));
  EXPECT_FALSE(ExifExposure(0.0, 2.0, 100.0));
  EXPECT_FALSE(ExifExposure(std::nan(""), 2.0, 100.0));
}

TEST(GainsFromExif, AreRelativeToTheMedian) {
  const PhotoGains gains = GainsFromExif({0.01, 0.02, 0.04, std::nullopt}, std::vector<bool>(4, true));
  EXPECT_DOUBLE_EQ(gains.reference_exposure, 0.02);
  EXPECT_FLOAT_EQ(gains.gain[0], 0.5F);
  EXPECT_FLOAT_EQ(gains.gain[2], 2.0F);
  EXPECT_FLOAT_EQ(gains.gain[3], 1.0F);
}

TEST(GainsFromExif, TellsPhotosWithoutTags) {
  const PhotoGains gains = GainsFromExif({0.01, std::nullopt, 0.02}, std::vector<bool>(3, true));
  EXPECT_EQ(gains.known, (std::vector<bool>{true, false, true}));
  EXPECT_EQ(gains.gain[1], 1.0F);
}

TEST(GainsFromExif, UntaggedSurveysKeepTheirColours) {
  const PhotoGains gains = GainsFromExif({std::nullopt, std::nullopt}, {true, true});
  EXPECT_EQ(gains.reference_exposure, 0.0);
  for (const float g : gains.gain) EXPECT_EQ(g, 1.0F);
  EXPECT_TRUE(GainsFromExif({}, {}).gain.empty());
}

TEST(GainsFromExif, LimitsImpossibleTags) {
  const PhotoGains gains = GainsFromExif({1e-9, 0.01, 0.01, 1e9}, std::vector<bool>(4, true));
  EXPECT_FLOAT_EQ(gains.gain[0], 1.0F / 1024.0F);
  EXPECT_FLOAT_EQ(gains.gain[3], 1024.0F);
}

TEST(GainsFromExif, TheMedianIsThatOfTrainingPhotos) {
  const std::vector<bool> in_training = {true, false, true, false, true, false, false};
  const PhotoGains gains = GainsFromExif({0.01, 0.08, 0.02, 0.08, 0.04, std::nullopt, 0.08}, in_training);
  EXPECT_DOUBLE_EQ(gains.reference_exposure, 0.02);
  EXPECT_FLOAT_EQ(gains.gain[0], 0.5F);
  EXPECT_FLOAT_EQ(gains.gain[1], 4.0F) << "a held-out photo's gain is relative to it, too";
  EXPECT_EQ(gains.known, (std::vector<bool>{true, true, true, true, true, false, true}));
}

TEST(GainsFromExif, TagsOfHeldOutPhotosAloneSayNothing) {
  const PhotoGains gains = GainsFromExif({std::nullopt, 0.08, std::nullopt}, {true, false, true});
  EXPECT_EQ(gains.reference_exposure, 0.0);
  EXPECT_EQ(gains.gain, (std::vector<float>{1.0F, 1.0F, 1.0F}));
  EXPECT_EQ(gains.known, (std::vector<bool>{false, false, false}));
}

TEST(Expose, SlopesMatchFiniteDifferencesOverTenStops) {
  for (const float gain : {1.0F / 1024.0F, 0.3F, 1.0F, 2.5F, 1024.0F}) {
    const auto with = [](float log_gain) { return Exposure::FromLogGain(log_gain); };
    const float log_gain = std::log(gain);
    for (const float value : {0.01F, 0.2F, 0.5F, 0.99F, 1.4F}) {
      const float h = 1e-3F;
      const Exposed exposed = Expose(value, with(log_gain));
      const float numeric = (Expose(value + h, with(log_gain)).value - Expose(value - h, with(log_gain)).value) / (2.0F * h);
      EXPECT_NEAR(exposed.slope, numeric, 0.02F * std::max(1.0F, std::abs(numeric))) << gain << " " << value;
      const float by_gain = (Expose(value, with(log_gain + h)).value - Expose(value, with(log_gain - h)).value) / (2.0F * h);
      EXPECT_NEAR(exposed.log_gain_slope, by_gain, 0.02F * std::max(1.0F, std::abs(by_gain))) << gain << " " << value;
      EXPECT_TRUE(std::isfinite(exposed.slope));
    }
  }
  EXPECT_TRUE(std::isfinite(Expose(-0.5F, Exposure::FromLogGain(1.1F)).value));
}

// Compares the fast path above the toe with the two transfer functions.
TEST(Expose, IsAGainInLinearLight) {
  for (const float gain : {1.0F / 1024.0F, 0.1F, 1.0F, 3.0F, 1024.0F}) {
    for (float value = 0.0F; value <= 2.0F; value += 0.01F) {
      const float wanted = image::SrgbFromLinear(gain * image::LinearFromSrgb(value));
      EXPECT_NEAR(Expose(value, Exposure::FromLogGain(std::log(gain))).value, wanted, 2e-4F * std::max(1.0F, wanted)) << gain << " " << value;
    }
  }
}

TEST(ColorRange, LeavesRoomForTheDarkestPhoto) {
  EXPECT_NEAR(ColorRange({1.0F, 1.0F}), 1.02, 1e-6);
  const double range = ColorRange({0.25F, 1.0F, 4.0F});
  EXPECT_GE(Expose(static_cast<float>(range), Exposure::FromLogGain(std::log(0.25F))).value, 1.0F);
  EXPECT_LE(ColorRange({1e-6F}), 4.0);
}

}  // namespace
}  // namespace skyquilt::brightness
