// Trains real fields on a small synthetic survey: a checkered ground with a box on it, seen straight down and from the side.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/checkpoint/archive.h"
#include "core/image/image.h"
#include "worker/block_session.h"
#include "worker/starting_occupancy.h"
#include "worker/trainer.h"

namespace skyquilt::worker {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 64, kHeight = 48;

struct World {
  // Colour of the surface a ray meets: ground z = 0 with a smooth pattern; a 6 x 6 x 4 m red box in the middle, patterned too: a roof of one
  // colour could hang at any height inside the silhouettes.
  static Eigen::Vector3d Shade(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
    const render::Stretch box = render::RayBox(origin, direction, {-3, -3, 0}, {3, 3, 4});
    if (!box.Empty()) {
      const Eigen::Vector3d p = origin + box.t_near * direction;
      return {0.75 + 0.2 * std::sin(1.8 * p.x() + p.z()) * std::cos(1.6 * p.y()), 0.2, 0.15 + 0.1 * std::sin(1.5 * p.y())};
    }
    const Eigen::Vector3d p = origin - origin.z() / direction.z() * direction;
    const double wave = 0.5 + 0.25 * std::sin(0.5 * p.x()) * std::cos(0.4 * p.y());
    return {0.6 * wave, wave, 0.5 * wave};
  }
};

class TrainBlockTest : public ::testing::Test {
 protected:
  void SetUp() override {
    base::ClearCancel();
    folder_ = fs::temp_directory_path() /
              ("skyquilt_worker_" + std::to_string(getpid()) + "_" + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
    survey_.origin = {46.0, 7.0, 400.0};
    survey_.georeferenced = true;
    survey_.photo_root = folder_;
    camera::Camera camera;
    camera.width = kWidth;
    camera.height = kHeight;
    camera.params = {50.0, 50.0, kWidth / 2.0, kHeight / 2.0};
    survey_.cameras = {camera};
    std::vector<image::PixelSource> sources;
    for (int i = 0; i < 16; ++i) {
      survey::Photo photo;
      photo.name = "p" + std::to_string(10 + i) + ".png";
      const Eigen::Vector3d centre(-15.0 + 10.0 * (i % 4), -15.0 + 10.0 * (i / 4), 30.0 + (i % 3));
      // Looks down: camera x = east, y = south, z = down.
      Eigen::Matrix3d rotation;
      rotation << 1, 0, 0, 0, -1, 0, 0, 0, -1;
      photo.cam_from_enu.rotation = Eigen::Quaterniond(rotation);
      photo.cam_from_enu.translation = -(rotation * centre);
      photo.is_test = i % 8 == 0;
      image::Image8 picture(kWidth, kHeight, 3);
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          const Eigen::Vector3d direction = rotation.transpose() * camera.RayFromImg({x + 0.5, y + 0.5});
          const Eigen::Vector3d color = World::Shade(centre, direction);
          for (int c = 0; c < 3; ++c) picture.At(x, y)[c] = static_cast<uint8_t>(std::lround(255.0 * color[c]));
        }
      }
      image::SavePng(picture, folder_ / photo.name);
      sources.push_back({folder_ / photo.name, {}});
      survey_.photos.push_back(photo);
    }
    base::ThreadPool threads(1);
    pixels_ = std::make_unique<image::PixelCache>(image::PixelCache::Open(folder_ / "pixels.bin", sources, 0, threads));
  }
  void TearDown() override {
    base::ClearCancel();
    fs::remove_all(folder_);
  }

  TrainJob Job(const std::string& name, int steps) const {
    TrainJob job;
    job.survey = &survey_;
    job.pixels = pixels_.get();
    job.gains.assign(survey_.photos.size(), 1.0F);
    job.options.steps = steps;
    job.options.batch_samples = 4096;
    job.options.hidden = 32;
    job.config_hash = "abc";
    job.seed = 7;
    job.checkpoint = folder_ / name;
    return job;
  }
  BoxView Box(double half, double margin) const {
    BoxView box;
    box.name = "r0c0";
    box.min_enu = {-half, -half, -1.0};
    box.max_enu = {half, half, 6.0};
    box.margin_m = margin;
    box.finest_voxel_m = 0.5;
    box.log2_table_size = 14;
    for (int i = 0; i < 16; ++i) box.photos.push_back(i);
    return box;
  }
  std::string Bytes(const std::string& name) const {
    const checkpoint::ArchiveReader reader(folder_ / name);
    std::string bytes;
    for (const char* array : {"grid", "networks", "grid_moment2"}) {
      const std::vector<float> values = reader.Floats(array);
      bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
    }
    return base::HashHex(bytes);
  }

  fs::path folder_;
  survey::Survey survey_;
  std::unique_ptr<image::PixelCache> pixels_;
};

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
  const checkpoint::ArchiveReader reader(folder_ / "block.h5");
  const render::TrainedField field = render::GetField(reader, folder_ / "block.h5", "");
  render::FieldSet set;
  set.blocks = {&field};
  set.context = &loaded.field;
  const std::vector<render::Ray> rays = {{{0, 0, 30}, {0, 0, -1}}, {{8, 7, 30}, {0, 0, -1}}};
  std::vector<render::RayColor> out(2);
  render::RenderRays(set, rays, out, {}, threads);
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
  // Interrupted somewhere in the middle, then continued by the same call.
  TrainJob job = Job("c.h5", 90);
  job.options.checkpoint_every_s = 0.05;
  const Reporter stop = [](const TrainStatus& status) {
    if (status.step >= 10 && status.fraction < 0.9) base::RequestCancel();
  };
  for (int attempt = 0; attempt < 50; ++attempt) {
    base::ClearCancel();
    try {
      TrainBlock(job, Box(12.0, 1.0), folder_ / "context.h5", one, attempt == 0 ? stop : Reporter());
      break;
    } catch (const base::Interrupted&) {
      EXPECT_TRUE(fs::exists(folder_ / "c.h5"));
    }
  }
  EXPECT_EQ(Bytes("a.h5"), Bytes("c.h5"));
}

TEST_F(TrainBlockTest, FinishedWorkIsNotDoneTwiceAndOtherConfigurationsAreRefused) {
  base::ThreadPool threads(1);
  TrainContext(Job("context.h5", 20), Box(20.0, 0.0), threads, {});
  const auto written = fs::last_write_time(folder_ / "context.h5");
  EXPECT_EQ(TrainContext(Job("context.h5", 20), Box(20.0, 0.0), threads, {}).steps, 20);
  EXPECT_EQ(fs::last_write_time(folder_ / "context.h5"), written);
  TrainJob other = Job("context.h5", 20);
  other.config_hash = "def";
  EXPECT_THROW(TrainContext(other, Box(20.0, 0.0), threads, {}), base::UsageError);
}

TEST_F(TrainBlockTest, BlockNobodyPhotographedFailsWithItsReason) {
  base::ThreadPool threads(1);
  TrainContext(Job("context.h5", 20), Box(20.0, 0.0), threads, {});
  BoxView far = Box(5.0, 0.0);
  far.min_enu.x() += 500.0;
  far.max_enu.x() += 500.0;
  const TrainResult result = TrainBlock(Job("far.h5", 10), far, folder_ / "context.h5", threads, {});
  EXPECT_FALSE(result.ok);
  EXPECT_NE(result.reason.find("r0c0"), std::string::npos);
}

TEST(TrainOptions, RefusesImpossibleValuesByName) {
  TrainOptions options;
  options.hidden = 30;
  try {
    options.Check("train");
    FAIL();
  } catch (const base::UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("train.hidden"), std::string::npos);
  }
  options = {};
  options.coupling = "joint";
  EXPECT_THROW(options.Check("train"), base::UsageError);
  EXPECT_NO_THROW(TrainOptions{}.Check("train"));
}

TEST_F(TrainBlockTest, BandsOfTheContextAreWhereABlockStarts) {
  std::vector<float> gains(survey_.photos.size(), 1.0F);
  RaySource source(survey_, *pixels_, gains);
  LoadedContext context;
  context.field.step_m = 1.0;
  // All photos look straight down from about 30 m; light ends between 2 m and 1 m of height at the ray's foot point.
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
  StartFromBands(source, survey_, TrainingTiles(survey_, photos), context, target);
  const auto awake = [&](double x, double y, double z) {
    const Eigen::Vector3f unit = target.map.UnitFromEnu({x, y, z});
    return target.occupancy.occupied[static_cast<size_t>(target.occupancy.IndexAt(unit.x(), unit.y(), unit.z()))] != 0;
  };
  for (double x = -9.0; x < 9.5; x += 1.5) {
    EXPECT_TRUE(awake(x, 2.0, 1.5)) << x;
    EXPECT_FALSE(awake(x, 2.0, 6.0)) << x;
    EXPECT_FALSE(awake(x, 2.0, -3.0)) << x;
  }
  EXPECT_TRUE(awake(4.2, 4.2, 12.2)) << "a sparse point";
}

}  // namespace
}  // namespace skyquilt::worker
