#include "tour/pictures/panorama_rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/errors.h"

namespace skyquilt::tour {
namespace {

constexpr int kPanoramaTile = 32;  // pixels

}  // namespace

PanoramaRays::PanoramaRays(const Eigen::Vector3d& eye_enu, int width)
    : eye_enu_(eye_enu), pitch_(static_cast<float>(2.0 * std::numbers::pi / width)) {
  SKYQUILT_CHECK(width >= 2 && width % 2 == 0, "a panorama " + std::to_string(width) + " pixels wide");
  const double pixel = 2.0 * std::numbers::pi / width;
  for (int column = 0; column < width; ++column) {
    const double azimuth = (column + 0.5 - 0.5 * width) * pixel;
    across_.emplace_back(std::sin(azimuth), std::cos(azimuth));
  }
  for (int row = 0; row < width / 2; ++row) {
    const double elevation = (0.25 * width - (row + 0.5)) * pixel;
    up_.emplace_back(std::cos(elevation), std::sin(elevation));
  }
}

void PanoramaRays::Make(std::span<const size_t> pixels, std::span<render::Ray> out) const {
  SKYQUILT_CHECK(pixels.size() == out.size(), std::to_string(pixels.size()) + " pixels, " + std::to_string(out.size()) + " rays");
  const size_t width = across_.size();
  for (size_t i = 0; i < pixels.size(); ++i) {
    const Eigen::Vector2d& across = across_[pixels[i] % width];
    const Eigen::Vector2d& up = up_[pixels[i] / width];
    out[i] = {.origin_enu = eye_enu_,
              .direction_enu = Eigen::Vector3d(across.x() * up.x(), across.y() * up.x(), up.y()).normalized(),
              .pixel_pitch = pitch_};
  }
}

std::vector<size_t> PanoramaOrder(int width) {
  const int height = width / 2;
  std::vector<size_t> pixels;
  pixels.reserve(static_cast<size_t>(width) * static_cast<size_t>(height));
  for (int x0 = 0; x0 < width; x0 += kPanoramaTile) {
    // The tiles of a column of tiles follow each other: its rows from the top.
    for (int y = 0; y < height; ++y) {
      for (int x = x0; x < std::min(x0 + kPanoramaTile, width); ++x) {
        pixels.push_back(static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x));
      }
    }
  }
  return pixels;
}

}  // namespace skyquilt::tour
