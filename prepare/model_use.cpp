#include "prepare/model_use.h"

#include <algorithm>
#include <unordered_set>

#include "core/base/child_process.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/geo/enu_frame.h"
#include "prepare/georeference/georeference.h"

namespace skyquilt::prepare {

namespace {

std::ptrdiff_t CountTagged(const std::vector<input::PreparedPhoto>& photos) {
  return std::count_if(photos.begin(), photos.end(), [](const input::PreparedPhoto& photo) { return photo.gps.has_value(); });
}

}  // namespace

bool LacksPoints(const models::InputModel& model) {
  return model.format != models::ModelFormat::kColmap && model.sfm.points.empty();
}

void RequireColmap(const models::InputModel& model, const std::filesystem::path& path, const std::string& colmap) {
  if (!base::FindProgram(colmap).empty()) return;
  std::string fix = "Install COLMAP (Debian: apt install colmap) or set prepare.colmap to its path: it triangulates points from the poses. Or ";
  if (model.format == models::ModelFormat::kTransforms) {
    fix += "name a PLY with points of the same frame as ply_file_path";
  } else if (model.format == models::ModelFormat::kPosesBounds) {
    fix += "put the scene's sparse/0 beside the file, which has them";
  } else {
    fix += "give a model with points, for instance in COLMAP's format";
  }
  throw base::InputError(path, "has poses but no sparse points, which give the heights above ground", fix);
}

void LeaveOutUnnamed(const models::InputModel& model, std::vector<input::InputFile>& files) {
  if (!model.names_all_photos) return;
  std::unordered_set<std::string> named;
  for (const survey::ColmapImage& image : model.sfm.images) named.insert(image.name);
  size_t n = 0;
  for (input::InputFile& file : files) {
    if (!file.Taken() || named.contains(file.name)) continue;
    file.kind = input::FileKind::kNoChoice;
    file.reason = "not named by the camera model (" + model.set + ")";
    ++n;
  }
  base::LogInfo("data set {}: {} pictures, {}", model.set, named.size(), n == 0 ? "all that are there" : fmt::format("{} others are left out", n));
}

std::optional<Eigen::Vector3d> UpByModel(const models::InputModel& model, const std::vector<input::PreparedPhoto>& photos) {
  if (!model.up || CountTagged(photos) >= georeference::kMinAgreeing) return std::nullopt;
  base::LogInfo("up is {:g}, {:g}, {:g} of the camera model, as it says", model.up->x(), model.up->y(), model.up->z());
  return model.up;
}

std::vector<georeference::ScaleBar> BarsByModel(const models::InputModel& model) {
  if (!model.metres_per_unit) return {};
  base::LogInfo("the camera model says that its unit is {:g} m; this counts as a scale bar", *model.metres_per_unit);
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero(), unit = Eigen::Vector3d::UnitX();
  return {{.a = "0;0;0", .b = "1;0;0", .length_m = *model.metres_per_unit, .at_a = origin, .at_b = unit}};
}

void PlaceByModel(const models::ModelPlace& place, std::vector<input::PreparedPhoto>& photos) {
  const auto tagged = CountTagged(photos);
  if (tagged >= georeference::kMinAgreeing) return;
  base::LogInfo("{} of {} photos have GPS tags, so the positions of the model are used ({}); their accuracy is not known", tagged, photos.size(),
                place.source);
  const geo::EnuFrame frame(place.origin);
  const input::PreparedPhoto untagged;
  for (input::PreparedPhoto& photo : photos) {
    photo.gps = frame.GeodeticFromEnu(place.enu_from_model * photo.cam_from_model.OriginInSource());
    photo.rtk = false;
    photo.horizontal_sigma_m = untagged.horizontal_sigma_m;
    photo.vertical_sigma_m = untagged.vertical_sigma_m;
  }
}

void HoldOutByModel(const models::InputModel& model, const std::filesystem::path& path, survey::Survey& survey) {
  if (model.test_photos.empty()) return;
  const auto is_test = [&model](const survey::Photo& photo) { return model.test_photos.contains(photo.name); };
  const auto n_test = static_cast<size_t>(std::count_if(survey.photos.begin(), survey.photos.end(), is_test));
  if (n_test == 0) {
    base::LogWarning("{}: none of the {} photos that the model holds out has a pose, so photos are held out by prepare.holdout", path.string(),
                     model.test_photos.size());
    return;
  }
  if (n_test == survey.photos.size())
    throw base::InputError(path, "holds out every photo, so none is left to train on", "Choose the held-out photos with --holdout");
  for (survey::Photo& photo : survey.photos) photo.is_test = is_test(photo);
  base::LogInfo("{} of {} photos are held out, {} (choose others with prepare.holdout)", n_test, survey.photos.size(),
                model.set.empty() ? "as the model says" : "as in published results on scenes of " + model.set);
}

}  // namespace skyquilt::prepare
