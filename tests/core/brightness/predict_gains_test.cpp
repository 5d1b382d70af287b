#include "core/brightness/predict_gains.h"

#include <gtest/gtest.h>

#include <cmath>

namespace skyquilt::brightness {
namespace {

// Eight photos; every fourth held out; tags jump by a stop.
struct Flight {
  Response response = Response::Neutral(8, 1);
  std::vector<CapturedPhoto> photos;
  Flight() {
    for (size_t i = 0; i < 8; ++i) {
      response.exif_gain[i] = i % 3 == 0 ? 2.0F : 1.0F;
      photos.push_back({static_cast<double>(i), 0, i % 4 != 1, true});
    }
  }
  void Learn(size_t photo, double log_gain) {
    for (size_t c = 0; c < 3; ++c) response.log_gain[3 * photo + c] = static_cast<float>(log_gain);
  }
  double Total(size_t photo) const { return static_cast<double>(response.LogGain(photo)[1]); }
};

TEST(PredictGains, TrustsTagsThatExplainTheBrightness) {
  Flight flight;
  for (size_t i = 0; i < 8; ++i) {
    if (flight.photos[i].learned) flight.Learn(i, 0.1 * static_cast<double>(i));  // light rises slowly, tags are right
  }
  EXPECT_GT(TagReliability(flight.response, flight.photos), 0.9);
  PredictGains(flight.photos, flight.response);
  EXPECT_NEAR(flight.response.log_gain[3 * 1 + 1], 0.1, 0.05);
  EXPECT_NEAR(flight.response.log_gain[3 * 5 + 1], 0.5, 0.05);
}

TEST(PredictGains, IgnoresTagsWhereTheShutterFollowedTheLight) {
  Flight flight;
  for (size_t i = 0; i < 8; ++i) {
    if (flight.photos[i].learned) flight.Learn(i, -std::log(static_cast<double>(flight.response.exif_gain[i])));  // all equally bright
  }
  EXPECT_LT(TagReliability(flight.response, flight.photos), 0.05);
  PredictGains(flight.photos, flight.response);
  for (size_t i = 0; i < 8; ++i) EXPECT_NEAR(flight.Total(i), 0.0, 0.05) << i;
}

TEST(PredictGains, DoesNotInterpolateUncorrelatedGains) {
  Response response = Response::Neutral(40, 1);
  std::vector<CapturedPhoto> photos;
  for (size_t i = 0; i < 40; ++i) {
    photos.push_back({static_cast<double>(i), 0, i % 8 != 3, true});
    const float off = (i * 7919U) % 2 == 0 ? 0.5F : -0.5F;  // alternates
    for (size_t c = 0; c < 3; ++c) response.log_gain[3 * i + c] = photos[i].learned ? off : 0.0F;
  }
  PredictGains(photos, response);
  for (size_t i = 3; i < 40; i += 8) EXPECT_NEAR(response.log_gain[3 * i], 0.0F, 0.1F) << i;
}

TEST(PredictGains, TaggedPhotosDoNotTakeOverTheGainsOfUntaggedOnes) {
  // Every second photo has no tags; brightness rises by a tenth per photo in log light, and the tags are right.
  Response response = Response::Neutral(16, 1);
  std::vector<CapturedPhoto> photos;
  for (size_t i = 0; i < 16; ++i) {
    const bool tagged = i % 2 == 0, learned = i != 6 && i != 9;
    photos.push_back({static_cast<double>(i), 0, learned, tagged});
    const float light = 0.1F * static_cast<float>(i);
    if (tagged) response.exif_gain[i] = std::exp(light);
    for (size_t c = 0; c < 3; ++c) response.log_gain[3 * i + c] = tagged || !learned ? 0.0F : light;
  }
  PredictGains(photos, response);
  EXPECT_NEAR(response.LogGain(6)[0], 0.6F, 0.02F);  // with tags
  EXPECT_NEAR(response.LogGain(9)[0], 0.9F, 0.05F);  // without
}

TEST(PredictGains, KeepsGroupsApartAndSinglePhotosUnchanged) {
  Flight flight;
  for (size_t i = 0; i < 8; ++i) flight.response.exif_gain[i] = 1.0F;
  for (const size_t i : {0U, 2U, 3U}) flight.Learn(i, 0.5);
  flight.photos[1].group = 1;  // alone in its group
  for (const size_t i : {4U, 5U, 6U, 7U}) flight.photos[i].group = 2;
  for (const size_t i : {4U, 6U, 7U}) flight.Learn(i, -0.4);
  PredictGains(flight.photos, flight.response);
  EXPECT_EQ(flight.response.log_gain[3], 0.0F);
  EXPECT_NEAR(flight.response.log_gain[15], -0.4F, 0.05F);
}

TEST(PredictGains, LearnedPhotosKeepTheirGains) {
  Flight flight;
  flight.Learn(2, 0.3);
  const std::vector<float> before = flight.response.log_gain;
  PredictGains(flight.photos, flight.response);
  for (size_t i = 0; i < 8; ++i) {
    if (flight.photos[i].learned) {
      EXPECT_EQ(flight.response.log_gain[3 * i], before[3 * i]);
    }
  }
}

TEST(PredictGains, OnePhotoOrNone) {
  Response one = Response::Neutral(1, 1);
  PredictGains({{0.0, 0, false, true}}, one);
  EXPECT_EQ(one.log_gain[0], 0.0F);
  Response none = Response::Neutral(0, 0);
  PredictGains({}, none);
  EXPECT_EQ(TagReliability(none, {}), 1.0);
}

}  // namespace
}  // namespace skyquilt::brightness
