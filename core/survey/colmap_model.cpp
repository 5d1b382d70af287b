#include "core/survey/colmap_model.h"

#include <algorithm>
#include <set>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/survey/colmap_files.h"

namespace skyquilt::survey {
namespace {

bool HasAll(const std::filesystem::path& folder, const std::string& extension) {
  for (const char* stem : {"cameras", "images", "points3D"}) {
    if (!std::filesystem::exists(folder / (stem + extension))) return false;
  }
  return true;
}

// Which of the two formats the folder has; binary when both.
bool IsBinary(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) throw base::InputError(folder, "no such folder", "Give the folder with cameras, images and points3D");
  const bool binary = HasAll(folder, ".bin");
  if (!binary && !HasAll(folder, ".txt")) {
    throw base::InputError(folder, "does not contain cameras, images and points3D as .bin or .txt",
                           "Give the folder of one COLMAP model, usually sparse/0");
  }
  return binary;
}

void CheckCameras(const std::filesystem::path& folder, const ColmapModel& model) {
  for (const auto& [id, camera] : model.cameras) {
    const std::string problem = camera.Problem();
    if (!problem.empty()) {
      throw base::InputError(folder, "camera " + std::to_string(id) + " cannot be used: " + problem,
                             "Run the reconstruction again or leave that camera out");
    }
  }
}

void CheckImages(const std::filesystem::path& folder, ColmapModel& model) {
  std::set<std::string> names;
  std::set<uint32_t> ids;
  for (ColmapImage& image : model.images) {
    // Paths of models that were made on Windows.
    std::replace(image.name.begin(), image.name.end(), '\\', '/');
    geo::Rigid3d& pose = image.cam_from_world;
    if (!pose.rotation.coeffs().allFinite() || !pose.translation.allFinite() || !(pose.rotation.norm() > 1e-6)) {
      throw base::InputError(folder, "the pose of photo '" + image.name + "' has NaN or infinity, or a rotation of length 0",
                             "Remove that photo from the model (colmap image_deleter) or run the mapper again");
    }
    pose.rotation.normalize();
    if (image.name.empty()) throw base::InputError(folder, "image " + std::to_string(image.id) + " has no name", "Export the model again");
    if (!names.insert(image.name).second) throw base::InputError(folder, "photo '" + image.name + "' appears twice", "Export the model again");
    if (!ids.insert(image.id).second)
      throw base::InputError(folder, "image id " + std::to_string(image.id) + " appears twice", "Export the model again");
    if (!model.cameras.contains(image.camera_id)) {
      throw base::InputError(folder,
                             "photo '" + image.name + "' refers to camera " + std::to_string(image.camera_id) + ", which the model does not have",
                             "Take cameras, images and points from the same model");
    }
  }
}

}  // namespace

ColmapModel ReadColmapModel(const std::filesystem::path& folder) {
  ColmapModel model = IsBinary(folder) ? ReadColmapBinary(folder) : ReadColmapTextFiles(folder);
  CheckCameras(folder, model);
  CheckImages(folder, model);
  if (model.images.empty()) throw base::InputError(folder, "the model has no registered photo", "Run the reconstruction again");
  const size_t n_dropped = std::erase_if(model.points, [](const ColmapPoint& point) { return !point.x_in_world.allFinite(); });
  if (n_dropped > 0)
    base::LogWarning("{}: {} sparse points have no finite coordinates and are ignored; if there are many, run the reconstruction again",
                     folder.string(), n_dropped);
  return model;
}

ColmapObservations ReadColmapObservations(const std::filesystem::path& folder) {
  ColmapObservations observations = IsBinary(folder) ? ReadObservationsBinary(folder) : ReadObservationsText(folder);
  for (const auto& [image_id, list] : observations) {
    for (const ColmapObservation& observation : list) {
      if (observation.pixel.allFinite()) continue;
      throw base::InputError(folder, "image " + std::to_string(image_id) + " has an observation whose pixel is not finite",
                             "Run the reconstruction again");
    }
  }
  return observations;
}

}  // namespace skyquilt::survey
