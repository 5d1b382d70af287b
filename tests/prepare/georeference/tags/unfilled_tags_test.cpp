#include "prepare/georeference/tags/unfilled_tags.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "core/survey/tagged_heights.h"

namespace skyquilt::prepare::georeference {
namespace {

constexpr double kGap_s = 900.0;

// A flight 45 m above take-off, which is at `take_off_m`; noise of a receiver and a barometer.
std::vector<input::PhotoFile> HeightFlight(int n, double take_off_m, double gps_sigma_m = 1.5) {
  base::Random random(3);
  std::vector<input::PhotoFile> photos;
  for (int i = 0; i < n; ++i) {
    input::PhotoFile photo{.name = "DJI_" + std::to_string(1000 + i) + ".JPG", .width = 4, .height = 3, .tags = {}};
    const double of_gps = gps_sigma_m * random.Normal(), of_barometer = 0.2 * random.Normal();
    photo.tags.gps = geo::Geodetic{47.0 + 1e-4 * i, 8.0, take_off_m + 45.0 + of_gps};
    photo.tags.absolute_altitude_m = photo.tags.gps->height_m;
    photo.tags.relative_altitude_m = 45.0 + of_barometer;
    photo.tags.capture_time_s = 1e6 + 3.0 * i;
    photo.tags.gimbal_yaw_deg = 90.0;
    photo.tags.gimbal_pitch_deg = -90.0;
    photo.tags.gimbal_roll_deg = 0.0;
    photos.push_back(photo);
  }
  return photos;
}

void ZeroAltitude(input::PhotoFile& photo) {
  photo.tags.gps->height_m = 0.0;
  if (photo.tags.absolute_altitude_m) photo.tags.absolute_altitude_m = 0.0;
}

std::vector<double> HeightsOf(const std::vector<input::PhotoFile>& photos) {
  std::vector<double> heights;
  for (const input::PhotoFile& photo : photos) heights.push_back(photo.tags.gps->height_m);
  return heights;
}

TEST(UnfilledTags, AltitudesOfZeroComeFromRelativeAltitude) {
  std::vector<input::PhotoFile> photos = HeightFlight(28, 456.0);
  for (size_t i = 0; i < 9; ++i) ZeroAltitude(photos[3 * i]);
  const UnfilledTags found = ClearUnfilledTags(kGap_s, photos);
  EXPECT_EQ(found.n_altitudes, 9U);
  EXPECT_EQ(found.n_filled, 9U);
  for (const input::PhotoFile& photo : photos) EXPECT_NEAR(photo.tags.gps->height_m, 501.0, 6.0) << photo.name;
  EXPECT_NEAR(photos[0].tags.gps->height_m, 501.0, 1.5);
  EXPECT_NE(found.Describe().find("altitude (9)"), std::string::npos) << found.Describe();
  // What the heights are measured from is known as before.
  std::vector<survey::PhotoTags> tags;
  for (const input::PhotoFile& photo : photos) tags.push_back(photo.tags);
  EXPECT_EQ(survey::JudgeTaggedHeights(tags), survey::TaggedHeights::kEgm96);
}

TEST(UnfilledTags, MostAltitudesMayBeZeroOrMissing) {
  std::vector<input::PhotoFile> photos = HeightFlight(20, 456.0);
  for (size_t i = 4; i < 20; ++i) ZeroAltitude(photos[i]);
  photos[19].tags.gps->height_m = std::nan("");
  const UnfilledTags found = ClearUnfilledTags(kGap_s, photos);
  EXPECT_EQ(found.n_altitudes, 15U);
  EXPECT_EQ(found.n_filled, 16U);
  for (const input::PhotoFile& photo : photos) EXPECT_NEAR(photo.tags.gps->height_m, 501.0, 6.0);
}

TEST(UnfilledTags, WithoutRelativeAltitudeThereIsNoHeight) {
  std::vector<input::PhotoFile> photos = HeightFlight(12, 456.0);
  for (input::PhotoFile& photo : photos) photo.tags.relative_altitude_m.reset();
  ZeroAltitude(photos[5]);
  const UnfilledTags found = ClearUnfilledTags(kGap_s, photos);
  EXPECT_EQ(found.n_altitudes, 1U);
  EXPECT_EQ(found.n_filled, 0U);
  EXPECT_TRUE(std::isnan(photos[5].tags.gps->height_m));
  EXPECT_DOUBLE_EQ(photos[5].tags.gps->latitude_deg, 47.0005);
}

TEST(UnfilledTags, EachFlightHasItsOwnTakeOff) {
  std::vector<input::PhotoFile> photos = HeightFlight(12, 456.0);
  for (input::PhotoFile photo : HeightFlight(12, 300.0)) {
    *photo.tags.capture_time_s += 5000.0;
    photo.name = "later_" + photo.name;
    photos.push_back(photo);
  }
  ZeroAltitude(photos[2]);
  ZeroAltitude(photos[14]);
  ClearUnfilledTags(kGap_s, photos);
  EXPECT_NEAR(photos[2].tags.gps->height_m, 501.0, 2.0);
  EXPECT_NEAR(photos[14].tags.gps->height_m, 345.0, 2.0);
}

TEST(UnfilledTags, ABarometersHeightIsNotAsAccurateAsRtk) {
  std::vector<input::PhotoFile> photos = HeightFlight(12, 456.0, 0.02);
  for (input::PhotoFile& photo : photos) {
    photo.tags.rtk = true;
    photo.tags.vertical_accuracy_m = 0.03;
  }
  ZeroAltitude(photos[5]);
  ClearUnfilledTags(kGap_s, photos);
  EXPECT_NEAR(photos[5].tags.gps->height_m, 501.0, 1.0);
  EXPECT_GE(photos[5].tags.vertical_accuracy_m, 1.0);
  EXPECT_EQ(photos[4].tags.vertical_accuracy_m, 0.03);
}

// Altitudes around 0, some of them exactly: above a beach, in whole metres or not, with and without RelativeAltitude.
TEST(UnfilledTags, SurveysAtSeaLevelStayAsTheyAre) {
  for (const bool relative : {false, true}) {
    for (const bool whole : {false, true}) {
      for (const double take_off_m : {-45.0, -43.0, -47.0}) {
        std::vector<input::PhotoFile> photos = HeightFlight(30, take_off_m);
        for (size_t i = 0; i < photos.size(); ++i) {
          double& height_m = photos[i].tags.gps->height_m;
          if (whole) height_m = std::round(height_m);
          if (std::abs(height_m) < 0.3) height_m = 0.0;
          photos[i].tags.absolute_altitude_m = height_m;
          if (!relative) photos[i].tags.relative_altitude_m.reset();
        }
        const std::vector<double> before = HeightsOf(photos);
        EXPECT_FALSE(ClearUnfilledTags(kGap_s, photos).Any());
        EXPECT_EQ(HeightsOf(photos), before);
      }
    }
  }
}

TEST(UnfilledTags, AllAltitudesOfZeroStayAsTheyAre) {
  std::vector<input::PhotoFile> photos = HeightFlight(10, 456.0);
  for (input::PhotoFile& photo : photos) ZeroAltitude(photo);
  EXPECT_FALSE(ClearUnfilledTags(kGap_s, photos).Any());
  for (input::PhotoFile& photo : photos) photo.tags.relative_altitude_m.reset();
  EXPECT_FALSE(ClearUnfilledTags(kGap_s, photos).Any());
  EXPECT_EQ(HeightsOf(photos), std::vector<double>(10, 0.0));
}

TEST(UnfilledTags, GoodTagsStayToTheBit) {
  std::vector<input::PhotoFile> photos = HeightFlight(28, 456.0);
  const std::vector<double> before = HeightsOf(photos);
  EXPECT_FALSE(ClearUnfilledTags(kGap_s, photos).Any());
  EXPECT_EQ(HeightsOf(photos), before);
  for (const input::PhotoFile& photo : photos)
    EXPECT_TRUE(photo.tags.relative_altitude_m && photo.tags.gimbal_pitch_deg && !photo.tags.vertical_accuracy_m);
}

TEST(UnfilledTags, RelativeAltitudesOfZeroAreMissing) {
  std::vector<input::PhotoFile> photos = HeightFlight(12, 456.0);
  for (input::PhotoFile& photo : photos) photo.tags.relative_altitude_m = 0.0;
  EXPECT_EQ(ClearUnfilledTags(kGap_s, photos).n_relative, 12U);
  EXPECT_FALSE(photos[0].tags.relative_altitude_m);
  // One photo in the air, one taken before take-off.
  photos = HeightFlight(12, 456.0);
  photos[4].tags.relative_altitude_m = 0.0;
  photos[0].tags.relative_altitude_m = 0.0;
  photos[0].tags.gps->height_m = 456.5;
  EXPECT_EQ(ClearUnfilledTags(kGap_s, photos).n_relative, 1U);
  EXPECT_EQ(photos[0].tags.relative_altitude_m, 0.0);
  EXPECT_FALSE(photos[4].tags.relative_altitude_m);
  EXPECT_NEAR(photos[4].tags.gps->height_m, 501.0, 6.0);
}

TEST(UnfilledTags, BothHeightsOfZeroAreMissing) {
  std::vector<input::PhotoFile> photos = HeightFlight(12, 456.0);
  ZeroAltitude(photos[4]);
  photos[4].tags.relative_altitude_m = 0.0;
  const UnfilledTags found = ClearUnfilledTags(kGap_s, photos);
  EXPECT_EQ(found.n_altitudes, 1U);
  EXPECT_EQ(found.n_relative, 1U);
  EXPECT_TRUE(std::isnan(photos[4].tags.gps->height_m));
}

TEST(UnfilledTags, GimbalAnglesOfZeroAreMissingUnlessTheFlightLooksLevel) {
  const auto level = [](input::PhotoFile& photo) { photo.tags.gimbal_yaw_deg = photo.tags.gimbal_pitch_deg = photo.tags.gimbal_roll_deg = 0.0; };
  std::vector<input::PhotoFile> photos = HeightFlight(12, 456.0);
  level(photos[3]);
  EXPECT_EQ(ClearUnfilledTags(kGap_s, photos).n_gimbal, 1U);
  EXPECT_FALSE(photos[3].tags.gimbal_pitch_deg);
  EXPECT_TRUE(photos[4].tags.gimbal_pitch_deg);
  for (input::PhotoFile& photo : photos) level(photo);
  EXPECT_EQ(ClearUnfilledTags(kGap_s, photos).n_gimbal, 12U);
  // A facade to the north, with some photos that look a little aside.
  photos = HeightFlight(12, 456.0);
  for (input::PhotoFile& photo : photos) level(photo);
  for (size_t i = 0; i < 6; ++i) photos[i].tags.gimbal_yaw_deg = 0.1;
  EXPECT_EQ(ClearUnfilledTags(kGap_s, photos).n_gimbal, 0U);
}

TEST(UnfilledTags, ZerosFoundAtReadingAreCounted) {
  std::vector<input::PhotoFile> photos = HeightFlight(3, 456.0);
  photos[0].tags.zero_tags = {"FNumber", "FocalLength"};
  photos[2].tags.zero_tags = {"FocalLength"};
  const std::string text = ClearUnfilledTags(kGap_s, photos).Describe();
  EXPECT_NE(text.find("(photos of 3): FNumber (1), FocalLength (2)"), std::string::npos) << text;
  photos.clear();
  EXPECT_FALSE(ClearUnfilledTags(kGap_s, photos).Any());
}

TEST(UnfilledTags, PitchesThatLookUpChangeTheirSignAndOthersStay) {
  std::vector<input::PhotoFile> photos(20);
  const auto set = [&](double most_deg, double last_deg) {
    for (input::PhotoFile& photo : photos) photo.tags.gimbal_pitch_deg = most_deg;
    photos.back().tags.gimbal_pitch_deg = last_deg;
  };
  set(90.0, 45.0);
  EXPECT_TRUE(TurnPitchesThatLookUp(photos));
  EXPECT_EQ(photos.front().tags.gimbal_pitch_deg, -90.0);
  EXPECT_EQ(photos.back().tags.gimbal_pitch_deg, -45.0);
  // Facades from below, and one photo of the sky, are what they are.
  for (const double usual_deg : {-90.0, -30.0, 0.0, 40.0}) {
    set(usual_deg, 85.0);
    EXPECT_FALSE(TurnPitchesThatLookUp(photos)) << usual_deg;
    EXPECT_EQ(photos.front().tags.gimbal_pitch_deg, usual_deg);
  }
  std::vector<input::PhotoFile> without(3);
  EXPECT_FALSE(TurnPitchesThatLookUp(without));
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
