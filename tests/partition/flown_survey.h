// A survey for partition tests: nadir photos on a grid over points on flat ground, optionally with a quarter of towers.
#pragma once

#include "core/base/random.h"
#include "core/survey/survey.h"
#include "tests/support/nadir_photo.h"

namespace skyquilt::partition {

struct FlownSurveyOptions {
  double width_m = 200.0;
  double height_m = 200.0;
  double agl_m = 100.0;
  int photos_per_side = 8;
  int n_points = 4000;
  double ground_m = 12.0;
  double roof_m = 12.0;     // of the north-east quarter; equal to the ground: none
  bool empty_east = false;  // no points in the eastern third
};

inline survey::Survey FlySurvey(const FlownSurveyOptions& options) {
  survey::Survey survey;
  survey.origin = {41.3, 2.1, 0.0};
  survey.georeferenced = true;
  survey.photo_root = "photos";
  camera::Camera camera;
  camera.model = camera::CameraModel::kPinhole;
  camera.width = 800;
  camera.height = 600;
  camera.params = {700.0, 700.0, 400.0, 300.0};
  survey.cameras.push_back(camera);
  const int n = options.photos_per_side;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const Eigen::Vector3d eye(options.width_m * (i + 0.5) / n, options.height_m * (j + 0.5) / n, options.ground_m + options.agl_m);
      survey.photos.push_back(NadirPhoto(eye, "photo_" + std::to_string(j * n + i) + ".jpg"));
      survey.photos.back().is_test = (j * n + i) % 8 == 0;
    }
  }
  base::Random random(7);
  for (int i = 0; i < options.n_points; ++i) {
    survey::SparsePoint point;
    point.x_in_enu = {random.Uniform(0.0, options.width_m), random.Uniform(0.0, options.height_m), options.ground_m + random.Uniform(-0.2, 0.2)};
    if (point.x_in_enu.x() > 0.5 * options.width_m && point.x_in_enu.y() > 0.5 * options.height_m) {
      point.x_in_enu.z() += options.roof_m - options.ground_m;
    }
    if (options.empty_east && point.x_in_enu.x() > options.width_m * 2.0 / 3.0) continue;
    point.track_length = 5;
    survey.points.push_back(point);
  }
  return survey;
}

}  // namespace skyquilt::partition
