#include "tests/prepare/control/fit/made_control.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/base/random.h"
#include "core/geo/enu_frame.h"
#include "prepare/poses/seed/seed_poses.h"

namespace skyquilt::test {
namespace {

// Evenly over the part of the ground that many photos show.
Eigen::Vector3d PlaceOfPoint(const SurveyPlan& plan, int i, int n, base::Random& random) {
  const int columns = static_cast<int>(std::ceil(std::sqrt(n))), row = i / columns, column = i % columns;
  const double width = plan.along_m * (plan.per_strip - 1), depth = plan.across_m * (plan.strips - 1);
  return {width * (column + random.Uniform(0.2, 0.8)) / columns, depth * (row + random.Uniform(0.2, 0.8)) / columns, random.Uniform(-5.0, 5.0)};
}

void Transform(const geo::Similarity3d& b_from_a, survey::ColmapModel& model) {
  for (survey::ColmapImage& image : model.images) image.cam_from_world = geo::TransformCameraWorld(image.cam_from_world, b_from_a);
  for (survey::ColmapPoint& point : model.points) point.x_in_world = b_from_a * point.x_in_world;
}

}  // namespace

void Displace(prepare::control::ControlPoint& point, const Eigen::Vector3d& by_m) {
  const bool has_height = std::isfinite(point.place.height_m);
  geo::Geodetic from = point.place;
  if (!has_height) from.height_m = kMadeOrigin.height_m;
  const geo::Geodetic moved = geo::EnuFrame(from).GeodeticFromEnu(by_m);
  point.place = {moved.latitude_deg, moved.longitude_deg, has_height ? moved.height_m : point.place.height_m};
}

MadeControl MakeControl(const ControlPlan& plan, base::ThreadPool& threads) {
  MadeSurvey survey = MakeSurvey(plan.survey);
  const geo::EnuFrame frame(kMadeOrigin);
  for (prepare::poses::SeedPhoto& photo : survey.input.photos) {
    photo.gps = frame.GeodeticFromEnu(frame.EnuFromGeodetic(*photo.gps) + plan.tag_shift_m);
  }
  std::string reason;
  auto seeded = prepare::poses::SeedPoses(survey.input, threads, &reason);
  if (!seeded) throw std::runtime_error(reason);
  MadeControl made;
  made.model = std::move(seeded->model);
  made.observations = std::move(seeded->observations);
  made.true_focal_px = survey.cameras.front().FocalX();
  if (plan.own_frame) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(2.1, Eigen::Vector3d(0.3, -0.8, 0.5).normalized()));
    Transform({0.037, turn, Eigen::Vector3d(3.0, -1.0, 12.0)}, made.model);
  }
  std::vector<const camera::Camera*> cameras;
  for (size_t i = 0; i < made.model.images.size(); ++i) {
    const survey::ColmapImage& image = made.model.images[i];
    made.true_poses.push_back(survey.cam_from_enu[image.id - 1]);
    cameras.push_back(&survey.cameras[image.camera_id - 1]);
    prepare::input::PreparedPhoto photo = prepare::input::PreparePhoto({.name = image.name}, i, image.cam_from_world);
    if (plan.tags) photo.gps = survey.input.photos[image.id - 1].gps;
    made.photos.push_back(std::move(photo));
  }
  base::Random random(plan.seed, 7);
  made.control.file = "targets.txt";
  made.control.crs = "WGS 84";
  made.control.heights = "ellipsoid";
  const int n = plan.control + plan.check;
  for (int i = 0; i < n; ++i) {
    // Control and check points alternate over the ground.
    const int k = i < plan.control ? 2 * i : 2 * (i - plan.control) + 1;
    const Eigen::Vector3d x = PlaceOfPoint(plan.survey, k % n, n, random);
    prepare::control::ControlPoint point;
    point.label = "T" + std::to_string(i + 1);
    point.line = i + 2;
    point.check = i >= plan.control;
    point.horizontal_sigma_m = plan.horizontal_sigma_m;
    point.vertical_sigma_m = plan.vertical_sigma_m;
    const double up = plan.vertical_sigma_m * random.Normal(), north = plan.horizontal_sigma_m * random.Normal(),
                 east = plan.horizontal_sigma_m * random.Normal();
    point.place = frame.GeodeticFromEnu(x + plan.given_noise * Eigen::Vector3d(east, north, up));
    std::vector<std::pair<double, size_t>> by_distance;
    for (size_t photo = 0; photo < made.true_poses.size(); ++photo) {
      by_distance.emplace_back((made.true_poses[photo].OriginInSource() - x).norm() + random.Uniform(0.0, 15.0), photo);
    }
    std::sort(by_distance.begin(), by_distance.end());
    for (const auto& [distance, photo] : by_distance) {
      const auto pixel = cameras[photo]->ImgFromCam(made.true_poses[photo] * x);
      if (!pixel || pixel->x() < 5.0 || pixel->y() < 5.0 || pixel->x() > 1595.0 || pixel->y() > 1195.0) continue;
      const double noise_y = plan.mark_noise_px * random.Normal(), noise_x = plan.mark_noise_px * random.Normal();
      const Eigen::Vector2d at = *pixel + Eigen::Vector2d(noise_x, noise_y);
      point.marks.push_back({made.photos[photo].file.name, at, 0});
      if (static_cast<int>(point.marks.size()) == plan.marks) break;
    }
    made.control.points.push_back(std::move(point));
  }
  return made;
}

}  // namespace skyquilt::test
