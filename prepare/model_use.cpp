#include "prepare/model_use.h"

#include <algorithm>

#include "core/base/child_process.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/geo/enu_frame.h"
#include "prepare/georeference/georeference.h"

namespace skyquilt::prepare {

bool LacksPoints(const models::InputModel& model) {
  return model.format != models::ModelFormat::kColmap && model.sfm.points.empty();
}

void RequireColmap(const models::InputModel& model, const std::filesystem::path& path, const std::string& colmap) {
  if (!base::FindProgram(colmap).empty()) return;
  std::string fix = "Install COLMAP (Debian: apt install colmap) or set prepare.colmap to its path: it triangulates points from the poses. Or ";
  if (model.format == models::ModelFormat::kTransforms) {
    fix += "name a PLY with points of the same frame as ply_file_path";
  } else {
    fix += "give a model with points, for instance in COLMAP's format";
  }
  throw base::InputError(path, "has poses but no sparse points, which give the heights above ground", fix);
}

void PlaceByModel(const models::ModelPlace& place, std::vector<input::PreparedPhoto>& photos) {
  const auto tagged = std::count_if(photos.begin(), photos.end(), [](const input::PreparedPhoto& photo) { return photo.gps.has_value(); });
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
  base::LogInfo("{} photos are held out, as the model says (choose others with prepare.holdout)", n_test);
}

}  // namespace skyquilt::prepare
