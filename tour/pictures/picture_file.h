// Files of finished pictures, from which a tour is packed. Colours are stored without loss, so that their final quality can be chosen, and changed,
// without rendering again.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/image/depth_code.h"
#include "core/image/image.h"
#include "tour/pictures/picture_request.h"
#include "tour/pictures/render_picture.h"

namespace skyquilt::tour {

struct StoredPicture {
  int width = 0, height = 0;
  std::string png;  // as `skyquilt render` writes it
  // Depth as in RenderedPicture, inverse scale of core/image/depth_code.h. Value (i, j) belongs to pixel (2i, 2j). No bytes, and a range of 0 to 0,
  // when no ray meets a surface.
  int depth_width = 0, depth_height = 0;
  image::DepthRange range;
  std::string depth;
};

StoredPicture Encode(const RenderedPicture& picture);
image::Image8 ColorsOf(const StoredPicture& picture);

// "<key>.picture"
std::string PictureFileName(const std::string& key);
// Atomic, with a checksum. Throws base::InputError.
void SavePicture(const StoredPicture& picture, const std::string& key, const std::filesystem::path& file);
// Nothing when there is no such file, when it is damaged, or made for another key.
std::optional<StoredPicture> LoadPicture(const std::filesystem::path& file, const std::string& key);
// The same with the key of the file's name. Throws base::InputError.
StoredPicture OpenPicture(const std::filesystem::path& file);

}  // namespace skyquilt::tour
