// Trains real fields on a small synthetic survey: a checkered ground with a box on it, seen straight down and from the side.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "core/base/errors.h"
#include "core/scene/field_file.h"
#include "tests/support/error_of.h"
#include "tests/worker/small_survey.h"
#include "worker/block_session.h"
#include "worker/start/starting_occupancy.h"
#include "worker/start/surface_interval.h"
#include "worker/trainer.h"

namespace skyquilt::worker {
namespace {

namespace fs = std::filesystem;

using TrainBlockTest = SmallSurvey;

TEST_F(TrainBlockTest, LearnsTheSceneThroughContextAndBlock) {
  base::ThreadPool threads(2);
  const TrainResult context = TrainContext(Job("context.h5", 400), Box(20.0, 0.0), threads, {});
  ASSERT_TRUE(context.ok) << context.reason;
  const TrainResult block = TrainBlock(Job("block.h5", 1200), Box(12.0, 1.0), folder_ / "context.h5", threads, {});
  ASSERT_TRUE(block.ok) << block.reason;
  EXPECT_EQ(block.steps, 1200);
  EXPECT_GT(block.final_psnr_db, 25.0);
  EXPECT_EQ(block.dropped_steps, 0);

  // The held-out nadir ray over the box's middle ends on its roof, one beside it on the ground.
  const LoadedContext loaded = LoadContext(folder_ / "context.h5");
  ASSERT_TRUE(loaded.HasSurfaceIntervals(survey_));
  // Some photos' surfaces can be read alone.
  const std::vector<int> some = {3, 0, 1};
  const LoadedContext part = LoadContext(folder_ / "context.h5", &some);
  ASSERT_TRUE(part.HasSurfaceIntervals(survey_));
  EXPECT_EQ(part.bands.size(), 3U * kTilesOfPhoto);
  for (const int photo : some) {
    EXPECT_EQ(std::memcmp(&part.Band(photo, 0, 0), &loaded.Band(photo, 0, 0), kTilesOfPhoto * sizeof(SurfaceInterval)), 0) << photo;
  }
  const std::vector<render::RayColor> out = RoofAndGround(threads);
  EXPECT_NEAR(out[0].depth_median, 26.0F, 1.0F);
  EXPECT_NEAR(out[1].depth_median, 30.0F, 1.0F);
  EXPECT_GT(out[0].rgb_srgb[0], out[0].rgb_srgb[1] + 0.3F);
}

TEST_F(TrainBlockTest, BitsDoNotDependOnThreadsNorOnInterruption) {
  base::ThreadPool one(1), three(3);
  TrainContext(Job("context.h5", 60), Box(20.0, 0.0), one, {});
  TrainBlock(Job("a.h5", 90), Box(12.0, 1.0), folder_ / "context.h5", one, {});
  TrainBlock(Job("b.h5", 90), Box(12.0, 1.0), folder_ / "context.h5", three, {});
  EXPECT_EQ(Bytes("a.h5"), Bytes("b.h5"));
  // Interrupted, then resumed by the same call.
  TrainInterrupted(Job("c.h5", 90), [&](const TrainJob& job) { TrainBlock(job, Box(12.0, 1.0), folder_ / "context.h5", one, {}); });
  EXPECT_EQ(Bytes("a.h5"), Bytes("c.h5"));
}

TEST_F(TrainBlockTest, FinishedFieldsAreNotTrainedAgainAndOtherConfigurationsAreRefused) {
  base::ThreadPool threads(1);
  TrainContext(Job("context.h5", 20), Box(20.0, 0.0), threads, {});
  const auto written = fs::last_write_time(folder_ / "context.h5");
  EXPECT_EQ(TrainContext(Job("context.h5", 20), Box(20.0, 0.0), threads, {}).steps, 20);
  EXPECT_EQ(fs::last_write_time(folder_ / "context.h5"), written);
  TrainJob other = Job("context.h5", 20);
  other.config_hash = "def";
  EXPECT_THROW(TrainContext(other, Box(20.0, 0.0), threads, {}), base::UsageError);
}

TEST_F(TrainBlockTest, BlockWithoutPhotosFailsWithItsReason) {
  base::ThreadPool threads(1);
  TrainContext(Job("context.h5", 20), Box(20.0, 0.0), threads, {});
  BlockSpec far = Box(5.0, 0.0);
  far.box.min_enu.x() += 500.0;
  far.box.max_enu.x() += 500.0;
  const TrainResult result = TrainBlock(Job("far.h5", 10), far, folder_ / "context.h5", threads, {});
  EXPECT_FALSE(result.ok);
  EXPECT_NE(result.reason.find("r0c0"), std::string::npos);
}

// Photos 0 and 8 are held out. Other pixels in them, other poses and other observations by them change no field, nor what the context tells blocks.
TEST_F(TrainBlockTest, HeldOutPhotosLeaveNoTrace) {
  base::ThreadPool threads(2);
  // The fields of context and block.
  const auto train = [&](bool other) {
    fs::remove(folder_ / "pixels.bin");
    Photograph([&](int photo, int, double value, double) { return other && photo % 8 == 0 ? 1.0 - value : value; });
    for (double x = -12.0; x < 12.5; x += 1.5) {
      for (double y = -9.0; y < 9.5; y += 1.5) {
        survey_.points.push_back({{x, y, 0.0}, {}, 0.5F, 4});
        survey_.tracks.Add(other ? std::vector<int32_t>{5, 6, 9} : std::vector<int32_t>{0, 5, 6, 8, 9});
      }
    }
    if (other) {
      for (const size_t i : {0U, 8U}) survey_.photos[i].cam_from_enu = NadirPhoto({3.0, -4.0, 15.0}, "").cam_from_enu;
    }
    const std::string name = other ? "other_" : "given_";
    TrainContext(Job(name + "context.h5", 30), Box(20.0, 0.0), threads, {});
    TrainJob job = Job(name + "block.h5", 60);
    job.priors = {};
    job.priors.planar = 0.01;  // needs segments
    job.priors.from = job.priors.until = 0.0;
    EXPECT_TRUE(TrainBlock(job, Box(12.0, 1.0), folder_ / (name + "context.h5"), threads, {}).ok);
    return std::vector<std::string>{Bytes(name + "context.h5"), Bytes(name + "block.h5")};
  };
  const std::vector<std::string> given_fields = train(false);
  EXPECT_EQ(train(true), given_fields);

  const auto intervals = [&](const std::string& name) { return checkpoint::ArchiveReader(folder_ / name).Floats("surface_intervals"); };
  const std::vector<float> given = intervals("given_context.h5"), other = intervals("other_context.h5");
  ASSERT_EQ(given.size(), survey_.photos.size() * kTileRows * kTileColumns * 3);
  ASSERT_EQ(other.size(), given.size());
  EXPECT_EQ(std::memcmp(given.data(), other.data(), given.size() * sizeof(float)), 0);
  const auto any_known = [&](int photo) {
    const auto begin = given.begin() + static_cast<std::ptrdiff_t>(3 * BandIndex(photo, 0, 0));
    return std::any_of(begin, begin + 3 * kTileRows * kTileColumns, [](float value) { return std::isfinite(value); });
  };
  EXPECT_FALSE(any_known(0)) << "nothing is rendered from a held-out camera";
  EXPECT_FALSE(any_known(8));
  EXPECT_TRUE(any_known(5));
}

TEST(TrainOptions, RefusesImpossibleValuesByName) {
  TrainOptions options;
  options.hidden = 30;
  const std::string error = UsageErrorOf([&] { options.Check("train"); });
  EXPECT_NE(error.find("train.hidden"), std::string::npos);
  options = {};
  options.coupling = "joint";
  EXPECT_THROW(options.Check("train"), base::UsageError);
  options = {};
  options.start = "nowhere";
  EXPECT_THROW(options.Check("train"), base::UsageError);
  const auto refusal = [](const TrainOptions& refused) -> std::string { return UsageErrorOf([&] { refused.Check("context"); }); };
  options = {};
  options.encoding = "cubes";
  EXPECT_EQ(refusal(options), "context.encoding = \"cubes\" is not allowed: it must be hash, voxels, planes or frequency");
  for (const int layers : {0, 9}) {
    options = {};
    options.density_hidden_layers = layers;
    EXPECT_NE(refusal(options).find("is not allowed: it must be 1 to 8"), std::string::npos) << refusal(options);
  }
  EXPECT_NO_THROW(TrainOptions{}.Check("train"));
}

TEST_F(TrainBlockTest, BandsOfTheContextAreWhereABlockStarts) {
  const brightness::Response response = brightness::Response::Neutral(survey_.photos.size(), 1);
  RaySource source(survey_, *pixels_, response);
  LoadedContext context;
  context.field.step_m = 1.0;
  // All photos look straight down from about 30 m; the surface interval is from 2 m to 1 m above ground at the ray's foot point.
  std::vector<int> photos;
  for (size_t photo = 0; photo < survey_.photos.size(); ++photo) {
    photos.push_back(static_cast<int>(photo));
    for (int row = 0; row < kTileRows; ++row) {
      for (int column = 0; column < kTileColumns; ++column) {
        Eigen::Vector3d origin, direction;
        const Tile tile{static_cast<int>(photo), static_cast<int16_t>(column), static_cast<int16_t>(row)};
        source.RayThrough(tile.photo, source.TileCentre(tile), &origin, &direction);
        const auto at_height = [&](double z) { return static_cast<float>((z - origin.z()) / direction.z()); };
        context.bands.push_back({at_height(2.0), at_height(1.5), at_height(1.0)});
      }
    }
  }
  render::TrainedField target;
  target.map = encoding::SpaceMap::Box({-10.0, -10.0, -5.0}, {10.0, 10.0, 15.0});
  const double extent[3] = {target.map.extent().x(), target.map.extent().y(), target.map.extent().z()};
  target.occupancy = field::OccupancyGrid::Make(extent, 0.5 * target.map.units_per_metre(), 4'000'000);
  survey_.points.emplace_back();
  survey_.points.back().x_in_enu = {4.2, 4.2, 12.2};
  StartFromSurfaces(source, {}, survey_, TrainingTiles(survey_, photos), context, target);
  const auto occupied = [&](double x, double y, double z) {
    const Eigen::Vector3f unit = target.map.UnitFromEnu({x, y, z});
    return target.occupancy.occupied[static_cast<size_t>(target.occupancy.IndexAt(unit.x(), unit.y(), unit.z()))];
  };
  for (double x = -9.0; x < 9.5; x += 1.5) {
    EXPECT_TRUE(occupied(x, 2.0, 1.5)) << x;
    EXPECT_FALSE(occupied(x, 2.0, 6.0)) << x;
    EXPECT_FALSE(occupied(x, 2.0, -3.0)) << x;
  }
  EXPECT_TRUE(occupied(4.2, 4.2, 12.2)) << "a sparse point";
}

}  // namespace
}  // namespace skyquilt::worker
