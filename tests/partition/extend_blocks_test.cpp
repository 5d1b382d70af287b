#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "partition/make_blocks.h"
#include "tests/partition/facade_survey.h"

namespace skyquilt::partition {
namespace {

// The survey with the photos and points of another behind its own, moved by so many metres.
survey::Survey WithZone(survey::Survey survey, const survey::Survey& zone, const Eigen::Vector3d& by) {
  for (survey::Photo photo : zone.photos) {
    photo.name = "zone2/" + photo.name;
    photo.cam_from_enu.translation -= photo.cam_from_enu.rotation * by;
    survey.photos.push_back(photo);
  }
  for (survey::SparsePoint point : zone.points) {
    point.x_in_enu += by;
    survey.points.push_back(point);
  }
  return survey;
}

void ExpectSame(const Block& a, const Block& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.min_enu, b.min_enu);
  EXPECT_EQ(a.max_enu, b.max_enu);
  EXPECT_EQ(a.margin_m, b.margin_m);
  EXPECT_EQ(a.gsd_m, b.gsd_m);
  EXPECT_EQ(a.finest_voxel_m, b.finest_voxel_m);
  EXPECT_EQ(a.log2_table_size, b.log2_table_size);
  EXPECT_EQ(a.photos, b.photos);
}

TEST(ExtendBlocks, KeepsWhatNoAddedPhotoSeesAndAddsColumnsOfTheSameSize) {
  const survey::Survey survey = FlySurvey({.agl_m = 45.0});  // a photo shows 51 m
  const BlockSet earlier = MakeBlocks(survey, Request("2x4"), 0);
  const survey::Survey more = WithZone(survey, FlySurvey({.width_m = 100.0, .agl_m = 45.0}), {200.0, 0.0, 0.0});
  const BlockSet set = ExtendBlocks(more, earlier, Request("2x4"));
  EXPECT_EQ(set.rows, 2);
  ASSERT_EQ(set.columns, 6);
  double cost = 0.0;
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 6; ++column) {
      const Block& block = set.blocks[static_cast<size_t>(row * 6 + column)];
      EXPECT_EQ(block.id, row * 6 + column);
      EXPECT_EQ(block.name, "r" + std::to_string(row) + "c" + std::to_string(column));
      EXPECT_FALSE(block.empty);
      cost += block.cost;
      if (column >= 4) continue;
      const Block& before = earlier.blocks[static_cast<size_t>(row * 4 + column)];
      EXPECT_EQ(block.min_enu.head<2>(), before.min_enu.head<2>());
      EXPECT_EQ(block.max_enu.head<2>(), before.max_enu.head<2>());
      if (column < 2) ExpectSame(block, before);
      if (column == 3) EXPECT_GT(block.photos.size(), before.photos.size()) << "photos of the new zone see the border";
    }
    EXPECT_EQ(set.blocks[static_cast<size_t>(row * 6 + 3)].max_enu.x(), set.blocks[static_cast<size_t>(row * 6 + 4)].min_enu.x());
  }
  EXPECT_NEAR(cost, 1.0, 1e-12);
  const double side = earlier.blocks[0].max_enu.x() - earlier.blocks[0].min_enu.x(), added = set.blocks[4].max_enu.x() - set.blocks[4].min_enu.x();
  EXPECT_NEAR(added / side, 1.0, 0.35);
}

TEST(ExtendBlocks, CountsBackwardsToTheWestAndSouthAndGoesOnFromThere) {
  const survey::Survey survey = FlySurvey({.agl_m = 30.0});
  const survey::Survey zone = FlySurvey({.agl_m = 30.0});
  const BlockSet earlier = MakeBlocks(survey, Request("2x2"), 0);
  const survey::Survey more = WithZone(survey, zone, {-200.0, -200.0, 0.0});
  const BlockSet second = ExtendBlocks(more, earlier, Request("2x2"));
  ASSERT_EQ(second.rows, 4);
  ASSERT_EQ(second.columns, 4);
  EXPECT_EQ(second.blocks[0].name, "r-2c-2");
  ExpectSame(second.blocks[15], earlier.blocks[3]);
  EXPECT_TRUE(second.blocks[2].empty) << "no photo was taken there";
  const BlockSet third = ExtendBlocks(WithZone(more, zone, {-400.0, -200.0, 0.0}), second, Request("2x2"));
  ASSERT_EQ(third.columns, 6);
  EXPECT_EQ(third.blocks[0].name, "r-2c-4");
  ExpectSame(third.blocks[23], earlier.blocks[3]);
}

TEST(ExtendBlocks, WithoutNewPhotosIsTheSameAgain) {
  const survey::Survey survey = FlySurvey({});
  const BlockSet earlier = MakeBlocks(survey, Request("2x3"), 0);
  const BlockSet again = ExtendBlocks(survey, earlier, Request("2x3"));
  ASSERT_EQ(again.blocks.size(), earlier.blocks.size());
  for (size_t i = 0; i < again.blocks.size(); ++i) {
    ExpectSame(again.blocks[i], earlier.blocks[i]);
    EXPECT_DOUBLE_EQ(again.blocks[i].cost, earlier.blocks[i].cost);
  }
}

TEST(ExtendBlocks, RefusesGivenHeightsAndZonesTooFarAway) {
  const survey::Survey survey = FlySurvey({});
  PartitionOptions options = Request("1x2");
  const BlockSet earlier = MakeBlocks(survey, options, 0);
  options.altitudes = {50.0, 60.0};
  EXPECT_THROW(ExtendBlocks(survey, earlier, options), base::UsageError);
  EXPECT_THROW(ExtendBlocks(WithZone(survey, survey, {1e6, 1e6, 0.0}), earlier, Request("1x2")), base::UsageError);
}

}  // namespace
}  // namespace skyquilt::partition
