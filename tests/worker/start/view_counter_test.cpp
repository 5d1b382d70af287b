// The counts are those of asking every photo.
#include "worker/start/view_counter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/base/random.h"
#include "core/camera/photo_visibility.h"

namespace skyquilt::worker {
namespace {

enum class Flight { kDown, kOblique, kAnywhere, kOnePlace };

camera::Camera CameraOfModel(camera::CameraModel model) {
  camera::Camera camera;
  camera.model = model;
  camera.width = 80;
  camera.height = 60;
  camera.params = {50.0, 50.0, 40.0, 30.0};
  camera.params.resize(static_cast<size_t>(camera::ModelParamCount(model)), 0.0);
  return camera;
}

survey::Survey Fly(Flight flight, int n, base::Random& random) {
  const auto uniform = [&random] { return static_cast<double>(random.Uniform()); };
  survey::Survey survey;
  const double side_m = 12.0 * std::sqrt(static_cast<double>(n));
  for (int i = 0; i < n; ++i) {
    survey::Photo photo;
    photo.camera = 0;
    const double east_m = uniform() * side_m, north_m = uniform() * side_m, up_m = 40.0 + 20.0 * uniform();
    const double yaw = 2.0 * std::numbers::pi * uniform(), tilt = uniform(), turn = uniform();
    const double pitch = flight == Flight::kDown || flight == Flight::kOnePlace ? std::numbers::pi
                         : flight == Flight::kOblique                           ? std::numbers::pi - 0.9 * tilt
                                                                                : 2.0 * std::numbers::pi * turn;
    photo.cam_from_enu.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
    const Eigen::Vector3d centre = flight == Flight::kOnePlace ? Eigen::Vector3d(50.0, 50.0, 50.0) : Eigen::Vector3d(east_m, north_m, up_m);
    photo.cam_from_enu.translation = -(photo.cam_from_enu.rotation * centre);
    photo.is_test = i % 9 == 0;
    survey.photos.push_back(photo);
  }
  return survey;
}

TEST(ViewCounter, CountsWhatAskingEveryPhotoCounts) {
  base::Random random(11, 1);
  const auto uniform = [&random] { return static_cast<double>(random.Uniform()); };
  for (const camera::CameraModel model : {camera::CameraModel::kPinhole, camera::CameraModel::kOpencv, camera::CameraModel::kOpencvFisheye}) {
    camera::Camera camera = CameraOfModel(model);
    if (model == camera::CameraModel::kOpencv) camera.params[4] = -0.12;
    for (const Flight flight : {Flight::kDown, Flight::kOblique, Flight::kAnywhere, Flight::kOnePlace}) {
      for (const int n : {1, 9, 150}) {
        const survey::Survey survey = Fly(flight, n, random);
        std::vector<int> photos;
        for (int i = 0; i < n; i += 1 + (n > 100 ? i % 2 : 0)) photos.push_back(i);
        const ViewCounter counter(survey, photos, [&camera](int) -> const camera::Camera& { return camera; });
        const double side_m = 12.0 * std::sqrt(static_cast<double>(n));
        for (int k = 0; k < 200; ++k) {
          const double east = uniform(), north = uniform(), up = uniform(), size = uniform();
          const Eigen::Vector3d x((2.0 * east - 0.5) * side_m, (2.0 * north - 0.5) * side_m, 70.0 * up - 5.0);
          const double radius_m = k % 3 == 0 ? 0.0 : 30.0 * size * size * size;
          int wanted = 0;
          for (const int photo : photos) {
            const survey::Photo& one = survey.photos[static_cast<size_t>(photo)];
            wanted += !one.is_test && camera::IsVisible(camera, one.cam_from_enu, x, {.radius_m = radius_m}) ? 1 : 0;
          }
          ASSERT_EQ(counter.Count(x, radius_m, 1'000'000), wanted) << x.transpose() << " radius " << radius_m;
          ASSERT_EQ(counter.Count(x, radius_m, 2), std::min(2, wanted));
        }
      }
    }
  }
}

TEST(ViewCounter, WithoutTrainingPhotosNothingIsSeen) {
  survey::Survey survey;
  const camera::Camera camera = CameraOfModel(camera::CameraModel::kPinhole);
  const auto camera_of = [&camera](int) -> const camera::Camera& { return camera; };
  EXPECT_EQ(ViewCounter(survey, {}, camera_of).Count({0.0, 0.0, 0.0}, 1.0, 2), 0);
  survey.photos.emplace_back().is_test = true;
  EXPECT_EQ(ViewCounter(survey, {0}, camera_of).Count({0.0, 0.0, 1.0}, 1.0, 2), 0);
}

}  // namespace
}  // namespace skyquilt::worker
