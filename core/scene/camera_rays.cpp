#include "core/scene/camera_rays.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "core/base/errors.h"

namespace skyquilt::scene {
namespace {

constexpr int kTile = 32;  // pixels

int TileColumns(int width) {
  return (width + kTile - 1) / kTile;
}

}  // namespace

CameraRays::CameraRays(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, bool cones)
    : camera_(camera),
      enu_from_cam_(cam_from_enu.Inverse()),
      // Scenes without cones use the pitch for the length of steps only.
      nominal_(static_cast<float>(1.0 / std::max(1e-9, camera.FocalX()))) {
  if (cones) pitch_.emplace(camera);
}

void CameraRays::MakeRow(int row, std::span<render::Ray> out) const {
  std::vector<size_t> pixels(static_cast<size_t>(camera_.width));
  std::iota(pixels.begin(), pixels.end(), static_cast<size_t>(row) * pixels.size());
  Make(pixels, out);
}

void CameraRays::Make(std::span<const size_t> pixels, std::span<render::Ray> out) const {
  SKYQUILT_CHECK(pixels.size() == out.size(), std::to_string(pixels.size()) + " pixels, " + std::to_string(out.size()) + " rays");
  const auto width = static_cast<size_t>(camera_.width);
  for (size_t i = 0; i < pixels.size(); ++i) {
    const size_t row = pixels[i] / width, column = pixels[i] % width;
    const Eigen::Vector2d img(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
    out[i] = {.origin_enu = enu_from_cam_.translation,
              .direction_enu = (enu_from_cam_.rotation * camera_.RayFromImg(img)).normalized(),
              .pixel_pitch = pitch_ ? static_cast<float>(pitch_->At(img)) : nominal_};
  }
}

int TileCount(int width, int height) {
  return TileColumns(width) * ((height + kTile - 1) / kTile);
}

void AppendTilePixels(int width, int height, int first, int end, std::vector<size_t>* pixels) {
  const int columns = TileColumns(width);
  for (int tile = first; tile < end; ++tile) {
    const int x0 = tile % columns * kTile, y0 = tile / columns * kTile;
    for (int y = y0; y < std::min(y0 + kTile, height); ++y) {
      for (int x = x0; x < std::min(x0 + kTile, width); ++x) {
        pixels->push_back(static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x));
      }
    }
  }
}

}  // namespace skyquilt::scene
