// Pictures of a survey's photos at the detail that a map needs, read when they are asked for and kept while memory allows.
#pragma once

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "core/survey/survey.h"

namespace skyquilt::products {

struct PhotoPicture {
  image::Image8 rgb;
  image::Image8 mask;     // 0 = ignored pixel; empty: none
  camera::Camera camera;  // of the picture's size

  size_t Bytes() const { return rgb.data.size() + mask.data.size(); }
};

// The photo reduced to about pixels_per_cell pixels per cell of cell_m metres on the ground at ground_z, never enlarged. Throws base::InputError when
// it cannot be read or does not have the size that it had when the survey was prepared.
PhotoPicture ReadPhotoPicture(const survey::Survey& survey, size_t photo, double ground_z, double cell_m, double pixels_per_cell);

// Thread-safe. Several threads may read different photos at the same time; one photo is read by one of them.
class PhotoPictures {
 public:
  // Keeps a reference to the survey. Pictures that were not used for longest go when those kept have more than `budget` bytes; what a caller still
  // holds counts no more.
  PhotoPictures(const survey::Survey& survey, double ground_z, double cell_m, double pixels_per_cell, size_t budget);

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
  const survey::Survey& survey_;
  double ground_z_, cell_m_, pixels_per_cell_;
  size_t budget_;
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<Entry>> entries_;
  std::list<size_t> recent_;  // photos with pictures, used last first
  size_t bytes_ = 0;
};

}  // namespace skyquilt::products
