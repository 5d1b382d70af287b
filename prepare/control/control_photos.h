// The photos in which control points are marked: finds them by the names in control point files, and turns marks into pixels of the stored photos.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "prepare/control/raw_control.h"
#include "prepare/models/photo_names.h"

namespace skyquilt::prepare {

struct PhotoSize {
  std::string name;                             // as in survey::Photo::name
  int width = 0, height = 0;                    // pixels, as stored
  int original_width = 0, original_height = 0;  // before it was made smaller or larger, if known; 0: not known
};

class ControlPhotos {
 public:
  explicit ControlPhotos(const std::vector<PhotoSize>& photos);

  // As PhotoNames::Find; null: none.
  const PhotoSize* Find(const std::string& name) const;

 private:
  std::vector<PhotoSize> photos_;
  PhotoNames finder_;
};

// The marks' pixels in the stored photos, in the convention of ControlMark. `photos[i]` is that of marks[i]. Marks of which the file states the size
// of the photo are scaled to the stored one. When others lie outside their photos but all of them fit the sizes the photos had before, they are
// scaled from there, and `warnings` says so. Throws base::InputError with the line: a mark outside its photo, a stated size of another shape.
std::vector<Eigen::Vector2d> StoredPixels(const std::filesystem::path& file, const std::vector<RawMark>& marks,
                                          const std::vector<const PhotoSize*>& photos, std::vector<std::string>& warnings);

}  // namespace skyquilt::prepare
