#include "prepare/input/match_sizes.h"

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "core/base/errors.h"
#include "core/base/log.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

using WidthAndHeight = std::pair<int, int>;

// What observations of an image are multiplied by.
using ScaleOfImage = std::map<uint32_t, Eigen::Vector2d>;

// Gives each camera of which all photos have one other size that size, and otherwise a new camera per size.
ScaleOfImage ScaleCameras(const FileOfImage& file_of_image, const std::vector<PhotoFile>& files, survey::ColmapModel& model, size_t* n_scaled,
                          std::string* example) {
  std::map<uint32_t, std::set<WidthAndHeight>> sizes;
  for (const survey::ColmapImage& image : model.images) {
    const auto file = file_of_image.find(image.id);
    if (file != file_of_image.end()) sizes[image.camera_id].insert({files[file->second].width, files[file->second].height});
  }
  const std::map<uint32_t, camera::Camera> originals = model.cameras;
  std::map<std::pair<uint32_t, WidthAndHeight>, uint32_t> camera_of_size;
  ScaleOfImage scales;
  for (survey::ColmapImage& image : model.images) {
    const camera::Camera& original = originals.at(image.camera_id);
    const auto file = file_of_image.find(image.id);
    // Images without a photo go with their camera.
    const std::set<WidthAndHeight>& of_camera = sizes[image.camera_id];
    WidthAndHeight size{original.width, original.height};
    if (file != file_of_image.end()) {
      size = {files[file->second].width, files[file->second].height};
    } else if (of_camera.size() == 1) {
      size = *of_camera.begin();
    }
    const auto [width, height] = size;
    if ((width == original.width && height == original.height) || !IsScaledSize(width, height, original.width, original.height)) continue;
    const uint32_t old_id = image.camera_id;
    const auto [found, is_new] = camera_of_size.try_emplace({old_id, size}, old_id);
    if (is_new) {
      if (of_camera.size() > 1) found->second = model.cameras.rbegin()->first + 1;
      model.cameras[found->second] = original.Resized(width, height);
    }
    image.camera_id = found->second;
    scales[image.id] = {static_cast<double>(width) / original.width, static_cast<double>(height) / original.height};
    if (file == file_of_image.end()) continue;
    if (++*n_scaled == 1) *example = fmt::format("{} from {}x{} to {}x{}", image.name, original.width, original.height, width, height);
  }
  return scales;
}

}  // namespace

bool IsScaledSize(int width_a, int height_a, int width_b, int height_b) {
  if (width_a > width_b) {
    std::swap(width_a, width_b);
    std::swap(height_a, height_b);
  }
  if (width_a <= 0 || height_a <= 0 || height_a > height_b) return false;
  const double ratio = static_cast<double>(width_a) / width_b, ratio_down = static_cast<double>(height_a) / height_b;
  return std::abs(height_b * ratio - height_a) <= 1.0 || std::abs(width_b * ratio_down - width_a) <= 1.0;
}

fs::path ScaleToPhotos(const FileOfImage& file_of_image, const std::vector<PhotoFile>& files, const fs::path& model_folder, bool has_observations,
                       const fs::path& folder, survey::ColmapModel& model) {
  size_t n_scaled = 0;
  std::string example;
  const ScaleOfImage scales = ScaleCameras(file_of_image, files, model, &n_scaled, &example);
  if (scales.empty()) return model_folder;
  base::LogInfo("the cameras of {} photos in the model are scaled to the photos: {}", n_scaled, example);
  if (!has_observations) return model_folder;
  survey::ColmapObservations observations;
  try {
    observations = survey::ReadColmapObservations(model_folder);
  } catch (const base::InputError&) {
    return model_folder;  // whoever needs them says what is wrong
  }
  for (const auto& [image_id, scale] : scales) {
    for (survey::ColmapObservation& observation : observations[image_id]) observation.pixel = observation.pixel.cwiseProduct(scale);
  }
  std::map<uint32_t, std::set<uint64_t>> seen;
  for (const auto& [image_id, list] : observations) {
    for (const survey::ColmapObservation& observation : list) seen[image_id].insert(observation.point_id);
  }
  survey::ColmapModel written = model;
  for (survey::ColmapPoint& point : written.points) {
    std::erase_if(point.image_ids, [&](uint32_t image_id) { return !seen[image_id].contains(point.id); });
  }
  survey::WriteColmapBinary(written, observations, folder);
  return folder;
}

}  // namespace skyquilt::prepare::input
