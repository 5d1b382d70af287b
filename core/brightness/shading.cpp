#include "core/brightness/shading.h"

#include <algorithm>
#include <charconv>

#include "core/base/errors.h"

namespace skyquilt::brightness {
namespace {

constexpr int kFewestKnots = 2, kMostKnots = 32;

template <typename Number>
void AddPrior(const ShadingGrid& grid, std::span<const Number> log_shading, double strength, std::span<double> gradient) {
  const auto columns = static_cast<size_t>(grid.columns), rows = static_cast<size_t>(grid.rows);
  const auto pair = [&](size_t a, size_t b) {
    const double difference = static_cast<double>(log_shading[a]) - static_cast<double>(log_shading[b]);
    gradient[a] += strength * kShadingSmoothness * difference;
    gradient[b] -= strength * kShadingSmoothness * difference;
  };
  for (size_t row = 0; row < rows; ++row) {
    for (size_t column = 0; column < columns; ++column) {
      const size_t k = row * columns + column;
      gradient[k] += strength * static_cast<double>(log_shading[k]);
      if (column + 1 < columns) pair(k, k + 1);
      if (row + 1 < rows) pair(k, k + columns);
    }
  }
}

}  // namespace

std::optional<ShadingGrid> ShadingGrid::Parse(std::string_view text) {
  const auto allowed = [](int knots) { return knots >= kFewestKnots && knots <= kMostKnots; };
  ShadingGrid grid;
  const char* const end = text.data() + text.size();
  const auto columns = std::from_chars(text.data(), end, grid.columns);
  if (columns.ec != std::errc() || columns.ptr == end || *columns.ptr != 'x') return std::nullopt;
  const auto rows = std::from_chars(columns.ptr + 1, end, grid.rows);
  if (rows.ec != std::errc() || rows.ptr != end || !allowed(grid.columns) || !allowed(grid.rows)) return std::nullopt;
  return grid;
}

KnotWeights KnotsAt(const ShadingGrid& grid, const PicturePlace& place) {
  const auto along = [](float at, int knots, float* part) {
    const float position = std::clamp(at, 0.0F, 1.0F) * static_cast<float>(knots - 1);
    const int first = std::min(static_cast<int>(position), knots - 2);
    *part = position - static_cast<float>(first);
    return static_cast<size_t>(first);
  };
  float x = 0.0F, y = 0.0F;
  const size_t column = along(place[0], grid.columns, &x), row = along(place[1], grid.rows, &y);
  const size_t first = row * static_cast<size_t>(grid.columns) + column, below = first + static_cast<size_t>(grid.columns);
  return {{first, first + 1, below, below + 1}, {(1.0F - x) * (1.0F - y), x * (1.0F - y), (1.0F - x) * y, x * y}};
}

std::vector<double> KnotShares(const ShadingGrid& grid) {
  const auto share = [](int knot, int knots) { return (knot == 0 || knot == knots - 1 ? 0.5 : 1.0) / (knots - 1); };
  std::vector<double> shares;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) shares.push_back(share(column, grid.columns) * share(row, grid.rows));
  }
  return shares;
}

void AddShadingPrior(const ShadingGrid& grid, std::span<const float> log_shading, double strength, std::span<double> gradient) {
  AddPrior(grid, log_shading, strength, gradient);
}

void AddShadingPrior(const ShadingGrid& grid, std::span<const double> log_shading, double strength, std::span<double> gradient) {
  AddPrior(grid, log_shading, strength, gradient);
}

void CentreShading(const ShadingGrid& grid, std::span<const uint8_t> learns, std::span<float> log_shading) {
  const size_t knots = grid.knots();
  SKYQUILT_CHECK(log_shading.size() == learns.size() * knots, "a grid per photo");
  const std::vector<double> shares = KnotShares(grid);
  std::vector<double> of_knot(knots, 0.0), of_photo(learns.size(), 0.0);
  double photos = 0.0, all = 0.0;
  for (size_t i = 0; i < learns.size(); ++i) {
    if (learns[i] == 0) continue;
    photos += 1.0;
    for (size_t k = 0; k < knots; ++k) {
      const auto value = static_cast<double>(log_shading[i * knots + k]);
      of_knot[k] += value;
      of_photo[i] += shares[k] * value;
    }
    all += of_photo[i];
  }
  if (photos == 0.0) return;
  for (size_t i = 0; i < learns.size(); ++i) {
    if (learns[i] == 0) continue;
    for (size_t k = 0; k < knots; ++k) {
      float& value = log_shading[i * knots + k];
      value = static_cast<float>(static_cast<double>(value) - of_knot[k] / photos - of_photo[i] + all / photos);
    }
  }
}

}  // namespace skyquilt::brightness
