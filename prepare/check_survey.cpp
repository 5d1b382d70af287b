#include "prepare/check_survey.h"

#include <algorithm>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "prepare/georeference/checks/flight_checks.h"
#include "prepare/georeference/checks/result_checks.h"
#include "prepare/poses/focal_check.h"
#include "prepare/poses/join_parts.h"

namespace skyquilt::prepare {

void RequirePlace(const survey::Survey& survey, const std::filesystem::path& folder) {
  for (const survey::Problem& problem : survey.problems) {
    if (!problem.about_place) continue;
    throw base::InputError(survey.photo_root, problem.finding,
                           problem.advice + " (residuals: " + (folder / "geo_residuals.csv").string() +
                               "). To go on with a warning instead, leave out prepare.require_georeference and add --restart");
  }
}

bundle::LensAccuracy MeasureLens(const survey::ColmapModel& model, const std::filesystem::path& model_folder,
                                 const std::vector<input::PreparedPhoto>& photos, const survey::Survey& survey) {
  const auto main = std::find_if(survey.photos.begin(), survey.photos.end(),
                                 [camera = georeference::MainCamera(survey)](const survey::Photo& photo) { return photo.camera == camera; });
  if (main == survey.photos.end()) return {};
  const uint32_t camera_id = model.images[photos[static_cast<size_t>(main - survey.photos.begin())].image].camera_id;
  try {
    return bundle::MeasureLensAccuracy(model, survey::ReadColmapObservations(model_folder), camera_id);
  } catch (const base::InputError& error) {
    base::LogInfo("the accuracy of the lens is not computed: {}", error.what());
    return {};
  }
}

void CheckFlightOf(const std::vector<input::PreparedPhoto>& photos, const bundle::LensAccuracy& lens, survey::Survey& survey) {
  survey.checks = georeference::CheckFlight(survey, photos);
  survey.checks.k1_sigma = lens.k1_sigma;
  base::LogInfo(georeference::DescribeChecks(survey.checks));
  for (survey::Problem& problem : georeference::FlightProblems(survey.checks, survey)) survey.problems.push_back(std::move(problem));
}

std::map<uint32_t, double> TaggedFocals(const std::vector<input::PreparedPhoto>& photos, const survey::ColmapModel& model) {
  std::map<uint32_t, std::vector<double>> tagged_px;
  for (const input::PreparedPhoto& photo : photos) {
    const auto focal_px = poses::TaggedFocalPx(photo.file.tags, photo.file.width, photo.file.height);
    if (focal_px) tagged_px[model.images[photo.image].camera_id].push_back(*focal_px);
  }
  std::map<uint32_t, double> median_px;
  for (auto& [id, values] : tagged_px) median_px.emplace(id, base::Median(std::move(values)));
  return median_px;
}

void CheckAgainstTags(const std::vector<input::PreparedPhoto>& photos, const georeference::GimbalVerdict& gimbal, bool own_poses,
                      const std::function<double()>& focal_sigma, survey::Survey& survey) {
  georeference::CheckedResult result{.photos = {},
                                     .georeferenced = survey.georeferenced,
                                     .own_poses = own_poses,
                                     .by_control = survey.control.placed,
                                     .scale_percent = survey.fit.accuracy.scale_percent,
                                     .focal_sigma = focal_sigma,
                                     .gimbal = gimbal};
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const survey::Photo& photo = survey.photos[i];
    const survey::PhotoTags& tags = photos[i].file.tags;
    const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
    result.photos.push_back({.cam_from_enu = photo.cam_from_enu.rotation,
                             .camera = photo.camera,
                             .focal_px = camera.FocalX(),
                             .longer_side_px = static_cast<double>(std::max(camera.width, camera.height)),
                             .agl_m = photo.agl_m,
                             .tagged_focal_px = poses::TaggedFocalPx(tags, camera.width, camera.height),
                             .relative_altitude_m = photo.relative_altitude_m,
                             .gimbal_yaw_deg = tags.gimbal_yaw_deg,
                             .gimbal_pitch_deg = tags.gimbal_pitch_deg,
                             .gimbal_roll_deg = tags.gimbal_roll_deg});
  }
  georeference::ApplyChecks(georeference::CheckResult(result), survey);
}

void LogDirections(const survey::DominantDirections& directions) {
  std::string text;
  for (const survey::YawMode& mode : directions.modes) {
    text += fmt::format("{}{:.1f} +- {:.1f} degrees ({:.0f} %)", text.empty() ? "" : ", ", mode.yaw_deg, mode.sigma_deg, 100.0 * mode.share);
  }
  base::LogInfo("{} straight lines in {} photos; directions of buildings and streets: {}", directions.lines, directions.photos,
                text.empty() ? "none" : text);
}

void NoteParts(const survey::ColmapModel& model, survey::Survey& survey) {
  const std::vector<std::vector<std::string>> parts = poses::PartsOf(model);
  if (parts.size() < 2) return;
  std::string names;
  for (const std::vector<std::string>& part : parts) {
    names += fmt::format("{}{} photos such as {}", names.empty() ? "" : ", ", part.size(), part.front());
  }
  survey.problems.push_back({"parts_by_tags",
                             fmt::format("{} parts of the survey have no features in common ({}): their places and heights against each other are "
                                         "as accurate as their tags",
                                         parts.size(), names),
                             "Take photos between the parts, or measure control points in each (--gcp)"});
}

}  // namespace skyquilt::prepare
