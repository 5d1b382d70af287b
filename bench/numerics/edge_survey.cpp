#include "bench/numerics/edge_survey.h"

#include <algorithm>

#include "core/checkpoint/archive.h"
#include "core/image/image.h"
#include "core/kernel/kernels.h"

namespace skyquilt::bench {
namespace {

survey::Survey WritePhotos(const std::filesystem::path& folder, int width, int height, const PixelFormula& pixels) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  survey::Survey survey;
  survey.origin = {46.0, 7.0, 400.0};
  survey.georeferenced = true;
  survey.photo_root = folder;
  camera::Camera camera;
  camera.width = width;
  camera.height = height;
  // 30 m of ground across a photo from 30 m above.
  camera.params = {static_cast<double>(width), static_cast<double>(width), 0.5 * width, 0.5 * height};
  survey.cameras = {camera};
  Eigen::Matrix3d down;
  down << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  for (int i = 0; i < EdgeSurvey::kPhotos; ++i) {
    survey::Photo photo;
    photo.name = "photo" + std::to_string(i) + ".png";
    photo.cam_from_enu.rotation = Eigen::Quaterniond(down);
    const int column = i % 3, row = i / 3;
    photo.cam_from_enu.translation = -(down * Eigen::Vector3d(-6.0 + 6.0 * column, -6.0 + 6.0 * row, 30.0));
    photo.agl_m = 30.0;
    image::Image8 picture(width, height, 3);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const std::array<uint8_t, 3> rgb = pixels(i, x, y);
        std::copy(rgb.begin(), rgb.end(), picture.At(x, y));
      }
    }
    image::SavePng(picture, folder / photo.name);
    survey.photos.push_back(photo);
  }
  return survey;
}

image::PixelCache OpenPixels(const std::filesystem::path& folder, const survey::Survey& survey) {
  std::vector<image::PixelSource> sources;
  for (const survey::Photo& photo : survey.photos) sources.push_back({folder / photo.name, {}});
  base::ThreadPool threads(1);
  return image::PixelCache::Open(folder / "pixels.bin", sources, 0, threads);
}

bool FiniteCheckpoint(const std::filesystem::path& file) {
  const checkpoint::ArchiveReader reader(file);
  for (const char* name : {"grid", "networks", "grid_moment1", "grid_moment2", "network_moment1", "network_moment2"}) {
    const std::vector<float> values = reader.Floats(name);
    if (values.empty() || !kernel::AllFinite(values.data(), static_cast<int64_t>(values.size()))) return false;
  }
  return true;
}

}  // namespace

EdgeSurvey::EdgeSurvey(const std::filesystem::path& folder, int width, int height, const PixelFormula& pixels)
    : folder_(folder), survey_(WritePhotos(folder, width, height, pixels)), pixels_(OpenPixels(folder, survey_)) {}

worker::TrainJob EdgeSurvey::Job(const std::string& name, const brightness::Response& response, int steps) const {
  worker::TrainJob job;
  job.survey = &survey_;
  job.pixels = &pixels_;
  job.response = response;
  job.learn.learns_gain.assign(survey_.photos.size(), 0);
  job.options.steps = steps;
  job.options.batch_samples = 2048;
  job.options.hidden = 16;
  job.config_hash = "numerics";
  job.checkpoint = folder_ / name;
  return job;
}

EdgeSurvey::Outcome EdgeSurvey::Train(const brightness::Response& response, int steps, base::ThreadPool& threads) const {
  worker::BlockSpec area;
  area.name = "r0c0";
  area.box = {{-12.0, -12.0, -1.0}, {12.0, 12.0, 5.0}, 0.0};
  area.finest_voxel_m = 0.5;
  area.log2_table_size = 12;
  for (int i = 0; i < kPhotos; ++i) area.photos.push_back(i);
  Outcome outcome;
  outcome.context = worker::TrainContext(Job("context.h5", response, steps), area, threads, {});
  if (!outcome.context.ok) return outcome;
  worker::BlockSpec block = area;
  block.box.min_enu.head<2>() *= 0.6;
  block.box.max_enu.head<2>() *= 0.6;
  block.box.margin_m = 1.0;
  outcome.block = worker::TrainBlock(Job("block_r0c0.h5", response, steps), block, folder_ / "context.h5", threads, {});
  outcome.finite = outcome.block.ok && FiniteCheckpoint(folder_ / "context.h5") && FiniteCheckpoint(folder_ / "block_r0c0.h5");
  return outcome;
}

}  // namespace skyquilt::bench
