#include "partition/make_blocks.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "partition/altitude.h"
#include "partition/survey_area.h"
#include "tests/partition/facade_survey.h"

namespace skyquilt::partition {
namespace {

std::string MessageOf(const PartitionOptions& options) {
  try {
    MakeBlocks(FlySurvey({}), options, 0);
  } catch (const base::UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(MakeBlocks, CoversTheSurveyOnce) {
  const BlockSet set = MakeBlocks(FlySurvey({}), Request("2x3"), 0);
  ASSERT_EQ(set.blocks.size(), 6U);
  EXPECT_EQ(set.rows, 2);
  EXPECT_EQ(set.columns, 3);
  double area = 0.0;
  double cost = 0.0;
  for (const Block& block : set.blocks) {
    area += (block.max_enu - block.min_enu).head<2>().prod();
    cost += block.cost;
    EXPECT_FALSE(block.empty) << block.name << block.empty_reason;
    EXPECT_GT(block.cost, 0.0);
  }
  EXPECT_NEAR(cost, 1.0, 1e-12);
  EXPECT_EQ(set.blocks[0].name, "r0c0");
  EXPECT_EQ(set.blocks[5].name, "r1c2");
  EXPECT_EQ(set.blocks[0].max_enu.x(), set.blocks[1].min_enu.x()) << "to the last bit";
  EXPECT_EQ(set.blocks[0].max_enu.y(), set.blocks[3].min_enu.y());
  EXPECT_LT(set.blocks[0].min_enu.y(), set.blocks[3].min_enu.y()) << "rows from the south";
  // The ground below the flight and a rim around it, which the outer photos see too.
  EXPECT_GT(area, 0.97 * 200 * 200);
  EXPECT_LT(area, 1.25 * 1.25 * 200 * 200);
}

TEST(MakeBlocks, KeepsTheAccuracyOfTheSurvey) {
  survey::Survey survey = FlySurvey({});
  survey.fit.accuracy = {.scale_percent = 0.4, .tilt_deg = 0.3, .yaw_deg = 0.2, .horizontal_m = 1.5, .vertical_m = 3.0};
  survey.height_reference = geo::HeightReference::kEgm96;
  const BlockSet blocks = MakeBlocks(survey, Request("1x1"), 0);
  EXPECT_EQ(blocks.height_reference, geo::HeightReference::kEgm96);
  const geo::PlaceAccuracy accuracy = blocks.accuracy;
  EXPECT_EQ(accuracy.scale_percent, 0.4);
  EXPECT_EQ(accuracy.tilt_deg, 0.3);
  EXPECT_EQ(accuracy.yaw_deg, 0.2);
  EXPECT_EQ(accuracy.horizontal_m, 1.5);
  EXPECT_EQ(accuracy.vertical_m, 3.0);
}

TEST(MakeBlocks, GroundThatFewPhotosSeeIsLeftOut) {
  survey::Survey survey = FlySurvey({});
  // Keep the photos over the western half only; the points stay everywhere. Their images reach 57 m to each side.
  std::erase_if(survey.photos, [](const survey::Photo& photo) { return photo.cam_from_enu.OriginInSource().x() > 60.0; });
  const BlockSet set = MakeBlocks(survey, Request("1x1"), 0);
  EXPECT_GT(set.blocks[0].max_enu.x(), 88.0);
  EXPECT_LT(set.blocks[0].max_enu.x(), 100.0);
  PartitionOptions by_points = Request("1x1");
  by_points.area = "points";
  EXPECT_GT(MakeBlocks(survey, by_points, 0).blocks[0].max_enu.x(), 195.0);
}

TEST(MakeBlocks, BlocksWithGapsInThePointsGetHeadroom) {
  survey::Survey survey = FlySurvey({});
  const double without = MakeBlocks(survey, Request("1x1"), 0).blocks[0].max_enu.z();
  // A forest without features over a large part of the survey.
  std::erase_if(survey.points, [](const survey::SparsePoint& point) {
    return std::abs(point.x_in_enu.x() - 100.0) < 70.0 && std::abs(point.x_in_enu.y() - 100.0) < 90.0;
  });
  PartitionOptions options = Request("1x1");
  const BlockSet set = MakeBlocks(survey, options, 0);
  EXPECT_NEAR(set.blocks[0].max_enu.z() - without, options.headroom * set.blocks[0].altitude_agl_m, 0.5);
  options.headroom = 0.0;
  EXPECT_NEAR(MakeBlocks(survey, options, 0).blocks[0].max_enu.z(), without, 0.5);
}

TEST(MakeBlocks, LowBlocksAreNotAsTallAsTheTowers) {
  FlownSurveyOptions flown;
  flown.roof_m = 52.0;
  const BlockSet set = MakeBlocks(FlySurvey(flown), Request("3x3"), 0);
  EXPECT_NEAR(set.blocks[0].max_enu.z(), 12.2 + 1.5, 0.3);
  EXPECT_NEAR(set.blocks[0].min_enu.z(), 11.8 - 1.5, 0.3);
  EXPECT_NEAR(set.blocks[8].max_enu.z(), 52.2 + 1.5, 0.3);
  EXPECT_NEAR(set.blocks[8].min_enu.z(), 51.8 - 1.5, 0.3);
  // Towers and ground.
  EXPECT_NEAR(set.blocks[4].max_enu.z(), 52.2 + 1.5, 0.3);
  EXPECT_NEAR(set.blocks[4].min_enu.z(), 11.8 - 1.5, 0.3);
}

TEST(MakeBlocks, HeightsCanBeShared) {
  FlownSurveyOptions flown;
  flown.roof_m = 52.0;
  PartitionOptions options = Request("3x3");
  options.heights = "survey";
  const BlockSet set = MakeBlocks(FlySurvey(flown), options, 0);
  for (const Block& block : set.blocks) {
    EXPECT_EQ(block.min_enu.z(), set.blocks[0].min_enu.z()) << block.name;
    EXPECT_EQ(block.max_enu.z(), set.blocks[0].max_enu.z()) << block.name;
  }
  EXPECT_NEAR(set.blocks[0].min_enu.z(), 11.8 - 1.5, 0.3);
  EXPECT_NEAR(set.blocks[0].max_enu.z(), 52.2 + 1.5, 0.3);
  options.heights = "roof";
  EXPECT_THROW(MakeBlocks(FlySurvey(flown), options, 0), base::UsageError);
}

TEST(MakeBlocks, CapacityFollowsResolution) {
  const survey::Survey survey = FlySurvey({});
  const BlockSet full = MakeBlocks(survey, Request("2x2"), 0);
  const BlockSet half = MakeBlocks(survey, Request("2x2"), 400);
  const Block& block = full.blocks[0];
  EXPECT_NEAR(block.altitude_agl_m, 100.0, 0.5);
  EXPECT_NEAR(block.gsd_m, 100.0 / 700.0, 1e-3);
  EXPECT_NEAR(block.finest_voxel_m, 1.5 * block.gsd_m, 1e-12);
  EXPECT_NEAR(half.blocks[0].gsd_m, 2.0 * block.gsd_m, 1e-9);
  // About 112 x 112 m in voxels of 0.214 m: 2^18.
  EXPECT_EQ(block.log2_table_size, 18);
  EXPECT_EQ(half.blocks[0].log2_table_size, 16);
  EXPECT_NEAR(half.blocks[0].expected_pixels, 0.25 * block.expected_pixels, 1e-6 * block.expected_pixels);
  EXPECT_NE(full.config_hash, half.config_hash);
}

TEST(MakeBlocks, TowersNeedMoreThanFlatGround) {
  FlownSurveyOptions flown;
  flown.n_points = 20000;
  survey::Survey flat = FlySurvey(flown);
  survey::Survey rough = flat;
  // Houses 25 m wide and 25 m high in a chequerboard.
  for (survey::SparsePoint& point : rough.points) {
    const auto cell = static_cast<int>(std::floor(point.x_in_enu.x() / 25.0) + std::floor(point.x_in_enu.y() / 25.0));
    if (cell % 2 == 0) point.x_in_enu.z() += 25.0;
  }
  EXPECT_GT(MakeBlocks(rough, Request("2x2"), 0).blocks[0].log2_table_size, MakeBlocks(flat, Request("2x2"), 0).blocks[0].log2_table_size);
}

TEST(MakeBlocks, GivenAltitudesSetTheResolution) {
  PartitionOptions options = Request("2x2");
  options.altitudes = {150, 300, 450, 600};
  const BlockSet set = MakeBlocks(FlySurvey({}), options, 0);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(set.blocks[i].altitude_agl_m, options.altitudes[i]);
    EXPECT_NEAR(set.blocks[i].gsd_m, options.altitudes[i] / 700.0, 1e-9);
  }
  EXPECT_GT(set.blocks[0].log2_table_size, set.blocks[3].log2_table_size);
}

// Voxels far finer than the photos' pixels could not be told apart by them.
TEST(MakeBlocks, GivenAltitudesMakeVoxelsNoFinerThanThePhotosPixels) {
  PartitionOptions options = Request("1x1");
  const Block flown = MakeBlocks(FlySurvey({}), options, 0).blocks[0];
  EXPECT_EQ(AltitudeDoubt(flown), "");
  options.altitudes = {10.0};
  const Block low = MakeBlocks(FlySurvey({}), options, 0).blocks[0];
  EXPECT_NEAR(low.gsd_m, flown.gsd_m, 0.02 * flown.gsd_m);
  EXPECT_NEAR(low.finest_voxel_m, flown.finest_voxel_m, 0.02 * flown.finest_voxel_m);
  EXPECT_EQ(low.altitude_agl_m, 10.0);
  EXPECT_NEAR(low.flown_agl_m, 100.0, 0.5);
  EXPECT_NE(AltitudeDoubt(low).find("given as 10 m above ground, but its photos were taken from 100 m"), std::string::npos) << AltitudeDoubt(low);
  options.altitudes = {1000.0};
  const Block high = MakeBlocks(FlySurvey({}), options, 0).blocks[0];
  EXPECT_NEAR(high.gsd_m, 10.0 * flown.gsd_m, 0.1 * flown.gsd_m);
  EXPECT_NE(AltitudeDoubt(high).find("detail is lost"), std::string::npos) << AltitudeDoubt(high);
}

TEST(MakeBlocks, AltitudeComesFromThePhotosAboveTheBlock) {
  survey::Survey survey = FlySurvey({});
  for (survey::Photo& photo : survey.photos) {
    Eigen::Vector3d eye = photo.cam_from_enu.OriginInSource();
    if (eye.x() > 100.0) eye.z() += 100.0;
    photo.cam_from_enu.translation = -(photo.cam_from_enu.rotation * eye);
  }
  const BlockSet set = MakeBlocks(survey, Request("1x2"), 0);
  EXPECT_NEAR(set.blocks[0].altitude_agl_m, 100.0, 1.0);
  EXPECT_NEAR(set.blocks[1].altitude_agl_m, 200.0, 1.0);
}

void MoveTo(const Eigen::Vector3d& eye, survey::Photo& photo) {
  photo.cam_from_enu.translation = -(photo.cam_from_enu.rotation * eye);
}

// Held-out photos, every eighth of a flight, taken from 8 m above ground by another camera: no height, resolution, capacity or area follows from
// them.
TEST(MakeBlocks, HeldOutPhotosLeaveNoTrace) {
  const survey::Survey given = FlySurvey({});
  survey::Survey other = given;
  other.cameras.insert(other.cameras.begin(), other.cameras[0].Resized(3200, 2400));
  for (survey::Photo& photo : other.photos) {
    photo.camera = photo.is_test ? 0 : 1;
    if (photo.is_test) MoveTo({0.9 * photo.cam_from_enu.OriginInSource().x() + 15.0, 10.0, 20.0}, photo);
  }
  for (const char* request : {"2x3", "auto"}) {
    PartitionOptions options = Request(request);
    options.max_log2_table_size = 16;
    options.altitudes.assign(std::string(request) == "2x3" ? 6 : 0, 5.0);  // voxels as fine as the lowest photos' pixels
    const BlockSet a = MakeBlocks(given, options, 0), b = MakeBlocks(other, options, 0);
    ASSERT_EQ(b.blocks.size(), a.blocks.size());
    EXPECT_GT(a.blocks.size(), 1U);
    for (size_t i = 0; i < a.blocks.size(); ++i) {
      EXPECT_EQ(b.blocks[i].min_enu, a.blocks[i].min_enu);
      EXPECT_EQ(b.blocks[i].max_enu, a.blocks[i].max_enu);
      EXPECT_EQ(b.blocks[i].flown_agl_m, a.blocks[i].flown_agl_m);
      EXPECT_EQ(b.blocks[i].finest_voxel_m, a.blocks[i].finest_voxel_m);
      EXPECT_EQ(b.blocks[i].log2_table_size, a.blocks[i].log2_table_size);
      EXPECT_EQ(b.blocks[i].photos, a.blocks[i].photos);
      EXPECT_EQ(b.blocks[i].expected_pixels, a.blocks[i].expected_pixels);
      EXPECT_EQ(b.blocks[i].cost, a.blocks[i].cost);
    }
  }
}

// With more held-out photos than others, the camera and the height of most photos would be theirs.
TEST(MakeBlocks, TheCommonCameraAndHeightAreThoseOfTrainingPhotos) {
  survey::Survey survey = FlySurvey({});
  survey.cameras.push_back(survey.cameras[0].Resized(3200, 2400));
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    survey::Photo& photo = survey.photos[i];
    photo.is_test = i % 3 != 0;
    if (!photo.is_test) continue;
    photo.camera = 1;
    MoveTo(photo.cam_from_enu.OriginInSource() + Eigen::Vector3d(0.0, 0.0, 200.0), photo);
  }
  const Block block = MakeBlocks(survey, Request("1x1"), 0).blocks[0];
  EXPECT_NEAR(block.flown_agl_m, 100.0, 0.5);
  EXPECT_NEAR(block.gsd_m, 100.0 / 700.0, 1e-3);
  EXPECT_LE(block.photos.size(), 22U);
  for (const int photo : block.photos) EXPECT_FALSE(survey.photos[static_cast<size_t>(photo)].is_test);
}

TEST(MakeBlocks, AtLeastTwoTrainingPhotosAreNeeded) {
  survey::Survey survey = FlySurvey({});
  for (size_t i = 1; i < survey.photos.size(); ++i) survey.photos[i].is_test = true;
  survey.photos[0].is_test = false;
  try {
    MakeBlocks(survey, Request("1x1"), 0);
    FAIL();
  } catch (const base::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("1 photo(s) with a pose that are not held out"), std::string::npos) << error.what();
  }
}

TEST(MakeBlocks, AutoSplitsUntilTablesFit) {
  PartitionOptions options = Request("auto");
  const BlockSet one = MakeBlocks(FlySurvey({}), options, 200);
  EXPECT_EQ(one.blocks.size(), 1U);
  options.max_log2_table_size = 15;
  const BlockSet several = MakeBlocks(FlySurvey({}), options, 400);
  EXPECT_GT(several.blocks.size(), 2U);
}

// Twelve photos at eye level: the size of a pixel follows from the distance to the wall, and their pixels train two blocks. By the height above
// ground voxels would be seven times as fine, and the surface would fill hundreds of blocks.
TEST(MakeBlocks, AFacadeIsSeenFromItsDistanceAndHasFewBlocks) {
  const survey::Survey survey = FacadeSurvey();
  const BlockSet set = MakeBlocks(survey, PartitionOptions(), 0);
  EXPECT_LE(set.blocks.size(), 2U);
  EXPECT_NE(set.number_reason.find("pixels can train"), std::string::npos) << set.number_reason;
  EXPECT_FALSE(set.area_is_that_of_points);
  for (const Block& block : set.blocks) {
    EXPECT_FALSE(block.empty) << block.empty_reason;
    EXPECT_NEAR(block.gsd_m, kFromWall_m / kFacadeFocal_px, 0.05 * kFromWall_m / kFacadeFocal_px);
    EXPECT_NEAR(block.altitude_agl_m, kFromWall_m, 0.1 * kFromWall_m);
    EXPECT_EQ(AltitudeDoubt(block), "");
  }
  // The whole wall.
  EXPECT_LT(set.blocks.front().min_enu.x(), 3.0);
  EXPECT_GT(set.blocks.back().max_enu.x(), 46.0);
  EXPECT_LT(set.blocks.front().min_enu.y(), kFromWall_m);
  EXPECT_GT(set.blocks.front().max_enu.y(), kFromWall_m);
  EXPECT_EQ(MakeBlocks(survey, PartitionOptions(), 0, 2000.0).blocks.size(), 1U) << "steps for one block";
}

TEST(MakeBlocks, SurveysThatLookDownKeepTheirBlocks) {
  survey::Survey by_height = FlySurvey({}), by_points = by_height;
  ObserveAll(&by_points);
  PartitionOptions options;
  for (const int log2 : {13, 15, 17}) {
    options.max_log2_table_size = options.min_log2_table_size = log2;
    for (const int width : {0, 400, 200}) {
      const BlockSet a = MakeBlocks(by_height, options, width), b = MakeBlocks(by_points, options, width);
      EXPECT_EQ(b.rows, a.rows);
      EXPECT_EQ(b.columns, a.columns);
      EXPECT_EQ(b.number_reason, "as few as hold the surface in their tables") << b.rows << " x " << b.columns;
      for (size_t i = 0; i < a.blocks.size(); ++i) {
        EXPECT_NEAR(b.blocks[i].gsd_m, a.blocks[i].gsd_m, 0.01 * a.blocks[i].gsd_m);
        EXPECT_NEAR(b.blocks[i].altitude_agl_m, a.blocks[i].altitude_agl_m, 1e-4 * a.blocks[i].altitude_agl_m);
      }
    }
  }
}

// Where obliques are rare, the photos that look down decide; where all are oblique, the ground is farther away than the flight is high.
TEST(MakeBlocks, ObliquePhotosAreFartherFromTheGroundThanHigh) {
  survey::Survey survey = FlySurvey({});
  const auto tilt = [&survey](size_t every) {
    for (size_t i = 0; i < survey.photos.size(); i += every) {
      survey::Photo& photo = survey.photos[i];
      const Eigen::Vector3d eye = photo.cam_from_enu.OriginInSource();
      photo.cam_from_enu.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(-0.785398, Eigen::Vector3d::UnitX())) * photo.cam_from_enu.rotation;
      photo.cam_from_enu.translation = -(photo.cam_from_enu.rotation * eye);
    }
    ObserveAll(&survey);
    return MakeBlocks(survey, Request("1x1"), 0).blocks[0].gsd_m * 700.0;
  };
  EXPECT_NEAR(tilt(5), 100.0, 3.0);
  survey = FlySurvey({});
  const double all_m = tilt(1);
  EXPECT_GT(all_m, 115.0);
  EXPECT_LT(all_m, 160.0);
}

TEST(MakeBlocks, ATimeBudgetLimitsTheBlocks) {
  PartitionOptions options = Request("auto");
  options.max_log2_table_size = 15;
  const auto with = [&options](double steps) { return MakeBlocks(FlySurvey({}), options, 400, steps); };
  const BlockSet unlimited = MakeBlocks(FlySurvey({}), options, 400);
  EXPECT_GT(unlimited.blocks.size(), 4U);
  EXPECT_NE(unlimited.number_reason.find("as few as"), std::string::npos) << unlimited.number_reason;
  EXPECT_EQ(with(1e7).blocks.size(), unlimited.blocks.size());
  // Three minutes on two threads (ExpectedBlockSteps).
  const BlockSet short_time = with(7470.0);
  EXPECT_LE(short_time.blocks.size(), 4U);
  EXPECT_NE(short_time.number_reason.find("time budget can train"), std::string::npos) << short_time.number_reason;
  for (const Block& block : short_time.blocks) EXPECT_GE(block.cost * 7470.0, 500.0);
  size_t last = 1;
  for (const double steps : {0.0, 1000.0, 3500.0, 7470.0, 10000.0, 15000.0, 1e5}) {
    const BlockSet set = with(steps);
    EXPECT_GE(set.blocks.size(), last) << steps;
    last = set.blocks.size();
  }
  options.blocks = "3x3";
  EXPECT_EQ(with(100.0).blocks.size(), 9U);
  EXPECT_EQ(with(100.0).number_reason, "as asked for");
}

// Photos that look level away from all points show no ground.
TEST(FindSurveyArea, SaysWhereItIsThatOfThePoints) {
  survey::Survey survey = FacadeSurvey();
  EXPECT_FALSE(FindSurveyArea(survey, ReliablePoints(survey), "covered", 2).by_points);
  for (survey::Photo& photo : survey.photos) {
    const Eigen::Vector3d eye = photo.cam_from_enu.OriginInSource() - Eigen::Vector3d(0.0, 100.0, 0.0);
    photo.cam_from_enu.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(3.14159265, Eigen::Vector3d::UnitY())) * photo.cam_from_enu.rotation;
    MoveTo(eye, photo);
  }
  const SurveyArea area = FindSurveyArea(survey, ReliablePoints(survey), "covered", 2);
  EXPECT_TRUE(area.by_points);
  EXPECT_GT(area.max_enu.x() - area.min_enu.x(), 45.0);
}

// Three times their height of 1.6 m reaches nothing of what they show.
TEST(FindSurveyArea, LevelPhotosReachWhatTheySee) {
  survey::Survey survey = FacadeSurvey();
  const SurveyArea area = FindSurveyArea(survey, ReliablePoints(survey), "points", 2);
  EXPECT_FALSE(area.by_points);
  EXPECT_NEAR(area.CoveredArea({15.0, kFromWall_m - 0.3}, {30.0, kFromWall_m + 0.3}), 15.0 * 0.6, 1e-6);
  // The foot of the wall alone, so that the photos' heights above it are known and reach too short.
  for (survey::SparsePoint& point : survey.points) {
    point.x_in_enu.y() = kFromWall_m + 0.03 * (point.x_in_enu.y() - kFromWall_m);
    point.x_in_enu.z() = 0.0;
  }
  EXPECT_FALSE(FindSurveyArea(survey, ReliablePoints(survey), "points", 2).by_points);
  survey.tracks = {};
  EXPECT_TRUE(FindSurveyArea(survey, ReliablePoints(survey), "points", 2).by_points);
}

TEST(MakeBlocks, VoxelsThatShareEntriesMakeTablesSmaller) {
  PartitionOptions options = Request("2x2");
  const int exact = MakeBlocks(FlySurvey({}), options, 0).blocks[0].log2_table_size;
  options.voxels_per_entry = 4.0;
  EXPECT_EQ(MakeBlocks(FlySurvey({}), options, 0).blocks[0].log2_table_size, exact - 2);
  options.voxels_per_entry = 0.0;
  EXPECT_NE(MessageOf(options).find("partition.voxels_per_entry"), std::string::npos);
}

TEST(MakeBlocks, CrowdedTablesMakeAutomaticBlocksLarger) {
  PartitionOptions options = Request("auto");
  options.max_log2_table_size = 15;
  size_t blocks = std::numeric_limits<size_t>::max();
  for (const double shared : {1.0, 4.0, 16.0}) {
    options.max_voxels_per_entry = shared;
    const BlockSet set = MakeBlocks(FlySurvey({}), options, 400);
    EXPECT_LT(set.blocks.size(), blocks) << shared;
    blocks = set.blocks.size();
  }
  options.max_voxels_per_entry = 0.0;
  EXPECT_NE(MessageOf(options).find("partition.max_voxels_per_entry"), std::string::npos);
}

TEST(MakeBlocks, EmptyBlocksAreNamedAndSkipped) {
  FlownSurveyOptions flown;
  flown.empty_east = true;
  survey::Survey survey = FlySurvey(flown);
  // A few outlying points widen the bounds; none of them is in the north-eastern block.
  for (int i = 0; i < 200; ++i) {
    survey::SparsePoint point;
    point.x_in_enu = {199.0, 1.0 + 0.2 * i, 12.0};
    point.track_length = 5;
    survey.points.push_back(point);
  }
  const BlockSet set = MakeBlocks(survey, Request("3x3"), 0);
  const Block& north_east = set.blocks[8];
  EXPECT_EQ(north_east.name, "r2c2");
  EXPECT_TRUE(north_east.empty);
  EXPECT_EQ(north_east.empty_reason, "no sparse point is inside it");
  EXPECT_EQ(north_east.cost, 0.0);
  EXPECT_TRUE(north_east.photos.empty());
  EXPECT_FALSE(set.blocks[0].empty);
}

TEST(MakeBlocks, ABlockNobodyPhotographedIsEmpty) {
  survey::Survey survey = FlySurvey({});
  std::erase_if(survey.photos, [](const survey::Photo& photo) { return photo.cam_from_enu.OriginInSource().x() > 60.0; });
  PartitionOptions options = Request("1x4");
  options.area = "points";
  const BlockSet set = MakeBlocks(survey, options, 0);
  EXPECT_TRUE(set.blocks[3].empty);
  EXPECT_EQ(set.blocks[3].empty_reason, "no training photo sees it");
  EXPECT_FALSE(set.blocks[0].empty);
}

TEST(MakeBlocks, WrongRequestsAreClear) {
  PartitionOptions options = Request("2x2");
  options.altitudes = {150, -20, 300, 300};
  EXPECT_NE(MessageOf(options).find("altitudes[1] = -20"), std::string::npos) << MessageOf(options);
  options.altitudes = {150, std::nan(""), 300, 300};
  EXPECT_NE(MessageOf(options).find("altitudes[1]"), std::string::npos);
  options.altitudes = {150, 300, 300};
  EXPECT_NE(MessageOf(options).find("3 altitude(s)"), std::string::npos) << MessageOf(options);
  EXPECT_NE(MessageOf(options).find("4 block(s)"), std::string::npos);
  options = Request("size:50");
  options.altitudes = {150};
  EXPECT_NE(MessageOf(options).find("1 altitude(s)"), std::string::npos);
  for (const char* blocks : {"0x2", "size:0", "size:-10", "size:nan", "2by2"}) EXPECT_NE(MessageOf(Request(blocks)), "") << blocks;
  options = Request("1x1");
  options.voxel_per_gsd = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(MessageOf(options).find("voxel_per_gsd"), std::string::npos);
  options = Request("1x1");
  options.min_log2_table_size = 20;
  EXPECT_NE(MessageOf(options).find("min_log2_table_size"), std::string::npos);
  EXPECT_THROW(MakeBlocks(FlySurvey({}), Request("1x1"), -3), base::UsageError);
}

TEST(MakeBlocks, SurveysWithoutAreaAreRefused) {
  survey::Survey no_points = FlySurvey({});
  no_points.points.clear();
  EXPECT_THROW(MakeBlocks(no_points, Request("1x1"), 0), base::InputError);
  survey::Survey no_photos = FlySurvey({});
  no_photos.photos.clear();
  EXPECT_THROW(MakeBlocks(no_photos, Request("1x1"), 0), base::InputError);
  survey::Survey one_place = FlySurvey({});
  for (survey::SparsePoint& point : one_place.points) point.x_in_enu = {3, 3, 3};
  EXPECT_THROW(MakeBlocks(one_place, Request("1x1"), 0), base::InputError);
}

// The same survey a thousand times smaller or larger gives the same partition: nothing but the margins depends on absolute metres.
RC_GTEST_PROP(MakeBlocks, WorksAtAnyScale, ()) {
  const double scale = std::pow(10.0, *rc::gen::inRange(-2, 4));
  FlownSurveyOptions flown;
  flown.width_m *= scale;
  flown.height_m *= scale;
  flown.agl_m *= scale;
  flown.n_points = 2000;
  const BlockSet set = MakeBlocks(FlySurvey(flown), Request("2x2"), 0);
  for (const Block& block : set.blocks) {
    RC_ASSERT(!block.empty);
    RC_ASSERT(block.log2_table_size >= 17 && block.log2_table_size <= 19);
    const Eigen::Vector3d extent = block.max_enu - block.min_enu;
    RC_ASSERT(block.margin_m > 0.0 && block.margin_m <= 0.2501 * extent.head<2>().minCoeff());
    RC_ASSERT(extent.z() > 16.0 * block.gsd_m);
    RC_ASSERT(extent.allFinite());
  }
}

}  // namespace
}  // namespace skyquilt::partition
