#include "coordinator/stages/measure_rays.h"

#include <algorithm>
#include <chrono>
#include <vector>

#include "coordinator/rendering/scene_session.h"
#include "core/scene/camera_rays.h"
#include "core/survey/survey.h"

namespace skyquilt::coordinator {
namespace {

constexpr size_t kPlacesToMeasure = 6;
constexpr int kTilesOfPlace = 8;  // a tile in the middle of each part of the photo
constexpr double kMostMeasured_s = 1.5;

std::vector<render::Ray> RaysOfPlace(const survey::Photo& photo, const camera::Camera& full, int image_width, bool cones) {
  const double scale = image_width > 0 && image_width < full.width ? static_cast<double>(image_width) / full.width : 1.0;
  const camera::Camera camera = full.Resized(std::max(1, static_cast<int>(scale * full.width)), std::max(1, static_cast<int>(scale * full.height)));
  const int tiles = scene::TileCount(camera.width, camera.height);
  std::vector<size_t> pixels;
  for (int i = 0; i < std::min(kTilesOfPlace, tiles); ++i) {
    const auto tile = static_cast<int>((i + 0.5) * tiles / std::min(kTilesOfPlace, tiles));
    scene::AppendTilePixels(camera.width, camera.height, tile, std::min(tile + 1, tiles), &pixels);
  }
  std::vector<render::Ray> rays(pixels.size());
  scene::CameraRays(camera, photo.cam_from_enu, cones).Make(pixels, rays);
  return rays;
}

}  // namespace

double MeasureRays(Pipeline& pipeline) {
  const survey::Survey survey = survey::LoadSurvey(pipeline.project.SurveyFolder());
  std::vector<const survey::Photo*> training;
  for (const survey::Photo& photo : survey.photos) {
    if (!photo.is_test) training.push_back(&photo);
  }
  if (training.empty()) return 0.0;
  SceneSession session(pipeline.comm, pipeline.project.SceneFile(), pipeline.settings.run, pipeline.verbose, pipeline.quiet);
  const scene::Scene& scene = session.scene();
  double rays = 0.0, seconds = 0.0;
  const size_t places = std::min(kPlacesToMeasure, training.size());
  std::vector<render::RayColor> colors;
  for (size_t i = 0; i < places; ++i) {
    const survey::Photo& photo = *training[(2 * i + 1) * training.size() / (2 * places)];
    const std::vector<render::Ray> of_place =
        RaysOfPlace(photo, survey.cameras[static_cast<size_t>(photo.camera)], pipeline.settings.run.image_width, scene.info().scales.Cones());
    colors.resize(of_place.size());
    // The first time fields are read from disk, which is no part of the speed.
    if (i == 0) scene.RenderRaysOverBackground(of_place, colors, {.look = scene::Rendition::kRecorded}, session.threads());
    const auto start = std::chrono::steady_clock::now();
    scene.RenderRaysOverBackground(of_place, colors, {.look = scene::Rendition::kRecorded}, session.threads());
    seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    rays += static_cast<double>(of_place.size());
    if (seconds > kMostMeasured_s) break;
  }
  return seconds > 0.0 ? rays / seconds : 0.0;
}

}  // namespace skyquilt::coordinator
