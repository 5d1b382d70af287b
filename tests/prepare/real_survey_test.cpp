// Reference values from an independent fit of the same models (similarity alone): Brighton Beach 0.60 m over 18 photos and 45.5 m above ground (40.0
// m RelativeAltitude), Seneca 3.6 m over 166 photos and 63.9 m. Median horizontal distance from the tags, 0.345 m and 2.156 m.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"
#include "prepare/prepare.h"

namespace skyquilt::prepare {
namespace {

std::filesystem::path Data() {
  const char* data = std::getenv("SKYQUILT_DATA");
  return data == nullptr ? "../shared/data" : data;
}

// Median horizontal distance of the cameras from their tags as they are.
double MedianTagError(const survey::Survey& survey) {
  const geo::EnuFrame frame(survey.origin);
  std::vector<double> error_m;
  for (const survey::Photo& photo : survey.photos) {
    if (photo.gps) error_m.push_back((frame.EnuFromGeodetic(*photo.gps) - photo.cam_from_enu.OriginInSource()).head<2>().norm());
  }
  return base::Median(error_m);
}

survey::Survey PrepareReal(const std::string& name) {
  const TemporaryFolder out;
  base::ThreadPool threads(2);
  return Prepare({Data() / name / "images", Data() / name / "sparse/0", out / "survey"}, {}, threads);
}

TEST(RealSurvey, BrightonBeachLandsOnItsTags) {
  if (!std::filesystem::exists(Data() / "brighton_beach")) GTEST_SKIP() << "no real photos in " << Data();
  const survey::Survey survey = PrepareReal("brighton_beach");
  EXPECT_EQ(survey.photos.size(), 18U);
  EXPECT_TRUE(survey.georeferenced);
  EXPECT_EQ(survey.fit.n_inliers, 18);
  EXPECT_LT(survey.fit.rmse_m, 1.0);
  EXPECT_LT(MedianTagError(survey), 1.1 * 0.345);
  EXPECT_LT(std::abs(survey.fit.tag_lag_s), 2.5 * survey.fit.tag_lag_sigma_s);
  EXPECT_LT(survey.fit.accuracy.tilt_deg, 1.0);
  EXPECT_NEAR(survey.MedianAgl(), 45.5, 2.0);
  EXPECT_NEAR(survey.origin.latitude_deg, 46.8427, 0.002);
  EXPECT_NEAR(survey.origin.longitude_deg, -91.994, 0.002);
  // The drone stopped for each photo: 0.2 m/s, but 1.9 m/s between photos.
  EXPECT_EQ(survey.checks.speed_source, "speed tags");
  EXPECT_LT(survey.checks.speed_mps, 0.5);
  EXPECT_EQ(survey.checks.readout_ms, 33.0);
  EXPECT_LT(survey.checks.smear_px, 0.5);
  // Its heights are bent against the tags by 1.4 m; the adjustment to them takes out 0.1 m, as much as the photos allow.
  EXPECT_TRUE(survey.fit.adjusted_to_tags);
  EXPECT_LT(survey.checks.dome_m, 1.35);
  EXPECT_NEAR(survey.checks.k1_sigma, 1.18e-3, 0.1e-3);
}

TEST(RealSurvey, SenecaLandsOnItsTags) {
  if (!std::filesystem::exists(Data() / "seneca")) GTEST_SKIP() << "no real photos in " << Data();
  const survey::Survey survey = PrepareReal("seneca");
  EXPECT_EQ(survey.photos.size(), 166U);
  EXPECT_EQ(survey.unregistered, std::vector<std::string>{"IMG_0482.jpg"});
  EXPECT_GE(survey.fit.n_inliers, 160);
  EXPECT_NEAR(survey.fit.rmse_m, 2.8, 0.4);  // less than 3.6, because the lag is found
  EXPECT_LT(MedianTagError(survey), 1.1 * 2.156);
  EXPECT_NEAR(survey.fit.tag_lag_s, 0.25, 0.1);
  EXPECT_NEAR(survey.MedianAgl(), 63.9, 3.0);
  EXPECT_FALSE(survey.fit.adjusted_to_tags);
  EXPECT_NEAR(survey.checks.k1_sigma, 8e-5, 1e-5);
  EXPECT_TRUE(std::isnan(survey.checks.readout_ms));
  // The photos' XMP has a ground speed of 4.7 m/s in the first one.
  EXPECT_GT(survey.checks.speed_mps, 3.0);
}

}  // namespace
}  // namespace skyquilt::prepare
