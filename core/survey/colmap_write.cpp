#include <cstdio>
#include <unordered_map>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/survey/colmap_model.h"

namespace skyquilt::survey {
namespace {

std::string Text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof(buffer), "%.17g", value);
  return buffer;
}

struct Observation {
  Eigen::Vector2d pixel;
  uint64_t point_id;
};

}  // namespace

void WriteColmapText(const ColmapModel& model, const std::filesystem::path& folder) {
  base::RequireWritableFolder(folder);

  std::string cameras = "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
  for (const auto& [id, camera] : model.cameras) {
    cameras += std::to_string(id) + " " + camera::ModelName(camera.model) + " " + std::to_string(camera.width) + " " + std::to_string(camera.height);
    for (const double parameter : camera.params) cameras += " " + Text(parameter);
    cameras += "\n";
  }

  std::unordered_map<uint32_t, size_t> image_index;
  for (size_t i = 0; i < model.images.size(); ++i) image_index.emplace(model.images[i].id, i);
  std::vector<std::vector<Observation>> observations(model.images.size());

  std::string points =
      "# 3D point list with one line of data per point:\n#   POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
  for (const ColmapPoint& point : model.points) {
    points += std::to_string(point.id);
    for (int axis = 0; axis < 3; ++axis) points += " " + Text(point.x_in_world[axis]);
    for (const uint8_t channel : point.rgb) points += " " + std::to_string(int{channel});
    points += " " + Text(point.error_px);
    for (const uint32_t image_id : point.image_ids) {
      const auto found = image_index.find(image_id);
      SKYQUILT_CHECK(found != image_index.end(), "track names image " + std::to_string(image_id));
      const ColmapImage& image = model.images[found->second];
      const auto pixel = model.cameras.at(image.camera_id).ImgFromCam(image.cam_from_world * point.x_in_world);
      points += " " + std::to_string(image_id) + " " + std::to_string(observations[found->second].size());
      observations[found->second].push_back({pixel.value_or(Eigen::Vector2d::Zero()), point.id});
    }
    points += "\n";
  }

  std::string images =
      "# Image list with two lines of data per image:\n#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n#   POINTS2D[] as (X, Y, "
      "POINT3D_ID)\n";
  for (size_t i = 0; i < model.images.size(); ++i) {
    const ColmapImage& image = model.images[i];
    const Eigen::Quaterniond& q = image.cam_from_world.rotation;
    images += std::to_string(image.id);
    for (const double value : {q.w(), q.x(), q.y(), q.z()}) images += " " + Text(value);
    for (int axis = 0; axis < 3; ++axis) images += " " + Text(image.cam_from_world.translation[axis]);
    images += " " + std::to_string(image.camera_id) + " " + image.name + "\n";
    const char* separator = "";
    for (const Observation& observation : observations[i]) {
      images += separator + Text(observation.pixel.x()) + " " + Text(observation.pixel.y()) + " " + std::to_string(observation.point_id);
      separator = " ";
    }
    images += "\n";
  }

  base::WriteFileAtomically(folder / "cameras.txt", cameras);
  base::WriteFileAtomically(folder / "images.txt", images);
  base::WriteFileAtomically(folder / "points3D.txt", points);
}

}  // namespace skyquilt::survey
