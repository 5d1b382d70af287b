#include "core/survey/tagged_heights.h"

#include <gtest/gtest.h>

#include <cmath>

namespace skyquilt::survey {
namespace {

PhotoTags Tags(double height_m, std::optional<double> absolute_m, bool rtk) {
  PhotoTags tags;
  tags.gps = geo::Geodetic{47.0, 8.0, height_m};
  tags.absolute_altitude_m = absolute_m;
  tags.rtk = rtk;
  return tags;
}

TEST(TaggedHeights, OfOnePhoto) {
  EXPECT_EQ(TaggedHeightsOf(Tags(100.0, 100.0, true)), TaggedHeights::kEllipsoid);
  EXPECT_EQ(TaggedHeightsOf(Tags(100.0, 100.0, false)), TaggedHeights::kEgm96);
  EXPECT_EQ(TaggedHeightsOf(Tags(100.0, std::nullopt, false)), TaggedHeights::kUnknown);
  // A position from a file takes the place of the tag.
  EXPECT_EQ(TaggedHeightsOf(Tags(148.0, 100.0, false)), TaggedHeights::kUnknown);
  EXPECT_EQ(TaggedHeightsOf(Tags(std::nan(""), 100.0, true)), TaggedHeights::kUnknown);
  EXPECT_EQ(TaggedHeightsOf(PhotoTags()), TaggedHeights::kUnknown);
}

TEST(TaggedHeights, OfASurveyAreThoseOfMostPhotos) {
  const PhotoTags rtk = Tags(100.0, 100.0, true), barometric = Tags(90.0, 90.0, false), exif = Tags(90.0, std::nullopt, false);
  EXPECT_EQ(JudgeTaggedHeights({}), TaggedHeights::kUnknown);
  EXPECT_EQ(JudgeTaggedHeights({rtk, rtk, barometric, PhotoTags(), PhotoTags()}), TaggedHeights::kEllipsoid);
  EXPECT_EQ(JudgeTaggedHeights({rtk, barometric, barometric}), TaggedHeights::kEgm96);
  EXPECT_EQ(JudgeTaggedHeights({rtk, barometric}), TaggedHeights::kUnknown);
  EXPECT_EQ(JudgeTaggedHeights({exif, exif, rtk}), TaggedHeights::kUnknown);
}

TEST(TaggedHeights, HaveNames) {
  EXPECT_STREQ(NameOf(TaggedHeights::kEllipsoid), "ellipsoid");
  EXPECT_STREQ(NameOf(TaggedHeights::kEgm96), "egm96");
  EXPECT_STREQ(NameOf(TaggedHeights::kUnknown), "unknown");
}

}  // namespace
}  // namespace skyquilt::survey
