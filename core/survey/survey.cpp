#include "core/survey/survey.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/survey/made_masks.h"
#include "core/survey/points_ply.h"

namespace skyquilt::survey {
namespace {

using base::NanIfNull;
using nlohmann::json;
using nlohmann::ordered_json;

constexpr const char* kFormat = "skyquilt survey";
constexpr int kVersion = 2;
constexpr const char *kGivenPoses = "given", *kResectedPoses = "resected";  // of held-out photos
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

ordered_json NumberOrNull(const std::optional<double>& value) {
  return base::NumberOrNull(value.value_or(kNan));
}
std::optional<double> OptionalNumber(const json& value) {
  return value.is_null() ? std::nullopt : std::optional<double>(value.get<double>());
}

ordered_json ToJson(const geo::Geodetic& position) {
  return {{"latitude_deg", position.latitude_deg}, {"longitude_deg", position.longitude_deg}, {"height_m", NumberOrNull(position.height_m)}};
}

geo::Geodetic GeodeticFromJson(const json& value) {
  return {value.at("latitude_deg").get<double>(), value.at("longitude_deg").get<double>(), NanIfNull(value.at("height_m"))};
}

ordered_json ToJson(const camera::Camera& camera) {
  return {{"model", camera::ModelName(camera.model)}, {"width", camera.width}, {"height", camera.height}, {"params", camera.params}};
}

camera::Camera CameraFromJson(const json& value) {
  camera::Camera camera;
  const auto name = value.at("model").get<std::string>();
  const auto model = camera::ModelFromName(name);
  if (!model) throw std::invalid_argument("unknown camera model '" + name + "'");
  camera.model = *model;
  camera.width = value.at("width").get<int>();
  camera.height = value.at("height").get<int>();
  camera.params = value.at("params").get<std::vector<double>>();
  const std::string problem = camera.Problem();
  if (!problem.empty()) throw std::invalid_argument("a camera cannot be used: " + problem);
  return camera;
}

ordered_json ToJson(const Photo& photo) {
  const Eigen::Quaterniond& q = photo.cam_from_enu.rotation;
  const Eigen::Vector3d& t = photo.cam_from_enu.translation;
  return {{"name", photo.name},
          {"mask", photo.mask},
          {"camera", photo.camera},
          {"rotation_wxyz", {q.w(), q.x(), q.y(), q.z()}},
          {"translation_m", {t.x(), t.y(), t.z()}},
          {"gps", photo.gps ? ToJson(*photo.gps) : ordered_json(nullptr)},
          {"gps_correction_m", {photo.gps_correction_m.x(), photo.gps_correction_m.y(), photo.gps_correction_m.z()}},
          {"relative_altitude_m", NumberOrNull(photo.relative_altitude_m)},
          {"time_s", NumberOrNull(photo.time_s)},
          {"exposure_time_s", NumberOrNull(photo.exposure.time_s)},
          {"f_number", NumberOrNull(photo.exposure.f_number)},
          {"iso", NumberOrNull(photo.exposure.iso)},
          {"agl_m", NumberOrNull(photo.agl_m)},
          {"gps_residual_m", NumberOrNull(photo.gps_residual_m)},
          {"gps_inlier", photo.gps_inlier},
          {"flight", photo.flight},
          {"is_test", photo.is_test}};
}

Photo PhotoFromJson(const json& value) {
  Photo photo;
  photo.name = value.at("name").get<std::string>();
  photo.mask = value.at("mask").get<std::string>();
  photo.camera = value.at("camera").get<int>();
  const json& q = value.at("rotation_wxyz");
  const json& t = value.at("translation_m");
  if (q.size() != 4 || t.size() != 3) throw std::invalid_argument("photo '" + photo.name + "' has a pose of the wrong length");
  photo.cam_from_enu.rotation = Eigen::Quaterniond(NanIfNull(q[0]), NanIfNull(q[1]), NanIfNull(q[2]), NanIfNull(q[3]));
  photo.cam_from_enu.translation = Eigen::Vector3d(NanIfNull(t[0]), NanIfNull(t[1]), NanIfNull(t[2]));
  const double norm = photo.cam_from_enu.rotation.norm();
  if (!photo.cam_from_enu.translation.allFinite() || !(std::abs(norm - 1.0) < 1e-6)) {
    throw std::invalid_argument("the pose of photo '" + photo.name + "' has NaN, or a rotation that is not of length 1");
  }
  if (!value.at("gps").is_null()) photo.gps = GeodeticFromJson(value.at("gps"));
  const json& correction = value.at("gps_correction_m");
  if (correction.size() != 3) throw std::invalid_argument("photo '" + photo.name + "' has a GPS correction of the wrong length");
  photo.gps_correction_m = Eigen::Vector3d(correction[0].get<double>(), correction[1].get<double>(), correction[2].get<double>());
  photo.relative_altitude_m = OptionalNumber(value.at("relative_altitude_m"));
  photo.time_s = OptionalNumber(value.at("time_s"));
  photo.exposure = {OptionalNumber(value.at("exposure_time_s")), OptionalNumber(value.at("f_number")), OptionalNumber(value.at("iso"))};
  photo.agl_m = NanIfNull(value.at("agl_m"));
  photo.gps_residual_m = NanIfNull(value.at("gps_residual_m"));
  photo.gps_inlier = value.at("gps_inlier").get<bool>();
  photo.flight = value.at("flight").get<int>();
  photo.is_test = value.at("is_test").get<bool>();
  return photo;
}

Survey SurveyFromJson(const json& value) {
  if (value.value("format", "") != kFormat) throw std::invalid_argument("is not a survey description");
  if (value.value("version", 0) != kVersion) throw std::invalid_argument("was written by another version of skyquilt");
  Survey survey;
  survey.origin = GeodeticFromJson(value.at("origin"));
  survey.georeferenced = value.at("georeferenced").get<bool>();
  if (!geo::IsValid(survey.origin)) throw std::invalid_argument("has an origin that is not a position on Earth");
  const std::string heights = value.value("height_reference", geo::NameOf(survey.height_reference));  // absent in surveys of older programs
  const auto reference = geo::HeightReferenceNamed(heights);
  if (!reference) throw std::invalid_argument("has heights above '" + heights + "', which is unknown");
  survey.height_reference = *reference;
  survey.photo_root = value.at("photo_root").get<std::string>();
  for (const json& camera : value.at("cameras")) survey.cameras.push_back(CameraFromJson(camera));
  std::set<std::string> names;
  for (const json& entry : value.at("photos")) {
    Photo photo = PhotoFromJson(entry);
    if (photo.camera < 0 || static_cast<size_t>(photo.camera) >= survey.cameras.size()) {
      throw std::invalid_argument("photo '" + photo.name + "' refers to camera " + std::to_string(photo.camera) + ", but there are " +
                                  std::to_string(survey.cameras.size()));
    }
    if (!names.insert(photo.name).second) throw std::invalid_argument("photo '" + photo.name + "' appears twice");
    survey.photos.push_back(std::move(photo));
  }
  survey.unregistered = value.at("unregistered").get<std::vector<std::string>>();
  const std::string holdout_poses = value.value("holdout_poses", kGivenPoses);  // absent in surveys of older programs
  if (holdout_poses != kGivenPoses && holdout_poses != kResectedPoses) {
    throw std::invalid_argument("has held-out photos with poses that are '" + holdout_poses + "', which is unknown");
  }
  survey.resected_holdout = holdout_poses == kResectedPoses;
  survey.fit = GeoFitFromJson(value.at("fit"));
  if (value.contains("control")) survey.control = ControlFitFromJson(value.at("control"));  // absent without control points
  survey.checks = FlightChecksFromJson(value.at("checks"));
  for (const json& problem : value.at("problems")) survey.problems.push_back(ProblemFromJson(problem));
  const json& truth = value.at("truth");
  if (!truth.is_null()) {
    survey.truth = Truth{truth.at("depth_folder").get<std::string>(),
                         truth.at("buildings_json").get<std::string>(),
                         truth.at("exposure_json").get<std::string>(),
                         truth.value("normals_folder", ""),
                         truth.value("classes_folder", ""),
                         truth.value("surface_ply", ""),
                         truth.value("masks_folder", ""),
                         truth.value("ortho_tif", ""),
                         truth.value("edge_targets_json", "")};
  }
  return survey;
}

// Reads a file of points that must have so many.
std::vector<SparsePoint> LoadPoints(const std::filesystem::path& file, size_t n_points) {
  std::vector<SparsePoint> points = ReadPointsPly(file);
  if (points.size() != n_points) {
    throw base::InputError(file, "has " + std::to_string(points.size()) + " points, but survey.json says " + std::to_string(n_points),
                           "The two files are from different runs: run 'skyquilt prepare' again");
  }
  return points;
}

// Tracks of all points or of none.
void CheckTracks(const Survey& survey) {
  const auto fits = [](const PointTracks& tracks, const std::vector<SparsePoint>& points) {
    return tracks.Empty() || tracks.points() == points.size();
  };
  SKYQUILT_CHECK(fits(survey.tracks, survey.points) && fits(survey.kept_tracks, survey.kept_points), "one track per point");
  SKYQUILT_CHECK(survey.HasTracks() || (survey.tracks.Empty() && survey.kept_tracks.Empty()), "tracks of all points or of none");
}

// The masks that were made take the place of those that were given.
void TakeMadeMasks(const std::filesystem::path& folder, Survey* survey) {
  const std::optional<MadeMasks> masks = LoadMadeMasks(folder);
  if (!masks) return;
  const std::vector<MadeMask>& made = masks->photos;
  const bool fits = std::equal(made.begin(), made.end(), survey->photos.begin(), survey->photos.end(),
                               [](const MadeMask& mask, const Photo& photo) { return mask.photo == photo.name; });
  if (!fits) {
    throw base::InputError(MadeMasksFile(folder), "belongs to other photos than survey.json",
                           "Remove the folder " + MadeMasksFolder(folder).string() + ", or run 'skyquilt prepare' again with --restart");
  }
  const std::filesystem::path pictures = std::filesystem::absolute(MadeMasksFolder(folder)).lexically_normal();
  for (size_t i = 0; i < made.size(); ++i) {
    if (!made[i].file.empty()) survey->photos[i].mask = (pictures / made[i].file).string();
  }
}

}  // namespace

bool Survey::HasTracks() const {
  return tracks.points() == points.size() && kept_tracks.points() == kept_points.size() && points.size() + kept_points.size() > 0;
}

double Survey::MedianAgl() const {
  std::vector<double> known;
  for (const Photo& photo : photos) {
    if (std::isfinite(photo.agl_m)) known.push_back(photo.agl_m);
  }
  if (known.empty()) return kNan;
  std::sort(known.begin(), known.end());
  const size_t n = known.size();
  return n % 2 == 1 ? known[n / 2] : 0.5 * (known[n / 2 - 1] + known[n / 2]);
}

void SaveSurvey(const Survey& survey, const std::filesystem::path& folder) {
  for (const Photo& photo : survey.photos) {
    SKYQUILT_CHECK(photo.cam_from_enu.rotation.coeffs().allFinite() && photo.cam_from_enu.translation.allFinite(), photo.name);
  }
  CheckTracks(survey);
  base::RequireWritableFolder(folder);
  ordered_json value = {{"format", kFormat},
                        {"version", kVersion},
                        {"origin", ToJson(survey.origin)},
                        {"georeferenced", survey.georeferenced},
                        {"height_reference", geo::NameOf(survey.height_reference)},
                        {"photo_root", survey.photo_root.string()},
                        {"n_points", survey.points.size()},
                        {"n_kept_points", survey.kept_points.size()},
                        {"n_observations", nullptr},
                        {"fit", ToJson(survey.fit)},
                        {"checks", ToJson(survey.checks)},
                        {"problems", ordered_json::array()},
                        {"truth", nullptr},
                        {"cameras", ordered_json::array()},
                        {"unregistered", survey.unregistered},
                        {"holdout_poses", survey.resected_holdout ? kResectedPoses : kGivenPoses},
                        {"photos", ordered_json::array()}};
  if (survey.HasTracks()) value["n_observations"] = survey.tracks.observations() + survey.kept_tracks.observations();
  if (survey.truth) {
    value["truth"] = {{"depth_folder", survey.truth->depth_folder.string()},          {"buildings_json", survey.truth->buildings_json.string()},
                      {"exposure_json", survey.truth->exposure_json.string()},        {"normals_folder", survey.truth->normals_folder.string()},
                      {"classes_folder", survey.truth->classes_folder.string()},      {"surface_ply", survey.truth->surface_ply.string()},
                      {"masks_folder", survey.truth->masks_folder.string()},          {"ortho_tif", survey.truth->ortho_tif.string()},
                      {"edge_targets_json", survey.truth->edge_targets_json.string()}};
  }
  if (!survey.control.points.empty()) value["control"] = ToJson(survey.control);
  for (const Problem& problem : survey.problems) value["problems"].push_back(ToJson(problem));
  for (const camera::Camera& camera : survey.cameras) value["cameras"].push_back(ToJson(camera));
  for (const Photo& photo : survey.photos) value["photos"].push_back(ToJson(photo));
  // survey.json is written last: if it exists, the points are complete.
  WritePointsPly(survey.points, folder / "points.ply");
  SaveDirections(survey.directions, folder / "directions.json");
  if (survey.kept_points.empty()) {
    std::filesystem::remove(folder / "kept_points.ply");
  } else {
    WritePointsPly(survey.kept_points, folder / "kept_points.ply");
  }
  if (survey.HasTracks()) {
    WriteTracks(survey.tracks, survey.kept_tracks, survey.photos.size(), folder / "tracks.bin");
  } else {
    std::filesystem::remove(folder / "tracks.bin");
  }
  base::WriteFileAtomically(folder / "survey.json", base::JsonText(value, 1) + "\n");
}

Survey LoadSurvey(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "survey.json";
  if (!std::filesystem::exists(file)) throw base::InputError(file, "no such file", "Run 'skyquilt prepare' first");
  const std::string text = base::ReadFile(file);
  Survey survey;
  TrackCounts counts;
  bool has_tracks = false;
  try {
    const json value = base::ParseJson(text);
    survey = SurveyFromJson(value);
    counts.photos = survey.photos.size();
    counts.points = value.at("n_points").get<size_t>();
    counts.kept_points = value.value("n_kept_points", size_t{0});  // absent in surveys of older programs, as are tracks
    has_tracks = value.contains("n_observations") && !value.at("n_observations").is_null();
    if (has_tracks) counts.observations = value.at("n_observations").get<size_t>();
  } catch (const json::exception& error) {
    throw base::InputError(file, std::string("is damaged (") + error.what() + ")", "Run 'skyquilt prepare' again");
  } catch (const std::invalid_argument& error) {
    throw base::InputError(file, error.what(), "Run 'skyquilt prepare' again");
  }
  survey.directions = LoadDirections(folder / "directions.json");
  survey.points = LoadPoints(folder / "points.ply", counts.points);
  if (counts.kept_points > 0) survey.kept_points = LoadPoints(folder / "kept_points.ply", counts.kept_points);
  if (has_tracks) {
    SurveyTracks tracks = ReadTracks(folder / "tracks.bin", counts);
    survey.tracks = std::move(tracks.points);
    survey.kept_tracks = std::move(tracks.kept_points);
  }
  TakeMadeMasks(folder, &survey);
  return survey;
}

}  // namespace skyquilt::survey
