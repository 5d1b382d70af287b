#include "prepare/prepare.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/survey/colmap_model.h"
#include "core/survey/tagged_heights.h"
#include "prepare/bundle/intrinsics_sigma.h"
#include "prepare/check_survey.h"
#include "prepare/control/fit/control_report.h"
#include "prepare/georeference/checks/horizontal_lines.h"
#include "prepare/georeference/filter_sparse_points.h"
#include "prepare/georeference/georeference.h"
#include "prepare/georeference/place_by_control.h"
#include "prepare/georeference/scale_bars.h"
#include "prepare/georeference/shape_by_tags.h"
#include "prepare/georeference/stated_up.h"
#include "prepare/georeference/tags/photo_positions.h"
#include "prepare/georeference/tags/unfilled_tags.h"
#include "prepare/held_out_photos.h"
#include "prepare/holdout_poses.h"
#include "prepare/input/input_folder.h"
#include "prepare/input/input_table.h"
#include "prepare/input/list_files.h"
#include "prepare/input/masks/masks.h"
#include "prepare/input/match_photos.h"
#include "prepare/input/match_sizes.h"
#include "prepare/input/photo_files.h"
#include "prepare/input/plain_photos.h"
#include "prepare/model_use.h"
#include "prepare/models/read_model.h"
#include "prepare/poses/colmap_run.h"
#include "prepare/poses/shot_poses.h"
#include "prepare/poses/triangulate_points.h"
#include "prepare/prepare_report.h"
#include "prepare/read_input.h"
#include "prepare/rigs/cut_panoramas.h"
#include "prepare/rigs/rig_config.h"
#include "prepare/survey_points.h"
#include "prepare/video/video_frames.h"

namespace skyquilt::prepare {
namespace {

namespace fs = std::filesystem;

// Index into the survey's photos by COLMAP's image id.
std::unordered_map<uint32_t, int32_t> PhotoOfImage(const std::vector<input::PreparedPhoto>& photos, const survey::ColmapModel& model) {
  std::unordered_map<uint32_t, int32_t> photo_of_image;
  for (size_t i = 0; i < photos.size(); ++i) photo_of_image.emplace(model.images[photos[i].image].id, static_cast<int32_t>(i));
  return photo_of_image;
}

void NotePanoramas(const std::vector<size_t>& panoramas, const input::PhotoSet& photos, std::vector<input::InputFile>& files) {
  std::set<std::string> names;
  for (const size_t i : panoramas) names.insert(photos.usable[i].name);
  for (input::InputFile& file : files) {
    if (names.contains(file.name)) file.reason = "panorama: views.csv lists what it is cut into";
  }
}

// Of the photos as all later stages know them: views in place of panoramas.
std::vector<std::string> NamesAfterCut(std::vector<std::string> names, const std::vector<std::string>& cut, const input::PhotoSet& photos) {
  if (cut.empty()) return names;
  std::set<std::string> all(names.begin(), names.end());
  for (const std::string& name : cut) all.erase(name);
  for (const input::PhotoFile& photo : photos.usable) all.insert(photo.name);
  all.insert(photos.unreadable.begin(), photos.unreadable.end());
  return {all.begin(), all.end()};
}

// A model may have been made of pictures that are no photos here.
void WarnOfPosesLeftOut(const survey::ColmapModel& model, const std::vector<input::InputFile>& files) {
  std::unordered_map<std::string, const input::InputFile*> left_out;
  for (const input::InputFile& file : files) {
    if (!file.Taken()) left_out.emplace(file.name, &file);
  }
  std::vector<std::string> names;
  for (const survey::ColmapImage& image : model.images) {
    if (left_out.contains(image.name)) names.push_back(image.name);
  }
  if (names.empty()) return;
  base::LogWarning("the model has poses of {} files that are left out here ({}; {} is: {}). To use them, choose them with prepare.photos",
                   names.size(), input::FewNames(names), names.front(), left_out.at(names.front())->reason);
}

// Puts poses, tags and cameras into the survey. Cameras without photos are left out.
void FillPhotos(const survey::ColmapModel& model, const std::vector<input::PreparedPhoto>& photos, const georeference::Georeference& georeference,
                survey::Survey& survey) {
  std::map<uint32_t, int> camera_index;
  std::optional<double> first_time_s;
  for (const input::PreparedPhoto& prepared : photos) {
    if (const auto time_s = prepared.file.tags.capture_time_s) first_time_s = std::min(first_time_s.value_or(*time_s), *time_s);
  }
  for (size_t i = 0; i < photos.size(); ++i) {
    const uint32_t camera_id = model.images[photos[i].image].camera_id;
    const input::PhotoFile& file = photos[i].file;
    const auto [found, is_new] = camera_index.emplace(camera_id, static_cast<int>(survey.cameras.size()));
    if (is_new) survey.cameras.push_back(model.cameras.at(camera_id));
    survey::Photo photo;
    photo.name = file.name;
    photo.mask = file.mask;
    photo.camera = found->second;
    photo.cam_from_enu = geo::TransformCameraWorld(photos[i].cam_from_model, georeference.enu_from_model);
    photo.cam_from_enu.rotation.normalize();
    photo.gps = file.tags.gps;
    photo.relative_altitude_m = file.tags.relative_altitude_m;
    if (file.tags.capture_time_s) photo.time_s = *file.tags.capture_time_s - *first_time_s;
    photo.exposure = file.tags.exposure;
    const georeference::TagFit& fit = georeference.photos[i];
    photo.gps_correction_m = fit.correction_m;
    photo.gps_residual_m = std::isnan(fit.residual_m.z()) ? fit.residual_m.head<2>().norm() : fit.residual_m.norm();
    photo.gps_inlier = fit.inlier;
    photo.flight = fit.flight;
    survey.photos.push_back(std::move(photo));
  }
}

// Tags of the photos that place the survey. Too few of them do not: then the model's own positions do, see PlaceByModel.
std::vector<survey::PhotoTags> PlacingTags(const std::vector<input::PreparedPhoto>& photos) {
  std::vector<survey::PhotoTags> tags;
  for (const input::PreparedPhoto& photo : photos) {
    if (photo.file.tags.gps) tags.push_back(photo.file.tags);
  }
  if (tags.size() < georeference::kMinAgreeing) tags.clear();
  return tags;
}

// For a model without any.
std::vector<survey::ColmapPoint> PointsFromPoses(const poses::ColmapJob& job, const survey::ColmapModel& model,
                                                 const std::vector<input::PreparedPhoto>& prepared, const poses::PoseOptions& options,
                                                 base::ThreadPool& threads, poses::RemoteTasks* ranks) {
  survey::ColmapModel poses;
  std::vector<input::PhotoFile> photos;
  for (const input::PreparedPhoto& photo : prepared) {
    const survey::ColmapImage& image = model.images[photo.image];
    photos.push_back(photo.file);
    poses.images.push_back(image);
    poses.images.back().name = photo.file.name;
    poses.cameras.emplace(image.camera_id, model.cameras.at(image.camera_id));
  }
  return poses::TriangulatePoints(job, photos, poses, options, threads, ranks);
}

}  // namespace

survey::Survey Prepare(const PrepareInput& input, const PrepareOptions& options, base::ThreadPool& threads, poses::RemoteTasks* ranks,
                       const OnPlaced& on_placed) {
  options.Check();
  if (!input.videos.empty()) video::ProvideFrames(input.videos, VideoOptionsOf(options), input.out_folder);
  const fs::path photo_folder = input.videos.empty() ? input.photos : video::FramesFolder(input.out_folder);
  input::InputFolder folders = input::FindInputs(photo_folder, input.model, options.masks);
  base::RequireWritableFolder(input.out_folder);

  std::vector<input::InputFile> files = ListFiles(input, options, folders, threads);
  models::InputModel input_model;
  const bool own_poses = folders.model.empty();
  if (!own_poses) {
    input_model = models::ReadModel(folders.model, models::ModelPhotos(folders.photo_root, input::TakenNames(files)));
    LeaveOutUnnamed(input_model, files);
  }
  std::vector<std::string> names = input::TakenNames(files);
  const fs::path rig_file = rigs::FindRigConfig(folders.photo_root, options.rig);
  const std::vector<rigs::Rig> rigs_of_user = rig_file.empty() ? std::vector<rigs::Rig>() : rigs::ReadRigConfig(rig_file);
  input::PhotoSet photos = input::ReadPhotos(folders.photo_root, names, threads);
  // The pictures that all others read, under the same names.
  fs::path picture_root = input::MakePlainPhotos(folders.photo_root, options.bands, options.alpha, input.out_folder / "photos_8bit", photos, threads);
  georeference::UsePositionFiles(folders.photo_root, options.geo_file, photos.usable);
  georeference::LogUnfilledTags(options.flight_gap_s, photos.usable);
  georeference::TurnPitchesThatLookUp(photos.usable);
  input::PhotoMasks masks =
      input::FindMasks(folders.photo_root, folders.masks, fs::absolute(input.out_folder) / "masks", photos.usable, files, threads);
  NoteReadPhotos(photos, files);
  const std::vector<size_t> panoramas = rigs::FindPanoramas(photos.usable, options.panoramas);
  NotePanoramas(panoramas, photos, files);
  input::WriteInputTable(files, input.out_folder / kInputTable);
  if (!rig_file.empty()) rigs::UseRigs(rigs_of_user, rig_file, photos.usable);
  std::vector<std::string> cut;
  cut.reserve(panoramas.size());
  for (const size_t i : panoramas) cut.push_back(photos.usable[i].name);
  rigs::CutPhotos now{picture_root, masks.folder};
  rigs::CutPanoramas(panoramas, PanoramaOptionsOf(options), input.out_folder, now, photos, threads);
  picture_root = now.picture_root;
  masks.folder = now.masks;
  names = NamesAfterCut(std::move(names), cut, photos);
  // A model of panoramas is one of their views.
  if (!own_poses && !cut.empty()) input_model = models::ReadModel(folders.model, models::ModelPhotos(folders.photo_root, names));
  // Faults of these files are told before the long search for poses.
  const control::ControlPoints control_points = georeference::ReadControlPoints(ControlFilesOf(options), photos.usable);
  const std::vector<georeference::ScaleBar> bars =
      options.scale_bars.empty() ? BarsByModel(input_model) : georeference::ParseScaleBars(options.scale_bars);
  const control::ControlPoints bar_marks = georeference::ReadScaleMarks(bars, ControlFilesOf(options), control_points, photos.usable);
  base::ThrowIfCancelled();

  if (own_poses) {
    const poses::ColmapJob job{picture_root, masks.folder, fs::absolute(input.out_folder) / "colmap"};
    folders.model = poses::RunColmap(job, photos.usable, PoseOptionsOf(options), threads, ranks);
    input_model.sfm = survey::ReadColmapModel(folders.model);
    poses::MarkShots(photos.usable, input_model.sfm);
  } else {
    WarnOfPosesLeftOut(input_model.sfm, files);
  }
  const bool has_observations = !folders.exact_origin && input_model.format == models::ModelFormat::kColmap;
  folders.model = input::ScaleToPhotos(input::FindPhotos(input_model.sfm, photos.usable), photos.usable, folders.model, has_observations,
                                       fs::absolute(input.out_folder) / "scaled_model", input_model.sfm);
  const survey::ColmapModel& model = input_model.sfm;
  const input::FileOfImage file_of_image = input::MatchPhotos(model, photos.usable, folders.model, folders.photo_root);
  std::vector<input::PreparedPhoto> prepared = input::PreparePhotos(model, file_of_image, photos.usable);
  if (LacksPoints(input_model)) {
    RequireColmap(input_model, folders.model, options.colmap);
    const poses::ColmapJob job{picture_root, masks.folder, fs::absolute(input.out_folder) / "colmap"};
    input_model.sfm.points = PointsFromPoses(job, model, prepared, PoseOptionsOf(options), threads, ranks);
  }
  const auto poses_known = std::chrono::steady_clock::now();
  const std::set<std::string> held_out = ChooseHeldOut(options, input_model, folders.model, prepared, names);
  std::optional<WithheldPhotos> withheld;
  if (options.holdout_poses == "resected" && !held_out.empty()) {
    withheld = Withhold(held_out, prepared, folders.model, has_observations, input_model.sfm, threads);
    prepared = input::PreparePhotos(model, file_of_image, photos.usable);
  }

  if (input_model.place) PlaceByModel(*input_model.place, prepared);
  std::vector<Eigen::Vector3d> points;
  points.reserve(model.points.size());
  for (const survey::ColmapPoint& point : model.points) points.push_back(point.x_in_world);
  georeference::PlaceOptions place_options = PlaceOptionsOf(options);
  place_options.up = options.up.empty() ? UpByModel(input_model, prepared) : georeference::StatedUp(options.up, prepared);
  if (place_options.up && folders.exact_origin) base::LogWarning("prepare.up changes nothing, because the frame of this simulation is exact");
  georeference::Georeference georeference = folders.exact_origin ? georeference::KeepExactFrame(prepared, *folders.exact_origin, place_options)
                                                                 : georeference::PlaceOnEarth(prepared, points, place_options);
  // Control points say more of the shape than tags; check points are compared with the final one.
  const bool any_control =
      std::any_of(control_points.points.begin(), control_points.points.end(), [](const control::ControlPoint& p) { return !p.check; });
  if (has_observations && !any_control) {
    georeference::ShapeByTags({place_options, folders.model, TaggedFocals(prepared, model)}, input_model.sfm, prepared, georeference, threads);
  }
  survey::ControlFit control =
      georeference::PlaceByControl({place_options, control_points, folders.model, has_observations, folders.exact_origin.has_value()},
                                   input_model.sfm, prepared, georeference, threads);
  georeference::ApplyScaleBars(bars, bar_marks, input_model.sfm, prepared, georeference);
  const std::vector<survey::PhotoTags> placing_tags = PlacingTags(prepared);
  if (withheld) prepared = PutBack(*withheld, held_out, file_of_image, photos.usable, input_model.sfm, georeference);

  survey::Survey survey;
  survey.origin = georeference.origin;
  survey.georeferenced = georeference.ok;
  survey.photo_root = picture_root;
  survey.fit = georeference.fit;
  survey.control = std::move(control);
  survey.problems = georeference.problems;
  survey.truth = folders.truth;
  survey.height_reference = survey::HeightReferenceOf(survey, placing_tags);
  FillPhotos(model, prepared, georeference, survey);
  // Before the points: those that only held-out photos observed are not used.
  for (survey::Photo& photo : survey.photos) photo.is_test = held_out.contains(photo.name);
  survey.resected_holdout = withheld.has_value();
  std::set<std::string> with_pose;
  for (const survey::Photo& photo : survey.photos) with_pose.insert(photo.name);
  for (const std::string& name : names) {
    if (!with_pose.contains(name)) survey.unregistered.push_back(name);
  }
  FillPoints(model, georeference.enu_from_model, PhotoOfImage(prepared, model), options.keep_points, survey);
  georeference::MeasureAgl(survey, threads);
  // The first look waits for it only where no tag confirms the height. A simulation's observations are projections, not features in photos.
  std::optional<bundle::LensAccuracy> measured;
  const auto lens = [&] {
    if (!measured) measured = has_observations ? MeasureLens(model, folders.model, prepared, survey) : bundle::LensAccuracy();
    return *measured;
  };
  const auto focal_sigma = [&] { return lens().focal_sigma; };
  if (own_poses) NoteParts(model, survey);
  // An exact frame is the truth, whatever the tags say.
  if (!folders.exact_origin) CheckAgainstTags(prepared, georeference.gimbal, own_poses, focal_sigma, survey);
  if (on_placed) on_placed(survey, poses_known);
  CheckFlightOf(prepared, lens(), survey);
  base::ThrowIfCancelled();
  const georeference::FoundLines lines = georeference::FindHorizontalLines(survey, threads);
  survey.directions = georeference::FindDirections(lines.lines, lines.photos);
  LogDirections(survey.directions);

  LogSummary(survey);
  if (!survey.unregistered.empty())
    base::LogWarning("{} photos without a pose are not used: {}", survey.unregistered.size(), input::FewNames(survey.unregistered));
  WriteResidualTable(survey, georeference, input.out_folder / "geo_residuals.csv");
  control::WriteControlReport(survey, input.out_folder);
  if (survey.georeferenced) {
    WriteCameraMap(survey, input.out_folder / "cameras.geojson");
  } else {
    fs::remove(input.out_folder / "cameras.geojson");
  }
  if (options.require_georeference) RequirePlace(survey, input.out_folder);
  survey::SaveSurvey(survey, input.out_folder);
  return survey;
}

}  // namespace skyquilt::prepare
