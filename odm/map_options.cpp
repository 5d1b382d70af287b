#include "odm/map_options.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/errors.h"

namespace skyquilt::odm {
namespace {

// How many times their accuracy tags may be off: prepare's 10 m for OpenDroneMap's 3 m.
constexpr double kTagLimit = 10.0 / 3.0;

int WholeOf(const Request& request, const std::string& option) {
  return static_cast<int>(std::lround(request.Number(option)));
}

void ApplyPoses(const Request& request, const Dataset& dataset, const Effort& effort, prepare::PrepareOptions* prepare) {
  prepare->gcp = dataset.gcp;
  prepare->geo_file = dataset.geo;
  prepare->max_image_size = effort.feature_size;
  if (request.Has("--min-num-features")) prepare->max_features = std::max(100, WholeOf(request, "--min-num-features"));
  if (request.Has("--gps-accuracy")) prepare->ransac_threshold_m = std::max(0.1, kTagLimit * request.Number("--gps-accuracy"));
  prepare->video_limit = std::max(3, WholeOf(request, "--video-limit"));
  prepare->video_size = std::clamp(WholeOf(request, "--video-resolution"), 100, 65'535);
  const std::string lens = request.Text("--camera-lens");
  if (lens == "spherical" || lens == "equirectangular" || lens == "dual") {
    throw base::UsageError("--camera-lens " + lens + " cannot be used: photos of all directions have to be cut into plain ones first");
  }
  static const std::map<std::string, std::string> models = {
      {"perspective", "RADIAL"}, {"brown", "OPENCV"}, {"fisheye", "RADIAL_FISHEYE"}, {"fisheye_opencv", "OPENCV_FISHEYE"}};
  if (const auto model = models.find(lens); model != models.end()) prepare->camera_model = model->second;
}

void ApplySize(const Request& request, coordinator::Settings* settings) {
  const int side = WholeOf(request, "--resize-to");
  if (side <= 0) return;
  if (side < 100) throw base::UsageError("--resize-to must be at least 100, or -1, not " + std::to_string(side));
  settings->prepare.max_image_size = std::min(settings->prepare.max_image_size, side);
  int& width = settings->run.image_width;
  if (width == coordinator::kAutoWidth) width = coordinator::kLeastAutoWidth;  // a wider one might be chosen than is allowed
  width = width == 0 ? side : std::min(width, side);
}

void ApplySurface(const Request& request, const Wishes& wishes, surface::SurfaceOptions* surface) {
  surface->enabled = wishes.Surface();
  surface->obj = wishes.mesh;
  surface->glb = wishes.mesh && wishes.glb;
  surface->ply = false;
  surface->cloud = wishes.cloud;
  surface->tiles = wishes.tiles_3d;
  surface->maps = wishes.dtm || wishes.classes;
  if (request.Has("--smrf-slope")) surface->terrain_slope = std::min(10.0, request.Number("--smrf-slope"));
  if (request.Has("--smrf-window")) surface->terrain_window_m = std::clamp(2.0 * request.Number("--smrf-window"), 1.0, 1e4);
  if (request.Has("--smrf-threshold")) {
    surface->terrain_low_m = std::clamp(request.Number("--smrf-threshold"), 0.01, 10.0);
    surface->terrain_high_m = std::max(surface->terrain_high_m, surface->terrain_low_m);
  }
}

}  // namespace

Wishes WishesOf(const Request& request) {
  const bool fast = request.Has("--fast-orthophoto");
  Wishes wishes;
  wishes.orthophoto = !request.Has("--skip-orthophoto");
  wishes.dsm = request.Has("--dsm");
  wishes.dtm = request.Has("--dtm");
  wishes.mesh = !fast && !request.Has("--skip-3dmodel");
  wishes.glb = request.Has("--gltf");
  wishes.tiles_3d = request.Has("--3d-tiles") && !request.Has("--skip-3dmodel");
  wishes.classes = request.Has("--pc-classify");
  // NodeODM asks for --pc-ept with every task: with --fast-orthophoto that is no reason to make a surface.
  wishes.cloud = !fast || wishes.dtm || wishes.tiles_3d || wishes.classes;
  wishes.ept = request.Has("--pc-ept");
  wishes.report = !request.Has("--skip-report");
  wishes.png = request.Has("--orthophoto-png");
  wishes.cutline = request.Has("--orthophoto-cutline");
  return wishes;
}

void ApplyRequest(const Request& request, const Dataset& dataset, const Effort& effort, double training_s, const std::string& boundary,
                  coordinator::Settings* settings) {
  const Wishes wishes = WishesOf(request);
  ApplyPoses(request, dataset, effort, &settings->prepare);
  settings->run.time_budget_s = training_s;
  if (request.Has("--max-concurrency")) settings->run.threads = std::clamp(WholeOf(request, "--max-concurrency"), 0, 4096);
  ApplySize(request, settings);
  settings->products.ortho = wishes.orthophoto;
  settings->products.dsm = wishes.dsm;
  settings->products.crop_m = std::min(1e4, request.Number("--crop"));
  settings->products.video_seconds = 0.0;
  settings->products.boundary = boundary;
  ApplySurface(request, wishes, &settings->surface);
  settings->buildings.enabled = wishes.classes;
  settings->buildings.classify_cloud = wishes.classes;
  settings->tour.auto_stops = 0;
}

}  // namespace skyquilt::odm
