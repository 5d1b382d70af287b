#include "partition/block_grid.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "core/base/errors.h"

namespace skyquilt::partition {
namespace {

[[noreturn]] void Refuse(const std::string& text, const std::string& rule) {
  throw base::UsageError("blocks = \"" + text + "\": " + rule + " (use auto, RxC such as 2x2, or size:<metres>)");
}

template <typename Number>
std::optional<Number> ParseNumber(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::vector<double> Edges(double low, double high, int cells) {
  std::vector<double> edges(static_cast<size_t>(cells) + 1);
  for (int i = 0; i <= cells; ++i) edges[static_cast<size_t>(i)] = low + (high - low) * i / cells;
  edges.back() = high;
  return edges;
}

int IntervalOf(const std::vector<double>& edges, double value) {
  if (!(value >= edges.front() && value <= edges.back())) return -1;
  const auto above = std::upper_bound(edges.begin(), edges.end(), value);
  const auto interval = static_cast<int>(above - edges.begin()) - 1;
  return std::min(interval, static_cast<int>(edges.size()) - 2);
}

}  // namespace

BlockRequest ParseBlockRequest(const std::string& text) {
  BlockRequest request;
  if (text == "auto") return request;
  if (text.rfind("size:", 0) == 0) {
    const auto size = ParseNumber<double>(text.substr(5));
    if (!size) Refuse(text, "the size is not a number");
    if (!std::isfinite(*size) || *size <= 0.0) Refuse(text, "the size of a block must be a positive number of metres");
    request.kind = BlockRequestKind::kSize;
    request.size_m = *size;
    return request;
  }
  const size_t cross = text.find_first_of("xX");
  if (cross == std::string::npos) Refuse(text, "is not a number of blocks");
  const auto rows = ParseNumber<int>(text.substr(0, cross));
  const auto columns = ParseNumber<int>(text.substr(cross + 1));
  if (!rows || !columns) Refuse(text, "rows and columns must be whole numbers");
  if (*rows < 1 || *columns < 1) Refuse(text, "rows and columns must be at least 1");
  if (static_cast<int64_t>(*rows) * *columns > kMaxBlocks) Refuse(text, "more than " + std::to_string(kMaxBlocks) + " blocks");
  request.kind = BlockRequestKind::kCount;
  request.rows = *rows;
  request.columns = *columns;
  return request;
}

int BlockGrid::CellOf(double x, double y) const {
  const int column = IntervalOf(x_edges, x);
  const int row = IntervalOf(y_edges, y);
  return row < 0 || column < 0 ? -1 : row * columns() + column;
}

BlockGrid SplitByCount(const Eigen::Vector2d& min_enu, const Eigen::Vector2d& max_enu, int rows, int columns) {
  SKYQUILT_CHECK(rows >= 1 && columns >= 1, std::to_string(rows) + "x" + std::to_string(columns));
  SKYQUILT_CHECK((max_enu.array() > min_enu.array()).all(), "empty area");
  return {Edges(min_enu.x(), max_enu.x(), columns), Edges(min_enu.y(), max_enu.y(), rows)};
}

BlockGrid SplitBySize(const Eigen::Vector2d& min_enu, const Eigen::Vector2d& max_enu, double size_m) {
  SKYQUILT_CHECK(std::isfinite(size_m) && size_m > 0.0, std::to_string(size_m));
  SKYQUILT_CHECK((max_enu.array() > min_enu.array()).all(), "empty area");
  // Subtract a little, so that a rounding error does not add a column.
  const Eigen::Array2d count = ((max_enu - min_enu).array() / size_m - 1e-9).ceil().max(1.0);
  if (count.x() * count.y() > kMaxBlocks) {
    throw base::UsageError("blocks = \"size:" + std::to_string(size_m) + "\": an area of " + std::to_string(max_enu.x() - min_enu.x()) + " x " +
                           std::to_string(max_enu.y() - min_enu.y()) + " m would need more than " + std::to_string(kMaxBlocks) +
                           " blocks; use a larger size");
  }
  const Eigen::Vector2d centre = 0.5 * (min_enu + max_enu);
  const Eigen::Vector2d half = 0.5 * size_m * count.matrix();
  return SplitByCount(centre - half, centre + half, static_cast<int>(count.y()), static_cast<int>(count.x()));
}

}  // namespace skyquilt::partition
