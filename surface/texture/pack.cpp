#include "surface/texture/pack.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace skyquilt::surface {
namespace {

struct AtlasRow {
  int64_t top = 0;
  int height = 0;
  int used = 0;
};

int64_t RoundUp(int64_t n) {
  return (n + kAtlasMultiple - 1) / kAtlasMultiple * kAtlasMultiple;
}

// Returns the height; corners may be null.
int64_t PackIntoWidth(std::span<const Eigen::Vector2i> sizes, const std::vector<size_t>& order, int64_t width,
                      std::vector<Eigen::Vector2i>* corners) {
  std::vector<AtlasRow> rows;
  int64_t bottom = 0;
  size_t first_open = 0;  // rows before it have no room left at all
  for (const size_t i : order) {
    const Eigen::Vector2i& size = sizes[i];
    size_t r = first_open;
    while (r < rows.size() && rows[r].used + size.x() > width) ++r;
    if (r == rows.size()) {
      rows.push_back({bottom, size.y(), 0});
      bottom += size.y();
    }
    AtlasRow& row = rows[r];
    if (corners) (*corners)[i] = {row.used, static_cast<int>(row.top)};
    row.used += size.x();
    while (first_open < rows.size() && rows[first_open].used >= width) ++first_open;
  }
  return bottom;
}

}  // namespace

std::optional<Packing> PackRows(std::span<const Eigen::Vector2i> sizes, int limit) {
  if (sizes.empty()) return Packing{};
  const int64_t widest_allowed = limit / kAtlasMultiple * kAtlasMultiple;
  int64_t widest = 0;
  double area = 0.0;
  for (const Eigen::Vector2i& size : sizes) {
    widest = std::max<int64_t>(widest, size.x());
    area += static_cast<double>(size.x()) * size.y();
  }
  if (widest > widest_allowed || area > static_cast<double>(widest_allowed) * static_cast<double>(widest_allowed)) return std::nullopt;
  std::vector<size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&sizes](size_t a, size_t b) {
    if (sizes[a].y() != sizes[b].y()) return sizes[a].y() > sizes[b].y();
    if (sizes[a].x() != sizes[b].x()) return sizes[a].x() > sizes[b].x();
    return a < b;
  });
  int64_t best_width = 0;
  int64_t best_height = 0;
  for (const double factor : {1.0, 1.05, 1.1, 1.2, 1.3, 1.5, 1.0e9}) {
    const auto wished = static_cast<int64_t>(std::min(std::sqrt(area) * factor, static_cast<double>(widest_allowed)));
    const int64_t width = std::min(RoundUp(std::max(wished, widest)), widest_allowed);
    const int64_t height = RoundUp(PackIntoWidth(sizes, order, width, nullptr));
    if (height > widest_allowed) continue;
    if (best_width == 0 || width * height < best_width * best_height) {
      best_width = width;
      best_height = height;
    }
  }
  if (best_width == 0) return std::nullopt;
  Packing packing;
  packing.width = static_cast<int>(best_width);
  packing.height = static_cast<int>(best_height);
  packing.corner.resize(sizes.size());
  PackIntoWidth(sizes, order, best_width, &packing.corner);
  return packing;
}

}  // namespace skyquilt::surface
