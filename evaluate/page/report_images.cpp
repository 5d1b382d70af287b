#include "evaluate/page/report_images.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/image/normal_image.h"

namespace skyquilt::evaluate::page {

namespace {

constexpr int kJpegQuality = 88;
constexpr int kLargestMapWidth = 1600;
constexpr int kLargestColorsWidth = 640;

image::Image8 Fit(const image::Image8& picture, int max_width) {
  if (picture.width <= max_width) return picture;
  return image::Resize(picture, max_width, image::ScaledHeight(picture.width, picture.height, max_width));
}

// As PNG: thin bright lines of a colour map would lose their colour in JPEG's chroma subsampling.
std::string WriteColors(const image::Image8& picture, const std::filesystem::path& report_folder, const std::string& name, int max_width) {
  const std::string relative = "images/" + name;
  image::SavePng(Fit(picture, std::min(max_width, kLargestColorsWidth)), report_folder / relative);
  return relative;
}

std::string Write(const image::Image8& picture, const std::filesystem::path& report_folder, const std::string& name, int max_width) {
  const std::string relative = "images/" + name;
  image::SaveJpeg(Fit(picture, max_width), report_folder / relative, kJpegQuality);
  return relative;
}

// Sets the size of a photo's images after Fit.
template <typename Images>
void SetShownSize(const image::Image8& photo, int max_width, Images* images) {
  images->width = std::min(max_width, photo.width);
  images->height = images->width < photo.width ? image::ScaledHeight(photo.width, photo.height, images->width) : photo.height;
}

}  // namespace

image::ImageF AbsoluteError(const image::Image8& photo, const image::Image8& render) {
  SKYQUILT_CHECK(photo.width == render.width && photo.height == render.height && photo.channels == 3 && render.channels == 3,
                 "both must be RGB images of the same size");
  image::ImageF error(photo.width, photo.height, 1);
  for (size_t i = 0; i < error.data.size(); ++i) {
    int sum = 0;
    for (size_t c = 0; c < 3; ++c) sum += std::abs(static_cast<int>(photo.data[3 * i + c]) - static_cast<int>(render.data[3 * i + c]));
    error.data[i] = static_cast<float>(sum) / (3.0F * 255.0F);
  }
  return error;
}

image::Image8 ErrorPicture(const PhotoPixels& pixels, float error_high) {
  image::Image8 picture = image::Colorize(AbsoluteError(*pixels.photo, *pixels.render), 0.0F, error_high);
  SKYQUILT_CHECK(pixels.scored.size() * 3 == picture.data.size(), "there must be one flag per pixel");
  for (size_t i = 0; i < pixels.scored.size(); ++i) {
    if (pixels.scored[i] != 0) continue;
    const uint8_t* rgb = pixels.photo->data.data() + 3 * i;
    const auto grey = static_cast<uint8_t>(40 + (rgb[0] + rgb[1] + rgb[2]) / 9);
    std::fill_n(picture.data.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, grey);
  }
  return picture;
}

bool PercentileRange(const image::ImageF& image, double low, double high, float* low_value, float* high_value) {
  std::vector<float> values;
  // About 200000 values are enough for a percentile.
  const size_t stride = std::max<size_t>(1, image.data.size() / 200000);
  for (size_t i = 0; i < image.data.size(); i += stride) {
    if (std::isfinite(image.data[i])) values.push_back(image.data[i]);
  }
  if (values.empty()) return false;
  *low_value = base::NearestRankQuantile(values, low);
  *high_value = base::NearestRankQuantile(values, high);
  return true;
}

PhotoImages WritePhotoImages(const PhotoPixels& pixels, const std::filesystem::path& report_folder, const std::string& prefix, int max_width,
                             float error_high) {
  PhotoImages images;
  SetShownSize(*pixels.photo, max_width, &images);
  images.photo = Write(*pixels.photo, report_folder, prefix + "_photo.jpg", max_width);
  images.render = Write(*pixels.render, report_folder, prefix + "_render.jpg", max_width);
  images.error = WriteColors(ErrorPicture(pixels, error_high), report_folder, prefix + "_error.png", max_width);
  float low = 0.0F, high = 1.0F;
  if (pixels.depth != nullptr && PercentileRange(*pixels.depth, 0.02, 0.98, &low, &high)) {
    images.depth = WriteColors(image::Colorize(*pixels.depth, low, high), report_folder, prefix + "_depth.png", max_width);
    images.depth_low_m = static_cast<double>(low);
    images.depth_high_m = static_cast<double>(high);
  }
  const auto write_normals = [&](const image::ImageF* normals, const char* name) {
    return normals == nullptr ? std::string() : WriteColors(image::ShowNormals(*normals), report_folder, prefix + name, max_width);
  };
  images.normals = write_normals(pixels.normals, "_normals.png");
  images.true_normals = write_normals(pixels.true_normals, "_true_normals.png");
  if (pixels.expected_error != nullptr) {
    images.trust = WriteColors(image::Colorize(*pixels.expected_error, 0.0F, error_high), report_folder, prefix + "_trust.png", max_width);
  }
  if (pixels.mesh != nullptr) images.mesh = Write(*pixels.mesh, report_folder, prefix + "_mesh.jpg", max_width);
  return images;
}

BrightnessView WriteBrightnessView(const image::Image8& photo, const image::Image8& recorded, const image::Image8& normal,
                                   const std::filesystem::path& report_folder, const std::string& prefix, int max_width) {
  BrightnessView view;
  SetShownSize(photo, max_width, &view);
  view.photo = Write(photo, report_folder, prefix + "_taken.jpg", max_width);
  view.recorded = Write(recorded, report_folder, prefix + "_recorded.jpg", max_width);
  view.normal = Write(normal, report_folder, prefix + "_normal.jpg", max_width);
  return view;
}

std::string WriteColorRamp(const std::filesystem::path& report_folder) {
  image::ImageF ramp(128, 4, 1);
  for (int y = 0; y < ramp.height; ++y) {
    for (int x = 0; x < ramp.width; ++x) *ramp.At(x, y) = static_cast<float>(x);
  }
  const std::string relative = "images/ramp.png";
  image::SavePng(image::Colorize(ramp, 0.0F, static_cast<float>(ramp.width - 1)), report_folder / relative);
  return relative;
}

std::optional<MapBackground> CopyMapBackground(const std::filesystem::path& products_folder, const std::filesystem::path& report_folder) {
  std::error_code ignored;
  std::string name = "orthophoto";
  const auto is_missing = [&] { return !std::filesystem::is_regular_file(products_folder / (name + ".png"), ignored); };
  const bool made = !is_missing();
  if (!made) name = "preview_ortho";
  if (is_missing()) name = "preview_context";
  const std::filesystem::path png = products_folder / (name + ".png");
  const std::filesystem::path bounds = products_folder / (name + ".json");
  if (!std::filesystem::is_regular_file(png, ignored) || !std::filesystem::is_regular_file(bounds, ignored)) return std::nullopt;
  const auto json = base::TryParseJson(base::ReadFile(bounds));
  const auto corner = [&](const char* key) -> std::optional<Eigen::Vector2d> {
    if (!json.is_object() || !json.contains(key) || !json[key].is_array() || json[key].size() < 2) return std::nullopt;
    if (!json[key][0].is_number() || !json[key][1].is_number()) return std::nullopt;
    return Eigen::Vector2d(json[key][0].get<double>(), json[key][1].get<double>());
  };
  const auto low = corner("min_enu"), high = corner("max_enu");
  if (!low || !high || !(high->array() > low->array()).all()) {
    base::LogWarning("{}: has no usable bounds, so the map of the report has no orthophoto; make it again with `skyquilt run`", bounds.string());
    return std::nullopt;
  }
  try {
    int width = 0, height = 0;
    image::ReadImageSize(png, &width, &height);
    MapBackground background{"images/" + name + ".png", *low, *high};
    if (!made) background.preview = json.contains("preview") && json["preview"].is_string() ? json["preview"].get<std::string>() : "photos";
    if (width <= kLargestMapWidth) {
      // Small enough to be used as it is.
      std::filesystem::copy_file(png, report_folder / background.image, std::filesystem::copy_options::overwrite_existing);
    } else {
      background.image = "images/" + name + ".jpg";
      image::SaveJpeg(Fit(image::LoadRgb8(png), kLargestMapWidth), report_folder / background.image, kJpegQuality);
    }
    return background;
  } catch (const base::InputError& error) {
    base::LogWarning("the map of the report has no orthophoto: {}", error.what());
    return std::nullopt;
  } catch (const std::filesystem::filesystem_error& error) {
    base::LogWarning("the map of the report has no orthophoto: {}", error.what());
    return std::nullopt;
  }
}

}  // namespace skyquilt::evaluate::page
