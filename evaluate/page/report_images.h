// Writes the images of the report: photo, render, error and depth of held-out photos, their brightness, the colour ramp, the background of the map.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "core/image/image.h"
#include "evaluate/page/report_page.h"

namespace skyquilt::evaluate::page {

struct PhotoPixels {
  const image::Image8* photo = nullptr;
  const image::Image8* render = nullptr;
  const image::ImageF* depth = nullptr;           // metres along z of the camera, NaN where there is none
  std::span<const uint8_t> scored;                // row-major, 0 = masked or not covered
  const image::ImageF* normals = nullptr;         // of the rendering, ENU; null: not shown
  const image::ImageF* true_normals = nullptr;    // null: not shown
  const image::ImageF* expected_error = nullptr;  // one channel, NaN where there is none; null: not shown
  const image::Image8* mesh = nullptr;            // of the surface, at the photo's brightness; null: not shown
};

// Mean over RGB of |photo - render| in display values, one channel. Sizes must agree.
image::ImageF AbsoluteError(const image::Image8& photo, const image::Image8& render);
// Colours from 0 to error_high; pixels that are not scored show the photo in dimmed grey.
image::Image8 ErrorPicture(const PhotoPixels& pixels, float error_high);
// Quantiles `low` and `high` (0..1) of the finite values; false when there is none.
bool PercentileRange(const image::ImageF& image, double low, double high, float* low_value, float* high_value);

// Writes <prefix>_photo.jpg, _render.jpg, _error.png, _depth.png and, if given, _normals.png, _true_normals.png, _trust.png and _mesh.jpg under
// report_folder/images, at most max_width pixels wide. Throws base::InputError.
PhotoImages WritePhotoImages(const PhotoPixels& pixels, const std::filesystem::path& report_folder, const std::string& prefix, int max_width,
                             float error_high);
// Writes images/<prefix>_taken.jpg, _recorded.jpg and _normal.jpg under report_folder, at most max_width pixels wide. The caller fills in name
// and stops. Throws base::InputError.
BrightnessView WriteBrightnessView(const image::Image8& photo, const image::Image8& recorded, const image::Image8& normal,
                                   const std::filesystem::path& report_folder, const std::string& prefix, int max_width);
// Writes images/ramp.png and returns its relative path.
std::string WriteColorRamp(const std::filesystem::path& report_folder);
// Copies products/orthophoto.png beside the page and reads its bounds from products/orthophoto.json; without an orthophoto the
// preview with most detail, products/preview_ortho.png or preview_context.png with its .json. Nothing when either file is missing or damaged.
std::optional<MapBackground> CopyMapBackground(const std::filesystem::path& products_folder, const std::filesystem::path& report_folder);

}  // namespace skyquilt::evaluate::page
