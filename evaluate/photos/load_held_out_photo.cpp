#include "evaluate/photos/load_held_out_photo.h"

#include <algorithm>
#include <filesystem>

#include "core/image/normal_image.h"

namespace skyquilt::evaluate::photos {

namespace {

// The file of a photo in a folder of truth, which may have the photos' sub-folders or not; empty when there is none.
std::filesystem::path TruthFile(const std::filesystem::path& folder, const std::string& photo, const char* extension) {
  if (folder.empty()) return {};
  const std::filesystem::path name = std::filesystem::path(photo).replace_extension(extension);
  for (const std::filesystem::path& file : {folder / name, folder / name.filename()}) {
    if (std::filesystem::is_regular_file(file)) return file;
  }
  return {};
}

// A local frame has no metres and no north to compare with.
void LoadTruth(const survey::Survey& survey, const std::string& photo, HeldOutPhoto* task) {
  if (!survey.truth || !survey.georeferenced) return;
  const survey::Truth& truth = *survey.truth;
  if (const auto file = TruthFile(truth.depth_folder, photo, ".tiff"); !file.empty()) task->true_depth = image::LoadFloatTiff(file);
  if (const auto file = TruthFile(truth.normals_folder, photo, ".png"); !file.empty()) task->true_normals = image::LoadNormals(file);
  if (const auto file = TruthFile(truth.classes_folder, photo, ".png"); !file.empty()) task->true_class = image::LoadLabels(file);
}

}  // namespace

HeldOutPhoto LoadHeldOutPhoto(const survey::Survey& survey, const image::PixelCache& pixels, int index, int image_width) {
  const auto i = static_cast<size_t>(index);
  const survey::Photo& photo = survey.photos[i];
  const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
  const int cached_width = pixels.Width(i);
  const int width = image_width > 0 ? std::min(image_width, camera.width) : cached_width;
  HeldOutPhoto task;
  task.cam_from_enu = photo.cam_from_enu;
  image::Image8 mask;
  if (width <= cached_width) {
    task.photo = image::Image8(cached_width, pixels.Height(i), 3);
    const auto rgb = pixels.Rgb(i);
    std::copy(rgb.begin(), rgb.end(), task.photo.data.begin());
    if (const auto cached_mask = pixels.Mask(i); !cached_mask.empty()) {
      mask = image::Image8(cached_width, pixels.Height(i), 1);
      std::copy(cached_mask.begin(), cached_mask.end(), mask.data.begin());
    }
  } else {
    task.photo = image::LoadRgb8(survey.photo_root / photo.name);
    if (!photo.mask.empty()) mask = image::LoadMask(photo.mask);
  }
  if (task.photo.width != width) {
    task.photo = image::Resize(task.photo, width, image::ScaledHeight(task.photo.width, task.photo.height, width));
  }
  if (!mask.Empty()) {
    if (mask.width != task.photo.width || mask.height != task.photo.height) mask = image::ResizeMask(mask, task.photo.width, task.photo.height);
    task.mask = std::move(mask.data);
  }
  task.camera = camera.Resized(task.photo.width, task.photo.height);
  LoadTruth(survey, photo.name, &task);
  return task;
}

}  // namespace skyquilt::evaluate::photos
