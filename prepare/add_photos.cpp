#include "prepare/add_photos.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"
#include "prepare/check_survey.h"
#include "prepare/georeference/filter_sparse_points.h"
#include "prepare/georeference/georeference.h"
#include "prepare/georeference/tags/photo_positions.h"
#include "prepare/georeference/tags/unfilled_tags.h"
#include "prepare/held_out_photos.h"
#include "prepare/input/input_folder.h"
#include "prepare/input/input_table.h"
#include "prepare/input/masks/masks.h"
#include "prepare/input/photo_files.h"
#include "prepare/input/plain_photos.h"
#include "prepare/poses/add_photos.h"
#include "prepare/prepare_report.h"
#include "prepare/read_input.h"
#include "prepare/rigs/cut_panoramas.h"
#include "prepare/rigs/rig_config.h"
#include "prepare/survey_points.h"

namespace skyquilt::prepare {
namespace {

namespace fs = std::filesystem;

void RefuseWhatIsNotAdded(const PrepareOptions& options, const input::InputFolder& folders, const input::PhotoSet& photos) {
  constexpr const char* kFix = ": prepare all photos together, with --restart or in another project";
  if (options.holdout_poses == "resected") {
    throw base::UsageError(std::string("photos cannot be added to a survey whose held-out photos are resected (prepare.holdout_poses)") + kFix);
  }
  if (!rigs::FindRigConfig(folders.photo_root, options.rig).empty() || !rigs::FindPanoramas(photos.usable, options.panoramas).empty()) {
    throw base::UsageError(std::string("panoramas and photos of rigs cannot be added to a survey, nor photos to one of these") + kFix);
  }
}

// The photos' new names, as they are the same files.
void Rename(const EarlierSurvey& earlier, const fs::path& root, const input::PhotoSet& photos, survey::Survey& survey) {
  std::unordered_map<std::string, std::string> name_of_file;
  for (const input::PhotoFile& photo : photos.usable) name_of_file.emplace(fs::weakly_canonical(root / photo.name).string(), photo.name);
  const fs::path images = earlier.photos / "images";
  std::vector<std::string> gone;
  for (survey::Photo& photo : survey.photos) {
    auto found = name_of_file.find(fs::weakly_canonical(images / photo.name).string());
    if (found == name_of_file.end()) found = name_of_file.find(fs::weakly_canonical(earlier.photos / photo.name).string());
    if (found == name_of_file.end()) {
      gone.push_back(photo.name);
    } else {
      photo.name = found->second;
    }
  }
  if (gone.empty()) return;
  throw base::InputError(earlier.photos, fmt::format("{} photos of the survey are not there any more: {}", gone.size(), input::FewNames(gone)),
                         "Put them back, or prepare all photos again with --restart");
}

poses::KnownPoses KnownPosesOf(const survey::Survey& survey) {
  poses::KnownPoses known{.origin = survey.origin, .georeferenced = survey.georeferenced, .photos = {}};
  for (const survey::Photo& photo : survey.photos) {
    known.photos.emplace(photo.name, poses::KnownPose{photo.cam_from_enu, survey.cameras[static_cast<size_t>(photo.camera)]});
  }
  return known;
}

// Times since the first photo of all, masks and root as they are now.
void UpdateFiles(const input::PhotoSet& photos, const fs::path& picture_root, survey::Survey& survey) {
  std::optional<double> first_s;
  std::unordered_map<std::string, const input::PhotoFile*> file_of;
  for (const input::PhotoFile& photo : photos.usable) {
    file_of.emplace(photo.name, &photo);
    if (const auto time_s = photo.tags.capture_time_s) first_s = std::min(first_s.value_or(*time_s), *time_s);
  }
  survey.photo_root = picture_root;
  for (survey::Photo& photo : survey.photos) {
    const input::PhotoFile& file = *file_of.at(photo.name);
    photo.mask = file.mask;
    if (file.tags.capture_time_s) photo.time_s = *file.tags.capture_time_s - *first_s;
  }
}

// The added photos of the model behind the survey's, with their cameras, in name order.
std::vector<input::PreparedPhoto> AppendPhotos(const survey::ColmapModel& model, const std::vector<input::PhotoFile>& files,
                                               const georeference::PlaceOptions& options, survey::Survey& survey) {
  std::unordered_map<std::string, size_t> image_of;
  for (size_t i = 0; i < model.images.size(); ++i) image_of.emplace(model.images[i].name, i);
  std::set<std::string> known;
  int last_flight = 0;
  for (const survey::Photo& photo : survey.photos) {
    known.insert(photo.name);
    last_flight = std::max(last_flight, photo.flight);
  }
  std::vector<input::PreparedPhoto> added;
  for (const input::PhotoFile& file : files) {
    const auto image = image_of.find(file.name);
    if (known.contains(file.name) || image == image_of.end()) continue;
    added.push_back(input::PreparePhoto(file, image->second, model.images[image->second].cam_from_world));
  }
  georeference::Georeference fit;
  if (survey.georeferenced) fit = georeference::KeepExactFrame(added, survey.origin, options);
  const std::vector<int> flights = input::SplitFlights(added, options.flight_gap_s);
  std::map<uint32_t, int> camera_index;
  std::vector<double> off_m;
  for (size_t i = 0; i < added.size(); ++i) {
    const survey::ColmapImage& image = model.images[added[i].image];
    const auto [camera, is_new] = camera_index.emplace(image.camera_id, static_cast<int>(survey.cameras.size()));
    if (is_new) survey.cameras.push_back(model.cameras.at(image.camera_id));
    const input::PhotoFile& file = added[i].file;
    survey::Photo& photo = survey.photos.emplace_back();
    photo.name = file.name;
    photo.camera = camera->second;
    photo.cam_from_enu = image.cam_from_world;
    photo.cam_from_enu.rotation.normalize();
    photo.gps = file.tags.gps;
    photo.relative_altitude_m = file.tags.relative_altitude_m;
    photo.exposure = file.tags.exposure;
    photo.flight = last_flight + 1 + flights[i];
    photo.gps_residual_m = std::numeric_limits<double>::quiet_NaN();
    if (!survey.georeferenced) continue;
    const georeference::TagFit& tag = fit.photos[i];
    photo.gps_residual_m = std::isnan(tag.residual_m.z()) ? tag.residual_m.head<2>().norm() : tag.residual_m.norm();
    photo.gps_inlier = tag.inlier;
    if (std::isfinite(photo.gps_residual_m)) off_m.push_back(photo.gps_residual_m);
  }
  if (!off_m.empty()) base::LogInfo("tags of the added photos are {:.2f} m (median) from their poses", base::Median(std::move(off_m)));
  return added;
}

// For the table of residuals, which was written of the earlier photos alone.
georeference::Georeference ResidualsOf(const survey::Survey& survey) {
  georeference::Georeference residuals;
  const std::optional<geo::EnuFrame> frame = survey.georeferenced ? std::optional<geo::EnuFrame>(survey.origin) : std::nullopt;
  for (const survey::Photo& photo : survey.photos) {
    georeference::TagFit& fit = residuals.photos.emplace_back();
    if (!frame || !photo.gps) continue;
    geo::Geodetic tag = *photo.gps;
    const bool has_height = std::isfinite(tag.height_m);
    if (!has_height) tag.height_m = survey.origin.height_m;
    fit.residual_m = photo.cam_from_enu.OriginInSource() - frame->EnuFromGeodetic(tag) - photo.gps_correction_m;
    if (!has_height) fit.residual_m.z() = std::numeric_limits<double>::quiet_NaN();
  }
  return residuals;
}

// The points that an added photo shows.
void AppendPoints(survey::ColmapModel& model, size_t n_before, int keep_every, survey::Survey& survey) {
  std::unordered_map<std::string, int32_t> index_of;
  for (size_t i = 0; i < survey.photos.size(); ++i) index_of.emplace(survey.photos[i].name, static_cast<int32_t>(i));
  std::unordered_map<uint32_t, int32_t> photo_of_image;
  for (const survey::ColmapImage& image : model.images) {
    if (const auto found = index_of.find(image.name); found != index_of.end()) photo_of_image.emplace(image.id, found->second);
  }
  const bool tracks = survey.HasTracks();
  std::erase_if(model.points, [&](const survey::ColmapPoint& point) {
    return std::none_of(point.image_ids.begin(), point.image_ids.end(), [&](uint32_t id) {
      const auto found = photo_of_image.find(id);
      return found != photo_of_image.end() && static_cast<size_t>(found->second) >= n_before;
    });
  });
  if (!tracks) {
    for (survey::ColmapPoint& point : model.points) point.image_ids.clear();
  }
  FillPoints(model, {}, photo_of_image, keep_every, survey);
}

}  // namespace

survey::Survey AddPhotos(const PrepareInput& input, const EarlierSurvey& earlier, const PrepareOptions& options, base::ThreadPool& threads,
                         poses::RemoteTasks* ranks) {
  options.Check();
  SKYQUILT_CHECK(input.videos.empty() && input.model.empty(), "photos are added by themselves");
  const input::InputFolder folders = input::FindInputs(input.photos, {}, options.masks);
  base::RequireWritableFolder(input.out_folder);
  std::vector<input::InputFile> files = ListFiles(input, options, folders, threads);
  const std::vector<std::string> names = input::TakenNames(files);
  input::PhotoSet photos = input::ReadPhotos(folders.photo_root, names, threads);
  RefuseWhatIsNotAdded(options, folders, photos);
  const fs::path picture_root =
      input::MakePlainPhotos(folders.photo_root, options.bands, options.alpha, input.out_folder / "photos_8bit", photos, threads);
  georeference::UsePositionFiles(folders.photo_root, options.geo_file, photos.usable);
  georeference::LogUnfilledTags(options.flight_gap_s, photos.usable);
  georeference::TurnPitchesThatLookUp(photos.usable);
  const input::PhotoMasks masks =
      input::FindMasks(folders.photo_root, folders.masks, fs::absolute(input.out_folder) / "masks", photos.usable, files, threads);
  NoteReadPhotos(photos, files);
  input::WriteInputTable(files, input.out_folder / kInputTable);
  base::ThrowIfCancelled();

  survey::Survey survey = survey::LoadSurvey(earlier.folder);
  Rename(earlier, folders.photo_root, photos, survey);
  const size_t n_before = survey.photos.size();
  const poses::KnownPoses known = KnownPosesOf(survey);
  std::vector<bool> is_known;
  for (const input::PhotoFile& photo : photos.usable) is_known.push_back(known.photos.contains(photo.name));
  const auto n_new = static_cast<size_t>(std::count(is_known.begin(), is_known.end(), false));
  if (n_new == 0) {
    throw base::InputError(input.photos, "holds no photo that the survey does not have", "Give the folder with the photos to add");
  }
  std::vector<input::PhotoFile> around;
  for (const size_t i : poses::PhotosAround(photos.usable, is_known)) around.push_back(photos.usable[i]);
  base::LogInfo("{} photos are added to {}, whose poses stay; {} of these are near them", n_new, n_before, around.size() - n_new);
  const poses::ColmapJob job{picture_root, masks.folder, fs::absolute(input.out_folder) / "colmap_added"};
  poses::AddedPoses found = poses::FindAddedPoses(job, around, known, PoseOptionsOf(options), threads, ranks);

  const std::vector<input::PreparedPhoto> added = AppendPhotos(found.model, photos.usable, PlaceOptionsOf(options), survey);
  if (added.empty()) {
    throw base::InputError(job.Log(), "none of the added photos has a pose that agrees with the survey",
                           "Add photos between them and the others, or give them a project of their own");
  }
  UpdateFiles(photos, picture_root, survey);
  const std::set<std::string> held_out = ChooseHeldOut(options, {}, {}, added, names);
  std::set<std::string> with_pose;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    if (i >= n_before) survey.photos[i].is_test = held_out.contains(survey.photos[i].name);
    with_pose.insert(survey.photos[i].name);
  }
  survey.unregistered.clear();
  for (const std::string& name : names) {
    if (!with_pose.contains(name)) survey.unregistered.push_back(name);
  }
  AppendPoints(found.model, n_before, options.keep_points, survey);
  std::erase_if(survey.problems, [](const survey::Problem& problem) { return problem.code == "added_by_tags"; });
  if (!found.by_tags.empty()) {
    survey.problems.push_back({"added_by_tags",
                               fmt::format("{} added photos such as {} have no features in common with the others: their place and heights against "
                                           "these are as accurate as their tags",
                                           found.by_tags.size(), found.by_tags.front()),
                               "Take photos between the parts, or measure control points in each (--gcp) and prepare them together"});
    base::LogWarning("{}. {}", survey.problems.back().finding, survey.problems.back().advice);
  }
  georeference::MeasureAgl(survey, threads);
  LogSummary(survey);
  if (!survey.unregistered.empty())
    base::LogWarning("{} photos without a pose are not used: {}", survey.unregistered.size(), input::FewNames(survey.unregistered));
  WriteResidualTable(survey, ResidualsOf(survey), input.out_folder / "geo_residuals.csv");
  if (survey.georeferenced) WriteCameraMap(survey, input.out_folder / "cameras.geojson");
  survey::SaveSurvey(survey, input.out_folder);
  return survey;
}

}  // namespace skyquilt::prepare
