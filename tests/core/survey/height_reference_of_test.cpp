#include <gtest/gtest.h>

#include <limits>

#include "core/survey/tagged_heights.h"

namespace skyquilt::survey {
namespace {

PhotoTags Tags(double height_m) {
  PhotoTags tags;
  tags.gps = geo::Geodetic{52.0, -1.5, height_m};
  return tags;
}
PhotoTags Rtk() {
  PhotoTags tags = Tags(150.0);
  tags.absolute_altitude_m = 150.0;
  tags.rtk = true;
  return tags;
}
PhotoTags Dji() {
  PhotoTags tags = Tags(101.5);
  tags.absolute_altitude_m = 101.5;
  return tags;
}

TEST(TaggedHeights, FollowTheKindOfTags) {
  EXPECT_EQ(JudgeTaggedHeights({Rtk(), Rtk()}), TaggedHeights::kEllipsoid);
  EXPECT_EQ(JudgeTaggedHeights({Dji()}), TaggedHeights::kEgm96);
  EXPECT_EQ(JudgeTaggedHeights({Tags(101.5)}), TaggedHeights::kUnknown);
  EXPECT_EQ(JudgeTaggedHeights({}), TaggedHeights::kUnknown);
}

TEST(TaggedHeights, AreThoseOfMostPhotosWithOne) {
  const PhotoTags without = Tags(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(JudgeTaggedHeights({Rtk(), Rtk(), Dji()}), TaggedHeights::kEllipsoid);
  EXPECT_EQ(JudgeTaggedHeights({Rtk(), Dji()}), TaggedHeights::kUnknown);
  EXPECT_EQ(JudgeTaggedHeights({Dji(), without, PhotoTags(), without}), TaggedHeights::kEgm96);
}

TEST(TaggedHeights, OfPositionsFromAFileAreNotThoseOfTheTags) {
  PhotoTags replaced = Dji();
  replaced.gps->height_m = 149.9;
  EXPECT_EQ(JudgeTaggedHeights({replaced}), TaggedHeights::kUnknown);
}

Survey Placed() {
  Survey survey;
  survey.georeferenced = true;
  survey.fit.accuracy.horizontal_m = 1.5;
  survey.fit.accuracy.vertical_m = 3.0;
  return survey;
}

TEST(HeightReference, OfASurveyComesFromWhatPlacedIt) {
  using geo::HeightReference;
  Survey survey = Placed();
  EXPECT_EQ(HeightReferenceOf(survey, {Dji()}), HeightReference::kEgm96);
  EXPECT_EQ(HeightReferenceOf(survey, {Rtk()}), HeightReference::kEllipsoid);
  EXPECT_EQ(HeightReferenceOf(survey, {Tags(3.0)}), HeightReference::kUnknown);
  survey.fit.accuracy.vertical_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(HeightReferenceOf(survey, {Rtk()}), HeightReference::kUnknown) << "heights above the take-off point";
  survey.control.placed = true;
  EXPECT_EQ(HeightReferenceOf(survey, {Dji()}), HeightReference::kEllipsoid);
  survey = Placed();
  survey.truth = Truth{};
  EXPECT_EQ(HeightReferenceOf(survey, {Dji()}), HeightReference::kEllipsoid);
  survey.georeferenced = false;
  EXPECT_EQ(HeightReferenceOf(survey, {Rtk()}), HeightReference::kUnknown);
}

}  // namespace
}  // namespace skyquilt::survey
