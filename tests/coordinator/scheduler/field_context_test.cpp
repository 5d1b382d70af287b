#include "coordinator/scheduler/field_context.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

namespace skyquilt::coordinator {
namespace {

// n blocks of 100 m side by side, one of them with the largest tables.
partition::BlockSet RowOfBlocks(size_t n) {
  partition::BlockSet set;
  for (size_t i = 0; i < n; ++i) {
    partition::Block block;
    block.name = "b" + std::to_string(i);
    block.min_enu = {100.0 * static_cast<double>(i), 0.0, 0.0};
    block.max_enu = {100.0 * static_cast<double>(i + 1), 100.0, 30.0};
    block.log2_table_size = i == 0 ? 18 : 16;
    block.finest_voxel_m = 0.1;
    set.blocks.push_back(block);
  }
  return set;
}

TEST(SpecOfSurvey, SmallSurveysHaveHalfTheTablesOfTheirLargestBlock) {
  Settings settings;
  settings.run.memory_gb = 16.0;
  const worker::BlockSpec one = SpecOfSurvey(RowOfBlocks(1), {}, "blocks.geojson", settings);
  EXPECT_EQ(one.log2_table_size, 17);
  EXPECT_DOUBLE_EQ(one.finest_voxel_m, 0.2);  // twice a block's
  const worker::BlockSpec many = SpecOfSurvey(RowOfBlocks(127), {}, "blocks.geojson", settings);
  EXPECT_EQ(many.log2_table_size, 17);
  EXPECT_DOUBLE_EQ(many.finest_voxel_m, 12'700.0 / 1024.0);
}

TEST(SpecOfSurvey, TablesGrowWithTheSurveyAndVoxelsShrink) {
  Settings settings;
  settings.run.memory_gb = 64.0;
  const worker::BlockSpec twice = SpecOfSurvey(RowOfBlocks(128), {}, "blocks.geojson", settings);
  EXPECT_EQ(twice.log2_table_size, 18);
  EXPECT_DOUBLE_EQ(twice.finest_voxel_m, 12'800.0 / (1024.0 * std::sqrt(2.0)));
  EXPECT_EQ(SpecOfSurvey(RowOfBlocks(400), {}, "blocks.geojson", settings).log2_table_size, 19);
  EXPECT_EQ(SpecOfSurvey(RowOfBlocks(1600), {}, "blocks.geojson", settings).log2_table_size, 20);
}

RC_GTEST_PROP(ContextDoublingsProperty, NeverFallWithBlocksOrMemory, ()) {
  Settings settings;
  settings.run.threads = *rc::gen::inRange(1, 65);
  settings.run.memory_gb = *rc::gen::element(0.1, 1.0, 4.0, 64.0);
  const auto blocks = *rc::gen::inRange<size_t>(0, 3000);
  const int log2 = *rc::gen::inRange(1, 25);
  const int doublings = ContextDoublings(blocks, log2, settings);
  RC_ASSERT(doublings >= 0 && doublings <= 3);
  RC_ASSERT(log2 + doublings <= 24);
  RC_ASSERT(ContextDoublings(2 * blocks, log2, settings) >= doublings);
  if (blocks < 128) RC_ASSERT(doublings == 0);
  settings.run.memory_gb *= 2.0;
  RC_ASSERT(ContextDoublings(blocks, log2, settings) >= doublings);
}

TEST(ContextDoublings, StayWithinMemory) {
  Settings settings;
  settings.run.threads = 2;
  settings.run.memory_gb = 0.2;
  EXPECT_EQ(ContextDoublings(1600, 20, settings), 0);
}

TEST(SurveyBytes, GrowWithPointsAndTheirPhotos) {
  survey::Survey survey;
  const double empty = SurveyBytes(survey);
  survey.points.resize(1000);
  const double points = SurveyBytes(survey);
  EXPECT_GE(points - empty, 1000.0 * sizeof(survey::SparsePoint));
  for (int i = 0; i < 1000; ++i) survey.tracks.Add({0, 1, 2});
  EXPECT_GE(SurveyBytes(survey) - points, 3000.0 * sizeof(int32_t));
}

}  // namespace
}  // namespace skyquilt::coordinator
