#include "simulate/simulate.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/amounts.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/image/video_writer.h"
#include "simulate/building_truth.h"
#include "simulate/control_marks.h"
#include "simulate/control_targets.h"
#include "simulate/control_writer.h"
#include "simulate/edge_targets.h"
#include "simulate/flight.h"
#include "simulate/flights/level_flight.h"
#include "simulate/flights/panorama_flight.h"
#include "simulate/flights/video_flight.h"
#include "simulate/lights.h"
#include "simulate/model_frame.h"
#include "simulate/photo_renderer.h"
#include "simulate/place_spec.h"
#include "simulate/pose_noise.h"
#include "simulate/sparse_points.h"
#include "simulate/surface_mesh.h"
#include "simulate/survey_writer.h"
#include "simulate/true_orthophoto.h"
#include "simulate/world.h"

namespace skyquilt::simulate {
namespace {

namespace fs = std::filesystem;

constexpr int kSeedsPerPhoto = 170;
constexpr int kSeedsPerLevelPhoto = 600;  // most are on plain walls and in the sky, where no feature is
constexpr const char* kStarted = "simulate.started";
constexpr std::array<const char*, 6> kParts = {"images", "sparse", "truth", "control", "video", "panoramas"};

// Makes the folders. Removes an earlier simulation, but nothing else.
void PrepareFolder(const fs::path& folder) {
  base::RequireWritableFolder(folder);
  const bool ours = fs::exists(folder / "simulate.json") || fs::exists(folder / kStarted);
  for (const char* name : kParts) {
    const fs::path part = folder / name;
    if (!fs::exists(part)) continue;
    if (!ours && !(fs::is_directory(part) && fs::is_empty(part))) {
      throw base::InputError(part, "exists and was not made by `skyquilt simulate`", "Give an empty or new folder");
    }
  }
  base::WriteFileAtomically(folder / kStarted, "");
  fs::remove(folder / "simulate.json");
  for (const char* name : kParts) fs::remove_all(folder / name);
  for (const char* name : {"images", "sparse/0", "truth/depth", "truth/normals", "truth/classes", "truth/masks"})
    fs::create_directories(folder / name);
}

// A test photo at normal exposure, without shadows of clouds.
void WriteCloudless(const fs::path& folder, const PhotoPlan& photo, const PhotoRenderer& renderer, MovingScene moving, int jpeg_quality,
                    base::ThreadPool& threads) {
  moving.clouds = {};
  fs::create_directories(folder / "truth" / "cloudless");
  image::SaveJpeg(Develop(renderer.Render(photo.cam_from_enu, moving, threads).rgb_linear, {}), folder / "truth" / "cloudless" / photo.name,
                  jpeg_quality);
}

void WarnAboutStreets(const World& world, const PlaceSpec& place) {
  if (world.city() == nullptr) return;
  const std::vector<Car>& parked = world.city()->contents().parked;
  const auto n = std::count_if(parked.begin(), parked.end(), [](const Car& car) { return car.kind != CarKind::kCar; });
  if (n < place.city.trucks) base::LogWarning("simulate: the streets have room for {} of {} trucks (simulate.trucks)", n, place.city.trucks);
  const size_t lamps = world.city()->contents().lamps.size();
  if (lamps < static_cast<size_t>(place.city.lamps)) {
    base::LogWarning("simulate: the streets have room for {} of {} lamps (simulate.lamps)", lamps, place.city.lamps);
  }
}

struct Targets {
  std::vector<SurveyedTarget> control;
  std::vector<EdgeTarget> edges;
};

// Puts the targets on the ground. Nothing when none are asked for.
Targets LayOutTargets(const SimulateOptions& options, const PlaceSpec& place, const std::vector<PhotoPlan>& photos, const geo::EnuFrame& frame,
                      World& world, base::ThreadPool& threads) {
  std::vector<ControlTarget> targets = ChooseTargets(world, place, photos, options.control_points, options.check_points, threads);
  const int wanted = options.control_points + options.check_points;
  if (static_cast<int>(targets.size()) < wanted) {
    base::LogWarning("simulate: the place has open ground that {} photos see for {} of {} control and check points", kMinTargetViews, targets.size(),
                     wanted);
  }
  std::vector<PaintedTarget> painted = PaintOf(targets);
  std::vector<EdgeTarget> edges = ChooseEdgeTargets(world, place, photos, frame, painted, options.edge_targets, threads);
  if (static_cast<int>(edges.size()) < options.edge_targets) {
    base::LogWarning("simulate: the place has even open ground in the sun for {} of {} slanted edges (simulate.edge_targets)", edges.size(),
                     options.edge_targets);
  }
  for (const EdgeTarget& edge : edges) painted.push_back(edge.paint);
  world.PaintTargets(std::move(painted));
  return {SurveyTargets(std::move(targets), options, place.camera, photos, place.seed), std::move(edges)};
}

void WriteControl(const SimulateOptions& options, const PlaceSpec& place, const std::vector<PhotoPlan>& photos, std::vector<SurveyedTarget> points,
                  const geo::EnuFrame& frame, const fs::path& folder) {
  ControlFiles files{std::move(points), {}, place.camera, ControlCrsOf(options.control_crs, frame.origin())};
  for (const PhotoPlan& photo : photos) files.photos.push_back(photo.name);
  WriteControlFiles(files, frame, folder);
}

// Before minutes of rendering. Videos are encoded in halves of the resolution for colours, which need even sizes.
void CheckVideo(const SimulateOptions& options, const PlaceSpec& place) {
  if (options.video_fps == 0) return;
  if (place.flight != FlightKind::kSurvey) {
    throw base::UsageError("simulate.video_fps must be 0 with simulate.flight = " + options.flight + ": only a survey's flight is filmed");
  }
  if (place.camera.width % 2 != 0 || place.camera.height % 2 != 0) {
    throw base::UsageError("simulate.video_fps needs photos of even size, not of " + std::to_string(place.camera.width) + " x " +
                           std::to_string(place.camera.height) + " pixels: change simulate.image_width");
  }
}

void CheckLights(const SimulateOptions& options) {
  if (options.lights == "one") return;
  const char* const other = options.video_fps > 0        ? "video_fps"
                            : options.panoramas > 0      ? "panoramas"
                            : options.control_points > 0 ? "control_points"
                            : options.check_points > 0   ? "check_points"
                            : options.flight != "survey" ? "flight"
                                                         : nullptr;
  if (other == nullptr) return;
  throw base::UsageError("simulate.lights = " + options.lights + " is for the photos of a survey alone: leave out simulate." + other);
}

// Films the flight of the photos.
void FilmFlight(const SimulateOptions& options, const PlaceSpec& place, const std::vector<PhotoPlan>& photos, const World& world,
                const PhotoRenderer& renderer, const geo::EnuFrame& frame, const fs::path& folder, base::ThreadPool& threads) {
  const std::vector<PhotoPlan> frames = PlanVideo(place, photos, options.video_fps);
  fs::create_directories(folder / "video");
  image::VideoWriter video(folder / "video" / "flight.mp4", place.camera.width, place.camera.height, options.video_fps);
  base::Progress progress("film", static_cast<double>(frames.size()), "frames");
  for (const PhotoPlan& one : frames) {
    base::ThrowIfCancelled();
    const Rendering rendering = renderer.Render(one.cam_from_enu, world.MovingAt(one.time_s), threads);
    video.Write(Develop(rendering.rgb_linear, {LightRgb(one), place.vignetting, place.camera.PrincipalPoint()}));
    progress.Advance();
  }
  video.Close();
  progress.Finish();
  WriteSubtitles(frames, options.video_fps, place.camera, frame, folder / "video" / "flight.SRT");
  WriteVideoPoses(frames, folder / "truth" / "video_poses.csv");
  base::LogInfo("simulate: a video of {} frames, {:.0f} s long", frames.size(), static_cast<double>(frames.size()) / options.video_fps);
}

// Panoramas from places of the flight.
void TakePanoramas(const SimulateOptions& options, const PlaceSpec& place, const std::vector<PhotoPlan>& photos, const World& world,
                   const geo::EnuFrame& frame, const fs::path& folder, base::ThreadPool& threads) {
  const std::vector<PhotoPlan> plans = PlanPanoramas(photos, options.panoramas);
  const camera::Equirectangular sphere{options.panorama_width, options.panorama_width / 2};
  const PhotoRenderer renderer(world, sphere, options.samples_per_pixel, options.soft_shadows);
  fs::create_directories(folder / "panoramas");
  base::Progress progress("take panoramas", static_cast<double>(plans.size()), "panoramas");
  for (const PhotoPlan& plan : plans) {
    base::ThrowIfCancelled();
    const Rendering rendering = renderer.Render(plan.cam_from_enu, world.MovingAt(plan.time_s), threads);
    constexpr double kNoVignetting = 0.0;
    const Eigen::Vector2d middle(0.5 * sphere.width, 0.5 * sphere.height);
    WritePanorama(plan, Develop(rendering.rgb_linear, {LightRgb(plan), kNoVignetting, middle}), place.camera, frame, options.jpeg_quality,
                  folder / "panoramas");
    progress.Advance();
  }
  progress.Finish();
  WritePanoramaPoses(plans, folder / "truth" / "panorama_poses.csv");
  base::LogInfo("simulate: {} panoramas of {} x {} pixels", plans.size(), sphere.width, sphere.height);
}

}  // namespace

SimulateSummary Simulate(const SimulateOptions& options, const fs::path& folder, base::ThreadPool& threads) {
  return Simulate(options, folder, threads, [&options](const PlaceSpec& place, const World& world) {
    std::vector<PhotoPlan> photos =
        place.flight == FlightKind::kSurvey ? PlanFlight(place, world.TakeoffHeight(place)) : PlanLevelFlight(place, world);
    for (size_t i = 0; i < photos.size(); ++i) photos[i].true_depth = i % static_cast<size_t>(options.test_every) == 0;
    return photos;
  });
}

SimulateSummary Simulate(const SimulateOptions& options, const fs::path& folder, base::ThreadPool& threads, const FlightPlanner& plan) {
  const auto begin = std::chrono::steady_clock::now();
  const PlaceSpec place = ResolvePlace(options);
  CheckVideo(options, place);
  CheckLights(options);
  PrepareFolder(folder);
  const geo::EnuFrame frame({options.latitude_deg, geo::WrapLongitudeDeg(options.longitude_deg), options.height_m});
  base::LogInfo("simulate: building place {}", place.name);
  World world(place, options.light_intensity, threads);
  WarnAboutStreets(world, place);
  std::vector<PhotoPlan> photos = plan(place, world);
  ApplyTagFaults(place.tag_faults, place.seed, photos);
  const std::vector<Light> lights = PlanLights(options, place);
  RepeatUnder(lights, options.test_every, photos);
  const size_t photos_per_light = photos.size() / lights.size();
  for (const Light& light : lights) {
    for (const char* part : {"images", "truth/depth", "truth/normals", "truth/classes", "truth/masks"})
      fs::create_directories(folder / part / light.folder);
  }
  std::optional<gis::MapGrid> ortho;
  if (options.ortho_cell_m > 0.0) ortho = PlanTrueOrthophoto(place, photos, world.TakeoffHeight(place), frame, options.ortho_cell_m);
  Targets targets = LayOutTargets(options, place, photos, frame, world, threads);
  const PhotoRenderer renderer(world, place.camera, options.samples_per_pixel, options.soft_shadows);

  SimulateSummary summary;
  summary.n_photos = static_cast<int>(photos.size());
  summary.n_control = static_cast<int>(targets.control.size());
  summary.n_buildings = static_cast<int>(world.buildings().size());
  const bool is_level = place.flight != FlightKind::kSurvey;
  std::vector<SurfaceSeed> seeds;
  base::Progress progress("simulate", static_cast<double>(photos.size()), "photos");
  for (size_t i = 0; i < photos.size(); ++i) {
    base::ThrowIfCancelled();
    const PhotoPlan& photo = photos[i];
    if (lights.size() > 1 && i % photos_per_light == 0) {
      const Light& light = lights[i / photos_per_light];
      world.SetLight(light.sun_elevation_deg, light.intensity, threads);
    }
    MovingScene moving = world.MovingAt(photo.time_s);
    const Rendering rendering = renderer.Render(photo.cam_from_enu, moving, threads, [&progress](double share) { progress.Advance(share); });
    const image::Image8 pixels = Develop(rendering.rgb_linear, {LightRgb(photo), place.vignetting, place.camera.PrincipalPoint()});
    WritePhoto(folder, photo, pixels, place.camera, frame, options.jpeg_quality);
    if (!rendering.usable.Empty()) {
      image::SavePng(rendering.usable, folder / "truth" / "masks" / (photo.name + ".png"));
      ++summary.n_masks;
    }
    if (photo.true_depth) {
      WriteSurfaceTruth(folder, photo, renderer.Surfaces(photo.cam_from_enu, moving, threads));
      ++summary.n_test;
    } else if (options.class_images == "all") {
      WriteClasses(folder, photo, renderer.Surfaces(photo.cam_from_enu, moving, threads));
    }
    if (photo.true_depth && options.cloud_shadows > 0.0) {
      WriteCloudless(folder, photo, renderer, std::move(moving), options.jpeg_quality, threads);
    }
    progress.Update(static_cast<double>(i + 1));
    if (!photo.finds_points) continue;
    for (SurfaceSeed& seed : ChooseSeeds(place.camera, static_cast<int>(i), is_level ? kSeedsPerLevelPhoto : kSeedsPerPhoto, place.seed)) {
      if (is_level && !HasTexture(pixels, seed.x, seed.y)) continue;
      const uint8_t* rgb = pixels.At(seed.x, seed.y);
      seed.rgb = {rgb[0], rgb[1], rgb[2]};
      seeds.push_back(seed);
    }
  }
  progress.Finish();
  if (lights.size() > 1) world.SetLight(place.sun_elevation_deg, options.light_intensity, threads);
  if (options.video_fps > 0) FilmFlight(options, place, photos, world, renderer, frame, folder, threads);
  if (options.panoramas > 0) TakePanoramas(options, place, photos, world, frame, folder, threads);
  std::vector<survey::ColmapPoint> points = MakeSparsePoints(world, place.camera, photos, seeds, place.seed, threads);
  summary.n_points = static_cast<int>(points.size());
  survey::ColmapModel model = MakeModel(place.camera, photos, std::move(points));
  AddPoseNoise(options.pose_noise_deg, options.pose_noise_m, place.seed, photos, model);
  std::optional<geo::Similarity3d> model_from_enu;
  if (!options.exact_frame) {
    model_from_enu = RandomModelFrame(place.seed);
    MoveModel(*model_from_enu, model);
  }
  WriteModel(folder, model);
  WriteExposureTruth(folder, photos, place);
  WriteBuildingTruth(folder, world.buildings(), place, frame);
  WriteSurfaceMesh(world, folder / "truth" / "surface.ply");
  if (options.edge_targets > 0) WriteEdgeTargets(targets.edges, folder / "truth" / "edge_targets.json");
  if (ortho) {
    WriteTrueOrthophoto(world, *ortho, frame, std::max(4, options.samples_per_pixel), options.soft_shadows, threads,
                        folder / "truth" / "orthophoto.tif");
  }
  if (!targets.control.empty()) WriteControl(options, place, photos, std::move(targets.control), frame, folder);
  base::ThrowIfCancelled();
  WriteSummary(folder, place, options, frame, photos.size(), model_from_enu);
  fs::remove(folder / kStarted);
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  base::LogInfo("simulate: {} photos ({} test photos), {} points, {} buildings in {}", summary.n_photos, summary.n_test, summary.n_points,
                summary.n_buildings, base::FormatDuration(summary.seconds));
  return summary;
}

}  // namespace skyquilt::simulate
