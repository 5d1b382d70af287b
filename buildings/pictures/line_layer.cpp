#include "buildings/pictures/line_layer.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::buildings {

LineLayer::LineLayer(int width, int height)
    : width_(width), height_(height), coverage_(static_cast<size_t>(width) * static_cast<size_t>(height), 0.0F) {}

void LineLayer::Add(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double width_px) {
  if (!a.allFinite() || !b.allFinite()) return;
  const double reach = 0.5 * width_px + 0.5;  // of a pixel's centre from the line
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const auto first = [&](double value, int size) { return static_cast<int>(std::clamp(std::floor(value - reach), 0.0, 1.0 * size)); };
  const auto last = [&](double value, int size) { return static_cast<int>(std::clamp(std::ceil(value + reach), 0.0, 1.0 * size)); };
  for (int y = first(std::min(a.y(), b.y()), height_); y < last(std::max(a.y(), b.y()), height_); ++y) {
    for (int x = first(std::min(a.x(), b.x()), width_); x < last(std::max(a.x(), b.x()), width_); ++x) {
      const Eigen::Vector2d centre(x + 0.5, y + 0.5);
      const double t = length2 > 0.0 ? std::clamp((centre - a).dot(along) / length2, 0.0, 1.0) : 0.0;
      const double covered = std::clamp(reach - (centre - a - t * along).norm(), 0.0, std::min(1.0, width_px));
      float& value = coverage_[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)];
      value = std::max(value, static_cast<float>(covered));
    }
  }
}

void LineLayer::BlendInto(image::Image8* image, const std::array<uint8_t, 3>& rgb, double opacity) const {
  SKYQUILT_CHECK(image->channels == 3 && image->width == width_ && image->height == height_, "lines are drawn into RGB images of their size");
  for (size_t i = 0; i < coverage_.size(); ++i) {
    const double share = opacity * static_cast<double>(coverage_[i]);
    if (!(share > 0.0)) continue;
    for (size_t c = 0; c < 3; ++c) {
      uint8_t& value = image->data[3 * i + c];
      value = static_cast<uint8_t>(std::lround((1.0 - share) * value + share * rgb[c]));
    }
  }
}

}  // namespace skyquilt::buildings
