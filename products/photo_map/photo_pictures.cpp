#include "products/photo_map/photo_pictures.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::products {

PhotoPicture ReadPhotoPicture(const survey::Survey& survey, size_t photo, double ground_z, double cell_m, double pixels_per_cell) {
  const survey::Photo& source = survey.photos[photo];
  const camera::Camera& camera = survey.cameras[static_cast<size_t>(source.camera)];
  const std::filesystem::path file = survey.photo_root / source.name;
  int stored_width = 0, stored_height = 0;
  image::ReadImageSize(file, &stored_width, &stored_height);
  if (stored_width != camera.width || stored_height != camera.height) {
    throw base::InputError(file,
                           "the photo has " + std::to_string(stored_width) + " x " + std::to_string(stored_height) + " pixels, and had " +
                               std::to_string(camera.width) + " x " + std::to_string(camera.height) + " when the survey was prepared",
                           "Put the photo back that was used then, or prepare the survey again");
  }
  const double gsd_m = camera::GroundSamplingDistance(camera, std::max(source.cam_from_enu.OriginInSource().z() - ground_z, 1e-6));
  const int width = std::max(1, static_cast<int>(std::min<double>(camera.width, std::ceil(pixels_per_cell * camera.width * gsd_m / cell_m))));
  PhotoPicture picture;
  picture.rgb = image::LoadReducedRgb8(file, width);
  if (picture.rgb.width > width) picture.rgb = image::Resize(picture.rgb, width, image::ScaledHeight(camera.width, camera.height, width));
  if (!source.mask.empty()) picture.mask = image::ResizeMask(image::LoadMask(source.mask), picture.rgb.width, picture.rgb.height);
  picture.camera = camera.Resized(picture.rgb.width, picture.rgb.height);
  return picture;
}

PhotoPictures::PhotoPictures(const survey::Survey& survey, double ground_z, double cell_m, double pixels_per_cell, size_t budget)
    : survey_(survey), ground_z_(ground_z), cell_m_(cell_m), pixels_per_cell_(pixels_per_cell), budget_(budget) {
  entries_.reserve(survey.photos.size());
  for (size_t i = 0; i < survey.photos.size(); ++i) entries_.push_back(std::make_unique<Entry>());
}

std::shared_ptr<const PhotoPicture> PhotoPictures::Of(size_t photo) {
  Entry& entry = *entries_[photo];
  const std::lock_guard reading(entry.reading);
  {
    const std::lock_guard lock(mutex_);
    if (entry.picture) {
      recent_.splice(recent_.begin(), recent_, entry.place);
      return entry.picture;
    }
    if (!entry.failure.empty()) return nullptr;
  }
  std::shared_ptr<const PhotoPicture> read;
  std::string failure;
  try {
    read = std::make_shared<const PhotoPicture>(ReadPhotoPicture(survey_, photo, ground_z_, cell_m_, pixels_per_cell_));
  } catch (const base::InputError& error) {
    failure = error.what();
  }
  const std::lock_guard lock(mutex_);
  if (!read) {
    entry.failure = failure;
    return nullptr;
  }
  entry.picture = read;
  recent_.push_front(photo);
  entry.place = recent_.begin();
  bytes_ += read->Bytes();
  while (bytes_ > budget_ && recent_.size() > 1) {
    Entry& oldest = *entries_[recent_.back()];
    bytes_ -= oldest.picture->Bytes();
    oldest.picture.reset();
    recent_.pop_back();
  }
  return read;
}

std::vector<std::string> PhotoPictures::Failures() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> failures;
  for (const std::unique_ptr<Entry>& entry : entries_) {
    if (!entry->failure.empty()) failures.push_back(entry->failure);
  }
  return failures;
}

}  // namespace skyquilt::products
