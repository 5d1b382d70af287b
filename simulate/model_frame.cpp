#include "simulate/model_frame.h"

#include <cmath>

#include "core/base/random.h"

namespace skyquilt::simulate {

using Eigen::Vector3d;

geo::Similarity3d RandomModelFrame(uint32_t seed) {
  constexpr double kLargestScale = 50.0;
  constexpr double kLargestShift = 10.0;
  base::Random random(seed, 81);
  geo::Similarity3d model_from_enu;
  model_from_enu.scale = std::exp(random.Uniform(-1.0, 1.0) * std::log(kLargestScale));
  // Normal numbers have no preferred direction: uniform among unit quaternions, and so among rotations.
  Eigen::Vector4d quaternion;
  for (double& number : quaternion) number = random.Normal();
  model_from_enu.rotation = Eigen::Quaterniond(quaternion).normalized();
  Vector3d shift;
  for (double& number : shift) number = random.Normal();
  model_from_enu.translation = random.Uniform(0.0, kLargestShift) * shift.normalized();
  return model_from_enu;
}

void MoveModel(const geo::Similarity3d& model_from_enu, survey::ColmapModel& model) {
  for (survey::ColmapImage& image : model.images) image.cam_from_world = geo::TransformCameraWorld(image.cam_from_world, model_from_enu);
  for (survey::ColmapPoint& point : model.points) point.x_in_world = model_from_enu * point.x_in_world;
}

geo::Similarity3d Inverse(const geo::Similarity3d& b_from_a) {
  geo::Similarity3d a_from_b;
  a_from_b.scale = 1.0 / b_from_a.scale;
  a_from_b.rotation = b_from_a.rotation.conjugate();
  a_from_b.translation = -a_from_b.scale * (a_from_b.rotation * b_from_a.translation);
  return a_from_b;
}

}  // namespace skyquilt::simulate
