#include "viewer/queries/ground_grid.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/image/encode.h"

namespace skyquilt::viewer {
namespace {

constexpr int kPngLevel = 6;

int CellsAlong(double extent_m, double cell_m) {
  return std::clamp(static_cast<int>(std::ceil(extent_m / cell_m - 1e-9)), 1, GroundGrid::kMaxSide);
}

}  // namespace

GroundGrid::GroundGrid(const Eigen::Vector2d& min_enu, const Eigen::Vector2d& max_enu, double finest_m)
    : min_enu_(min_enu),
      cell_m_(std::max(finest_m, (max_enu - min_enu).maxCoeff() / kMaxSide)),
      width_(CellsAlong((max_enu - min_enu).x(), cell_m_)),
      height_(CellsAlong((max_enu - min_enu).y(), cell_m_)),
      sums_(static_cast<size_t>(width_) * static_cast<size_t>(height_)),
      counts_(sums_.size()) {}

void GroundGrid::Add(const Eigen::Vector2d& place, double value) {
  const Eigen::Vector2d at = (place - min_enu_) / cell_m_;
  if (!(at.x() >= 0.0 && at.y() >= 0.0 && at.x() < width_ && at.y() < height_)) return;
  const size_t cell = static_cast<size_t>(at.y()) * static_cast<size_t>(width_) + static_cast<size_t>(at.x());
  sums_[cell] += value;
  ++counts_[cell];
}

bool GroundGrid::Empty() const {
  return std::all_of(counts_.begin(), counts_.end(), [](uint32_t count) { return count == 0; });
}

double GroundGrid::Quantile(double share) const {
  std::vector<double> means;
  for (size_t i = 0; i < counts_.size(); ++i) {
    if (counts_[i] > 0) means.push_back(sums_[i] / counts_[i]);
  }
  SKYQUILT_CHECK(!means.empty(), "no values");
  const auto rank = static_cast<size_t>(std::ceil(share * static_cast<double>(means.size())));
  const auto at = means.begin() + static_cast<std::ptrdiff_t>(std::clamp<size_t>(rank, 1, means.size()) - 1);
  std::nth_element(means.begin(), at, means.end());
  return *at;
}

std::string GroundGrid::Picture(double scale) const {
  image::ImageF means(width_, height_, 1);
  image::Image8 picture(width_, height_, 4);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const size_t cell = static_cast<size_t>(height_ - 1 - y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
      if (counts_[cell] == 0) continue;
      *means.At(x, y) = static_cast<float>(sums_[cell] / counts_[cell]);
      picture.At(x, y)[3] = 255;
    }
  }
  const image::Image8 colors = image::Colorize(means, 0.0F, static_cast<float>(scale));
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      if (picture.At(x, y)[3] != 0) std::copy_n(colors.At(x, y), 3, picture.At(x, y));
    }
  }
  return image::EncodePng(picture, kPngLevel);
}

}  // namespace skyquilt::viewer
