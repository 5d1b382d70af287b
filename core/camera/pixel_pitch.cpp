#include "core/camera/pixel_pitch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace skyquilt::camera {
namespace {

constexpr int kColumns = 17, kRows = 13;

double PitchAt(const Camera& camera, double x, double y) {
  const Eigen::Vector3d along_x = camera.RayFromImg({x + 0.5, y}) - camera.RayFromImg({x - 0.5, y});
  const Eigen::Vector3d along_y = camera.RayFromImg({x, y + 0.5}) - camera.RayFromImg({x, y - 0.5});
  return std::sqrt(along_x.cross(along_y).norm());
}

}  // namespace

PixelPitch::PixelPitch(const Camera& camera) : width_(camera.width), height_(camera.height) {
  lattice_.reserve(static_cast<size_t>(kColumns) * kRows);
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column)
      lattice_.push_back(PitchAt(camera, width_ * column / (kColumns - 1), height_ * row / (kRows - 1)));
  }
}

double PixelPitch::At(const Eigen::Vector2d& pixel) const {
  const double u = std::clamp(pixel.x() / width_, 0.0, 1.0) * (kColumns - 1), v = std::clamp(pixel.y() / height_, 0.0, 1.0) * (kRows - 1);
  const int column = std::min(static_cast<int>(u), kColumns - 2), row = std::min(static_cast<int>(v), kRows - 2);
  const double du = u - column, dv = v - row;
  const auto node = [&](int dr, int dc) { return lattice_[static_cast<size_t>((row + dr) * kColumns + column + dc)]; };
  return (1.0 - dv) * ((1.0 - du) * node(0, 0) + du * node(0, 1)) + dv * ((1.0 - du) * node(1, 0) + du * node(1, 1));
}

}  // namespace skyquilt::camera
