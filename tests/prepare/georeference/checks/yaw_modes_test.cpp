#include "prepare/georeference/checks/yaw_modes.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/random.h"

namespace skyquilt::prepare::georeference {
namespace {

using survey::DominantDirections;
using survey::YawDifference;

// Lines along a yaw and across it, each off by some noise.
void AddTown(double yaw_deg, double noise_deg, int n, const Eigen::Vector2d& place, base::Random& random, std::vector<HorizontalLine>* lines) {
  for (int i = 0; i < n; ++i) {
    const double quarter = 90.0 * static_cast<double>(random.Below(4));
    const Eigen::Vector2d off{random.Uniform(-20.0, 20.0), random.Uniform(-20.0, 20.0)};
    lines->push_back({yaw_deg + quarter + random.Uniform(-noise_deg, noise_deg), random.Uniform(4.0, 12.0), place + off});
  }
}

RC_GTEST_PROP(YawModes, FindTheYawOfATown, ()) {
  base::Random random(static_cast<uint64_t>(*rc::gen::inRange(0, 1'000'000)));
  const double yaw_deg = random.Uniform(0.0, 90.0);
  std::vector<HorizontalLine> lines;
  AddTown(yaw_deg, 2.0, 400, {20.0, 20.0}, random, &lines);
  for (int i = 0; i < 200; ++i) lines.push_back({random.Uniform(0.0, 360.0), random.Uniform(1.0, 6.0), {20.0, 20.0}});
  const DominantDirections found = FindDirections(lines, 3);
  RC_ASSERT(!found.modes.empty());
  RC_ASSERT(std::abs(YawDifference(found.modes[0].yaw_deg, yaw_deg)) < 0.6);
  RC_ASSERT(found.modes[0].sigma_deg > 0.0 && found.modes[0].sigma_deg < 0.5);
  RC_ASSERT(found.modes[0].share > 0.6);
  RC_ASSERT(found.ModeNear(yaw_deg + 270.0) == 0);
}

TEST(YawModes, TellDistrictsApart) {
  base::Random random(3);
  std::vector<HorizontalLine> lines;
  AddTown(12.0, 1.5, 300, {20.0, 20.0}, random, &lines);
  AddTown(80.0, 1.5, 200, {220.0, 20.0}, random, &lines);
  const DominantDirections found = FindDirections(lines, 3);
  ASSERT_EQ(found.modes.size(), 2U);
  EXPECT_NEAR(found.modes[0].yaw_deg, 12.0, 0.5);
  EXPECT_NEAR(found.modes[1].yaw_deg, 80.0, 0.5);
  ASSERT_FALSE(found.cells.empty());
  for (const survey::YawCell& cell : found.cells) EXPECT_EQ(cell.mode, cell.min_enu.x() < 120.0 ? 0 : 1) << cell.min_enu.transpose();
}

TEST(YawModes, OfLinesInAnyDirectionThereAreNone) {
  base::Random random(4);
  std::vector<HorizontalLine> lines;
  for (int i = 0; i < 3000; ++i) lines.push_back({random.Uniform(0.0, 360.0), random.Uniform(1.0, 10.0), {0.0, 0.0}});
  const DominantDirections found = FindDirections(lines, 3);
  EXPECT_TRUE(found.modes.empty());
  EXPECT_LT(found.concentration, 0.1);
  EXPECT_TRUE(FindDirections({}, 0).modes.empty());
  EXPECT_EQ(FindDirections({}, 0).ModeNear(10.0), -1);
}

// 89.9 and 0.1 degrees are neighbours.
TEST(YawModes, TheCircleIsClosed) {
  base::Random random(5);
  std::vector<HorizontalLine> lines;
  AddTown(0.0, 1.0, 300, {0.0, 0.0}, random, &lines);
  const DominantDirections found = FindDirections(lines, 1);
  ASSERT_EQ(found.modes.size(), 1U);
  EXPECT_NEAR(YawDifference(found.modes[0].yaw_deg, 0.0), 0.0, 0.3);
  EXPECT_GE(found.modes[0].yaw_deg, 0.0);
  EXPECT_LT(found.modes[0].yaw_deg, 90.0);
  EXPECT_GT(found.concentration, 0.95);
}

TEST(YawModes, AreReadAsWritten) {
  base::Random random(6);
  std::vector<HorizontalLine> lines;
  AddTown(33.0, 1.0, 300, {0.0, 0.0}, random, &lines);
  const DominantDirections found = FindDirections(lines, 7);
  const auto file = std::filesystem::path(testing::TempDir()) / "directions.json";
  survey::SaveDirections(found, file);
  const DominantDirections read = survey::LoadDirections(file);
  EXPECT_EQ(read.photos, 7);
  ASSERT_EQ(read.modes.size(), found.modes.size());
  EXPECT_EQ(read.modes[0].yaw_deg, found.modes[0].yaw_deg);
  EXPECT_EQ(read.cells.size(), found.cells.size());
  EXPECT_EQ(read.histogram, found.histogram);
  base::WriteFileAtomically(file, "{\"photos\": 3");
  EXPECT_THROW(survey::LoadDirections(file), base::InputError);
  EXPECT_TRUE(survey::LoadDirections(file.parent_path() / "absent.json").modes.empty());
}

TEST(Directions, APlaceHasTheYawOfItsCellIfMostLinesFollowIt) {
  survey::DominantDirections directions;
  directions.modes = {{.yaw_deg = 12.0}, {.yaw_deg = 57.0}};
  directions.cell_m = 10.0;
  directions.cells = {{{0.0, 0.0}, 1, 0.8}, {{10.0, 0.0}, 0, 0.4}, {{-10.0, 0.0}, 0, 0.9}};
  EXPECT_EQ(directions.YawAt({3.0, 9.9}), 57.0);
  EXPECT_EQ(directions.YawAt({-0.1, 0.0}), 12.0);
  EXPECT_EQ(directions.YawAt({12.0, 3.0}), std::nullopt) << "no direction prevails";
  EXPECT_EQ(directions.YawAt({3.0, 10.0}), std::nullopt) << "outside all cells";
  EXPECT_EQ(survey::DominantDirections().YawAt({0.0, 0.0}), std::nullopt);
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
