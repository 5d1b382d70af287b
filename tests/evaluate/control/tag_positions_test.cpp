#include "evaluate/control/tag_positions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geo/enu_frame.h"
#include "tests/support/not_finite.h"

namespace skyquilt::evaluate::control {
namespace {

// One photo at (10, 20, 30) m whose tag is 3 m west and 4 m up of it, and corrected by 1 m eastwards.
survey::Survey SurveyOfOnePhoto() {
  survey::Survey survey;
  survey.georeferenced = true;
  survey.origin = {47.0, 8.0, 400.0};
  survey::Photo photo;
  photo.name = "a.jpg";
  photo.cam_from_enu.translation = {-10.0, -20.0, -30.0};
  photo.gps = geo::EnuFrame(survey.origin).GeodeticFromEnu({7.0, 20.0, 34.0});
  photo.gps_correction_m = {1.0, 0.0, 0.0};
  survey.photos = {photo};
  return survey;
}

TEST(TagPositions, ResidualIsTheCameraMinusTheCorrectedTag) {
  const auto tags = TagPositions(SurveyOfOnePhoto());
  ASSERT_EQ(tags.size(), 1U);
  ASSERT_TRUE(tags[0]);
  EXPECT_TRUE(tags[0]->recorded.isApprox(Eigen::Vector3d(7.0, 20.0, 34.0), 1e-6));
  EXPECT_TRUE(tags[0]->corrected.isApprox(Eigen::Vector3d(8.0, 20.0, 34.0), 1e-6));
  EXPECT_TRUE(tags[0]->residual.isApprox(Eigen::Vector3d(2.0, 0.0, -4.0), 1e-6));
}

TEST(TagPositions, ATagWithoutHeightHasAPlaceOnTheMap) {
  survey::Survey survey = SurveyOfOnePhoto();
  survey.photos[0].gps->height_m = kNan;
  const auto tags = TagPositions(survey);
  ASSERT_TRUE(tags[0]);
  EXPECT_NEAR(tags[0]->residual.x(), 2.0, 1e-3);
  EXPECT_NEAR(tags[0]->residual.y(), 0.0, 1e-3);
  EXPECT_TRUE(std::isnan(tags[0]->recorded.z()));
  EXPECT_TRUE(std::isnan(tags[0]->corrected.z()));
  EXPECT_TRUE(std::isnan(tags[0]->residual.z()));
}

TEST(TagPositions, AreEmptyWhereThereIsNothingToCompare) {
  survey::Survey survey = SurveyOfOnePhoto();
  survey.photos.resize(3, survey.photos[0]);
  survey.photos[1].gps.reset();
  survey.photos[2].gps->latitude_deg = kNan;
  auto tags = TagPositions(survey);
  ASSERT_EQ(tags.size(), 3U);
  EXPECT_TRUE(tags[0]);
  EXPECT_FALSE(tags[1]);
  EXPECT_FALSE(tags[2]);
  survey.georeferenced = false;
  tags = TagPositions(survey);
  ASSERT_EQ(tags.size(), 3U);
  EXPECT_FALSE(tags[0]);
}

TEST(PhotosByFlight, AreInTheOrderOfTheirTimes) {
  survey::Survey survey;
  survey.photos.resize(5);
  const std::vector<double> times_s = {30.0, 10.0, 20.0, 5.0};
  for (size_t i = 0; i < times_s.size(); ++i) survey.photos[i].time_s = times_s[i];
  survey.photos[3].flight = 1;
  const auto flights = PhotosByFlight(survey);
  ASSERT_EQ(flights.size(), 2U);
  EXPECT_EQ(flights.at(0), (std::vector<size_t>{4, 1, 2, 0})) << "the one without a time first";
  EXPECT_EQ(flights.at(1), (std::vector<size_t>{3}));
}

}  // namespace
}  // namespace skyquilt::evaluate::control
