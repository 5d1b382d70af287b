// A small synthetic survey on disk: patterned ground with a box on it, seen by sixteen nadir photos. A test can choose how the photos record light.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/checkpoint/archive.h"
#include "core/geo/ray_box.h"
#include "core/image/image.h"
#include "core/image/srgb.h"
#include "core/render/ray_engine.h"
#include "core/scene/field_file.h"
#include "tests/support/nadir_photo.h"
#include "worker/block_session.h"
#include "worker/trainer.h"

namespace skyquilt::worker {

constexpr int kSmallWidth = 64, kSmallHeight = 48;

struct SmallWorld {
  // Colour of the surface a ray meets: ground z = 0 with a smooth pattern, and a 6 x 6 x 4 m red box in the middle. The box is patterned too, because
  // a roof of one colour could be at any height inside the silhouettes.
  static Eigen::Vector3d Shade(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
    const geo::Interval box = geo::RayBox(origin, direction, {-3, -3, 0}, {3, 3, 4});
    if (!box.Empty()) {
      const Eigen::Vector3d p = origin + box.t_near * direction;
      return {0.75 + 0.2 * std::sin(1.8 * p.x() + p.z()) * std::cos(1.6 * p.y()), 0.2, 0.15 + 0.1 * std::sin(1.5 * p.y())};
    }
    const Eigen::Vector3d p = origin - origin.z() / direction.z() * direction;
    const double wave = 0.5 + 0.25 * std::sin(0.5 * p.x()) * std::cos(0.4 * p.y());
    return {0.6 * wave, wave, 0.5 * wave};
  }
};

class SmallSurvey : public ::testing::Test {
 protected:
  // From a display value of the world to the one that photo i records at a pixel. r2: squared distance from the centre, 1 in the corners.
  using Recording = std::function<double(int photo, int channel, double value, double r2)>;

  void SetUp() override {
    Photograph([](int, int, double value, double) { return value; });
  }
  void Photograph(const Recording& recording) {
    survey_ = {};
    base::ClearCancel();
    folder_ = std::filesystem::temp_directory_path() /
              ("skyquilt_worker_" + std::to_string(getpid()) + "_" + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
    survey_.origin = {46.0, 7.0, 400.0};
    survey_.georeferenced = true;
    survey_.photo_root = folder_;
    camera::Camera camera;
    camera.width = kSmallWidth;
    camera.height = kSmallHeight;
    camera.params = {50.0, 50.0, kSmallWidth / 2.0, kSmallHeight / 2.0};
    survey_.cameras = {camera};
    std::vector<image::PixelSource> sources;
    for (int i = 0; i < 16; ++i) {
      const int row = i / 4;
      const Eigen::Vector3d centre(-15.0 + 10.0 * (i % 4), -15.0 + 10.0 * row, 30.0 + (i % 3));
      survey::Photo photo = NadirPhoto(centre, "p" + std::to_string(10 + i) + ".png");
      photo.is_test = i % 8 == 0;
      image::Image8 picture(kSmallWidth, kSmallHeight, 3);
      for (int y = 0; y < kSmallHeight; ++y) {
        for (int x = 0; x < kSmallWidth; ++x) {
          const Eigen::Vector3d direction = photo.cam_from_enu.rotation.conjugate() * camera.RayFromImg({x + 0.5, y + 0.5});
          const Eigen::Vector3d color = SmallWorld::Shade(centre, direction);
          const double u = (x + 0.5) / kSmallWidth - 0.5, v = (y + 0.5) / kSmallHeight - 0.5;
          const double aspect = static_cast<double>(kSmallHeight) / kSmallWidth;
          const double r2 = (u * u + aspect * aspect * v * v) / (0.25 + 0.25 * aspect * aspect);
          for (int c = 0; c < 3; ++c) {
            picture.At(x, y)[c] = static_cast<uint8_t>(std::lround(255.0 * std::clamp(recording(i, c, color[c], r2), 0.0, 1.0)));
          }
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
    std::filesystem::remove_all(folder_);
  }

  TrainJob Job(const std::string& name, int steps) const {
    TrainJob job;
    job.survey = &survey_;
    job.pixels = pixels_.get();
    job.response = brightness::Response::Neutral(survey_.photos.size(), 1);
    job.learn.learns_gain.assign(survey_.photos.size(), 0);
    job.options.steps = steps;
    job.options.batch_samples = 4096;
    job.options.hidden = 32;
    job.config_hash = "abc";
    job.seed = 7;
    job.priors = PriorOptions::Off();
    job.checkpoint = folder_ / name;
    return job;
  }
  BlockSpec Box(double half, double margin) const {
    BlockSpec block;
    block.name = "r0c0";
    block.box = {{-half, -half, -1.0}, {half, half, 6.0}, margin};
    block.finest_voxel_m = 0.5;
    block.log2_table_size = 14;
    for (int i = 0; i < 16; ++i) block.photos.push_back(i);
    return block;
  }
  // Trains a job that is interrupted once it has saved its first step, then resumes it until it is finished.
  static void TrainInterrupted(TrainJob job, const std::function<void(const TrainJob&)>& train) {
    job.options.checkpoint_every_s = 0.0;  // saves after every step
    base::ClearCancel();
    std::atomic<bool> ended = false;
    std::thread interrupter([&] {
      while (!ended && !std::filesystem::exists(job.checkpoint)) std::this_thread::yield();
      base::RequestCancel();
    });
    bool interrupted = false;
    try {
      train(job);
    } catch (const base::Interrupted&) {
      interrupted = true;
    }
    ended = true;
    interrupter.join();
    EXPECT_TRUE(interrupted);
    EXPECT_TRUE(std::filesystem::exists(job.checkpoint));
    base::ClearCancel();
    job.options.checkpoint_every_s = 60.0;
    train(job);
  }
  // What two rays straight down see in the scene of context.h5 and block.h5: the box's roof (26 m below them), and the ground beside it (30 m).
  std::vector<render::RayColor> RoofAndGround(base::ThreadPool& threads) const {
    const LoadedContext loaded = LoadContext(folder_ / "context.h5");
    const render::TrainedField field = scene::GetField(checkpoint::ArchiveReader(folder_ / "block.h5"), folder_ / "block.h5", "");
    render::FieldSet set;
    set.blocks = {&field};
    set.context = &loaded.field;
    const std::vector<render::Ray> rays = {{{0, 0, 30}, {0, 0, -1}}, {{8, 7, 30}, {0, 0, -1}}};
    std::vector<render::RayColor> out(rays.size());
    render::RenderRays(set, rays, out, {}, threads);
    return out;
  }
  std::string Bytes(const std::string& name) const {
    const checkpoint::ArchiveReader reader(folder_ / name);
    std::string bytes;
    for (const char* array : {"grid", "networks", "grid_moment2"}) {
      const std::vector<float> values = reader.Floats(array);
      bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
    }
    const std::vector<double> guard = reader.Doubles("guard");
    bytes.append(reinterpret_cast<const char*>(guard.data()), guard.size() * sizeof(double));
    return base::HashHex(bytes);
  }

  std::filesystem::path folder_;
  survey::Survey survey_;
  std::unique_ptr<image::PixelCache> pixels_;
};

}  // namespace skyquilt::worker
