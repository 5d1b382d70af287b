// The photos in which control points are marked: finds them by the names in control point files, and turns marks into pixels of the stored photos.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "prepare/control/reading/raw_control.h"
#include "prepare/models/photo_names.h"

namespace skyquilt::prepare::control {

struct PhotoSize {
  std::string name;                             // as in survey::Photo::name
  int width = 0, height = 0;                    // pixels, as stored
  int original_width = 0, original_height = 0;  // before it was made smaller or larger, as stored, if known; 0: not known
  int orientation = 1;                          // by its EXIF, see core/survey/orientation.h
};

struct StoredMark {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  // of the stored photo, in the convention of ControlMark
  std::optional<Eigen::Vector2d> if_upright = {};   // see ControlMark
};

class ControlPhotos {
 public:
  explicit ControlPhotos(const std::vector<PhotoSize>& photos);

  // As PhotoNames::Find; null: none.
  const PhotoSize* Find(const std::string& name) const;
  const models::PhotoNames& names() const { return finder_; }

 private:
  std::vector<PhotoSize> photos_;
  models::PhotoNames finder_;
};

// Where the marks are in the stored photos. `photos[i]` is that of marks[i]. Marks of which the file states the size of the photo are scaled to the
// stored one. A program marks all photos either as they are stored or upright, as their EXIF orientation says, and all in their present or in their
// original size: of these four the first with the fewest marks outside of their photos is taken, in the order stored, upright, stored in original
// size, upright in original size. `warnings` says what is not as stored. Where upright marks would fit as well, StoredMark::if_upright has them.
// Throws base::InputError with the line: a mark outside its photo, a stated size of another shape.
std::vector<StoredMark> StoredPixels(const std::filesystem::path& file, const std::vector<RawMark>& marks,
                                     const std::vector<const PhotoSize*>& photos, std::vector<std::string>& warnings);

}  // namespace skyquilt::prepare::control
