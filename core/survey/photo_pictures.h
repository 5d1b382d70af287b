// Photos of a survey as pictures of the detail that a product needs, read when they are asked for and kept while memory allows.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "core/image/image.h"
#include "core/survey/survey.h"

namespace skyquilt::survey {

struct PhotoPicture {
  image::Image8 rgb;
  image::Image8 mask;     // 0 = ignored pixel; empty: none
  camera::Camera camera;  // of the picture's size

  size_t Bytes() const { return rgb.data.size() + mask.data.size(); }
};

// The photo with `width` pixels across, but never enlarged. Throws base::InputError when it cannot be read or does not have the size that it had
// when the survey was prepared.
PhotoPicture ReadPhotoPicture(const Survey& survey, size_t photo, int width);

// Thread-safe. Several threads may read different photos at the same time; one photo is read by one of them.
class PhotoPictures {
 public:
  // read: gives the picture of a photo, or throws base::InputError. Pictures that were not used for longest go when those kept have more than
  // `budget` bytes; what a caller still holds counts no more.
  PhotoPictures(size_t photos, std::function<PhotoPicture(size_t photo)> read, size_t budget);

  // Null when the photo cannot be read, now and from then on.
  std::shared_ptr<const PhotoPicture> Of(size_t photo);
  // Why photos could not be read so far, in order of the photos.
  std::vector<std::string> Failures() const;

 private:
  struct Entry {
    std::mutex reading;
    std::shared_ptr<const PhotoPicture> picture;
    std::string failure;
    std::list<size_t>::iterator place;  // in recent_, with a picture
  };
  std::function<PhotoPicture(size_t)> read_;
  size_t budget_;
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<Entry>> entries_;
  std::list<size_t> recent_;  // photos with pictures, used last first
  size_t bytes_ = 0;
};

// Logs a warning that a product does without photos that could not be read, the first three by name; nothing without failures. of: photos in all.
void WarnOfUnreadPhotos(std::string_view product, const std::vector<std::string>& failures, size_t of);

}  // namespace skyquilt::survey
