// Photos that are not stored as a picture of 8 bits: HEIC of phones (by libheif) and raw files of cameras (by LibRaw). Each becomes the same picture
// in every run, and photos of one camera stay comparable: nothing is brightened by what a photo shows.
#pragma once

#include <filesystem>
#include <string>

#include "core/image/image.h"

namespace skyquilt::image {

// By the extension: heic, heif, hif, avif; dng, and raw formats of Canon, Nikon, Sony, Fujifilm, Olympus, Panasonic, Pentax and Samsung.
bool NeedsDeveloping(const std::string& file_name);

// As stored: neither EXIF's orientation nor HEIF's rotation is applied. Throws base::InputError.
void ReadDevelopedSize(const std::filesystem::path& file, int* width, int* height);

// The EXIF block of a HEIC file, from its TIFF header on; empty for other files, and where there is none. Throws base::InputError.
std::string ExifOfHeif(const std::filesystem::path& file);

// RGB. HEIC: the main picture; depth maps, thumbnails and other pictures of the file are ignored, more than 8 bits are rounded. Raw: the camera's
// white balance, sRGB's primaries and curve, white where the sensor is full, so that a value is the same light times the exposure in all photos. Lens
// corrections that a DNG asks for are left out: they are the lens model's. Throws base::InputError for what is damaged or cannot be read.
Image8 DevelopPhoto(const std::filesystem::path& file);

}  // namespace skyquilt::image
