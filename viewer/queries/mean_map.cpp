#include "viewer/queries/mean_map.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/image/image.h"

namespace skyquilt::viewer {
namespace {

constexpr int kPngLevel = 6;

int CellsAlong(double extent_m, double cell_m) {
  return std::clamp(static_cast<int>(std::ceil(extent_m / cell_m - 1e-9)), 1, MeanMap::kMaxSide);
}

}  // namespace

MeanMap::MeanMap(const Eigen::Vector2d& min_enu, const Eigen::Vector2d& max_enu, double finest_m) {
  const Eigen::Vector2d size = max_enu - min_enu;
  const double cell_m = std::max(finest_m, size.maxCoeff() / kMaxSide);
  grid_ = {min_enu, cell_m, CellsAlong(size.x(), cell_m), CellsAlong(size.y(), cell_m)};
  sums_.resize(grid_.size());
  counts_.resize(grid_.size());
}

void MeanMap::Add(const Eigen::Vector2d& place, double value) {
  const int64_t cell = grid_.CellAt(place);
  if (cell < 0) return;
  sums_[static_cast<size_t>(cell)] += value;
  ++counts_[static_cast<size_t>(cell)];
}

bool MeanMap::Empty() const {
  return std::all_of(counts_.begin(), counts_.end(), [](uint32_t count) { return count == 0; });
}

double MeanMap::Quantile(double share) const {
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

std::string MeanMap::Picture(double scale) const {
  image::ImageF means(grid_.columns, grid_.rows, 1);
  image::Image8 picture(grid_.columns, grid_.rows, 4);
  for (int y = 0; y < grid_.rows; ++y) {
    for (int x = 0; x < grid_.columns; ++x) {
      const size_t cell = grid_.Index(x, grid_.rows - 1 - y);
      if (counts_[cell] == 0) continue;
      *means.At(x, y) = static_cast<float>(sums_[cell] / counts_[cell]);
      picture.At(x, y)[3] = 255;
    }
  }
  const image::Image8 colors = image::Colorize(means, 0.0F, static_cast<float>(scale));
  for (int y = 0; y < grid_.rows; ++y) {
    for (int x = 0; x < grid_.columns; ++x) {
      if (picture.At(x, y)[3] != 0) std::copy_n(colors.At(x, y), 3, picture.At(x, y));
    }
  }
  return image::EncodePng(picture, kPngLevel);
}

}  // namespace skyquilt::viewer
