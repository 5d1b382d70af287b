#include "core/survey/photo_pictures.h"

#include <algorithm>
#include <span>
#include <utility>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"

namespace skyquilt::survey {
namespace {

constexpr size_t kNamedFailures = 3;

}  // namespace

PhotoPicture ReadPhotoPicture(const Survey& survey, size_t photo, int width) {
  const Photo& source = survey.photos[photo];
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
  width = std::clamp(width, 1, camera.width);
  PhotoPicture picture;
  picture.rgb = image::LoadReducedRgb8(file, width);
  if (picture.rgb.width > width) picture.rgb = image::Resize(picture.rgb, width, image::ScaledHeight(camera.width, camera.height, width));
  if (!source.mask.empty()) picture.mask = image::ResizeMask(image::LoadMask(source.mask), picture.rgb.width, picture.rgb.height);
  picture.camera = camera.Resized(picture.rgb.width, picture.rgb.height);
  return picture;
}

PhotoPictures::PhotoPictures(size_t photos, std::function<PhotoPicture(size_t)> read, size_t budget) : read_(std::move(read)), budget_(budget) {
  entries_.reserve(photos);
  for (size_t i = 0; i < photos; ++i) entries_.push_back(std::make_unique<Entry>());
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
    read = std::make_shared<const PhotoPicture>(read_(photo));
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

void WarnOfUnreadPhotos(std::string_view product, const std::vector<std::string>& failures, size_t of) {
  if (failures.empty()) return;
  const size_t named = std::min(failures.size(), kNamedFailures);
  base::LogWarning("{} does without {} of {} photos, which cannot be read:\n  {}{}", product, failures.size(), of,
                   base::Join(std::span(failures).first(named), "\n  "), named < failures.size() ? "\n  ..." : "");
}

}  // namespace skyquilt::survey
