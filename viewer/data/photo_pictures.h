// Photos as smaller JPEGs.
#pragma once

#include <filesystem>
#include <string>

namespace skyquilt::viewer {

// At most `width` pixels wide, stored pixels as they are (EXIF rotation is not applied: the survey's cameras refer to stored pixels).
// Throws base::InputError.
std::string PhotoPicture(const std::filesystem::path& photo, int width);

// Whether the file begins as a JPEG does, so that it can be sent as it is.
bool IsJpeg(const std::filesystem::path& photo);

}  // namespace skyquilt::viewer
