#include "prepare/control/fit/update_model.h"

#include <unordered_map>

namespace skyquilt::prepare::control {
namespace {

// Mean of where the photos that see a point carry it.
Eigen::Vector3d CarriedByPhotos(const Eigen::Vector3d& x_in_enu, const std::vector<uint32_t>& photos, const std::vector<bundle::BundlePhoto>& before,
                                const std::vector<bundle::BundlePhoto>& after) {
  if (photos.empty()) return x_in_enu;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const uint32_t i : photos) {
    sum += after[i].centre + after[i].cam_from_enu.conjugate() * (before[i].cam_from_enu * (x_in_enu - before[i].centre));
  }
  return sum / static_cast<double>(photos.size());
}

// Mean reprojection error of the agreeing observations, pixels of the photos.
double MeanError(const bundle::BundleProblem& bundle, uint32_t track) {
  double sum = 0.0;
  int n = 0;
  for (uint32_t e = bundle.tracks.first[track]; e < bundle.tracks.first[track + 1]; ++e) {
    if (bundle.agrees[e] == 0) continue;
    sum += bundle.Error(e, bundle.point[track]) * bundle.lenses[static_cast<size_t>(bundle.photos[bundle.tracks.entries[e].photo].lens)].unit_px;
    ++n;
  }
  return n > 0 ? sum / n : 0.0;
}

}  // namespace

void UpdateModel(const ControlBundle& marked, const geo::Similarity3d& enu_from_model, const std::vector<bundle::BundlePhoto>& photos_before,
                 bool adjusted, survey::ColmapModel& model) {
  const bundle::BundleProblem& bundle = marked.bundle;
  std::unordered_map<uint32_t, uint32_t> photo_of_image;
  for (uint32_t i = 0; i < model.images.size(); ++i) {
    const bundle::BundlePhoto& photo = bundle.photos[i];
    model.images[i].cam_from_world = {photo.cam_from_enu, -(photo.cam_from_enu * photo.centre)};
    model.images[i].cam_from_rig = photo.cam_from_rig;
    photo_of_image.emplace(model.images[i].id, i);
  }
  for (survey::ColmapPoint& point : model.points) {
    point.x_in_world = enu_from_model * point.x_in_world;
    if (!adjusted) continue;
    std::vector<uint32_t> photos;
    for (const uint32_t id : point.image_ids) {
      if (const auto found = photo_of_image.find(id); found != photo_of_image.end()) photos.push_back(found->second);
    }
    point.x_in_world = CarriedByPhotos(point.x_in_world, photos, photos_before, bundle.photos);
  }
  if (!adjusted) return;
  for (uint32_t t = 0; t < marked.n_ties; ++t) {
    if (bundle.has_point[t] == 0) continue;
    survey::ColmapPoint& point = model.points[marked.point_of_tie[t]];
    point.x_in_world = bundle.point[t];
    point.error_px = MeanError(bundle, t);
  }
  size_t lens = 0;
  for (auto& [id, camera] : model.cameras) camera = bundle::CameraOf(bundle.lenses[lens++].numbers, camera);
}

}  // namespace skyquilt::prepare::control
