#include "coordinator/planning/work_size.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "tests/support/nadir_photo.h"

namespace skyquilt::coordinator {
namespace {

// Three photos of 2,000 pixels with a focal length of as many, 40 to 60 m above ground; the last is held out.
survey::Survey Flight(bool level) {
  survey::Survey survey;
  survey.cameras.push_back({.model = camera::CameraModel::kPinhole, .width = 2000, .height = 1500, .params = {2000.0, 2000.0, 1000.0, 750.0}});
  for (const double agl_m : {40.0, 50.0, 60.0}) {
    const Eigen::Vector3d eye(agl_m, 0.0, agl_m);
    const std::string name = std::to_string(survey.photos.size());
    survey.photos.push_back(level ? LevelPhoto(eye, name) : NadirPhoto(eye, name));
    survey.photos.back().agl_m = agl_m;
  }
  survey.photos.back().is_test = true;
  return survey;
}

TEST(WorkSize, KnowsTheGroundSamplingDistanceBeforeThereAreBlocks) {
  WorkSize size;
  CountSurvey(Flight(false), &size);
  EXPECT_EQ(size.photos, 3);
  EXPECT_EQ(size.held_out, 1);
  EXPECT_EQ(size.photo_width, 2000);
  EXPECT_NEAR(size.photo_gsd_m, 0.025, 1e-12);
  EXPECT_NEAR(size.GsdAt(0), 0.025, 1e-12);
  EXPECT_NEAR(size.GsdAt(500), 0.1, 1e-12);
  EXPECT_NEAR(size.GsdAt(4000), 0.025, 1e-12);
}

TEST(WorkSize, TakesTheGroundSamplingDistanceOfTheFinestBlock) {
  WorkSize size;
  CountSurvey(Flight(false), &size);
  partition::BlockSet blocks;
  blocks.image_width = 1000;
  for (const double gsd_m : {0.08, 0.06, 0.01}) {
    partition::Block block;
    block.min_enu = Eigen::Vector3d::Zero();
    block.max_enu = {60.0, 60.0, 20.0};
    block.gsd_m = gsd_m;
    block.empty = gsd_m < 0.05;
    block.log2_table_size = 15;
    blocks.blocks.push_back(block);
  }
  CountBlocks(blocks, &size);
  EXPECT_EQ(size.blocks, 2);
  EXPECT_NEAR(size.GsdAt(1000), 0.06, 1e-12);
  EXPECT_NEAR(size.photo_gsd_m, 0.03, 1e-12);
  // Pixels of full photos: four for each at half their width.
  EXPECT_NEAR(size.surface_pixels, 4.0 * (60.0 * 60.0 / (0.08 * 0.08) + 1e6), 1.0);
}

TEST(WorkSize, LevelPhotosHaveNoGroundSamplingDistance) {
  WorkSize size;
  CountSurvey(Flight(true), &size);
  EXPECT_TRUE(size.level);
  EXPECT_EQ(size.photo_gsd_m, 0.0);
}

TEST(WorkSize, WithoutHeightsNoGroundSamplingDistanceIsKnown) {
  survey::Survey survey = Flight(false);
  for (survey::Photo& photo : survey.photos) photo.agl_m = std::numeric_limits<double>::quiet_NaN();
  WorkSize size;
  CountSurvey(survey, &size);
  EXPECT_EQ(size.photo_gsd_m, 0.0);
}

}  // namespace
}  // namespace skyquilt::coordinator
