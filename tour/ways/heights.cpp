#include "tour/ways/heights.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/errors.h"

namespace skyquilt::tour {

Heights::Heights(const Eigen::Vector2d& min, const Eigen::Vector2d& cell_m, int columns, int rows, std::vector<double> z)
    : cell_m_(cell_m), columns_(columns), rows_(rows), z_(std::move(z)) {
  SKYQUILT_CHECK(columns >= 1 && rows >= 1 && z_.size() == static_cast<size_t>(columns) * static_cast<size_t>(rows) && min.allFinite(),
                 std::to_string(columns) + " x " + std::to_string(rows));
  SKYQUILT_CHECK(cell_m.allFinite() && cell_m.minCoeff() > 0.0, "cells without size");
  box_.extend(min);
  box_.extend(min + Eigen::Vector2d(columns * cell_m.x(), rows * cell_m.y()));
}

std::optional<double> Heights::At(double x, double y) const {
  const double column = std::floor((x - box_.min().x()) / cell_m_.x()), row = std::floor((y - box_.min().y()) / cell_m_.y());
  if (!(column >= 0.0 && column < columns_ && row >= 0.0 && row < rows_)) return {};
  const double z = Top(static_cast<int>(column), static_cast<int>(row));
  return std::isnan(z) ? std::nullopt : std::optional(z);
}

double Heights::Highest(double x, double y, double radius_m) const {
  return Strongest(x, y, radius_m, [](double z, double) { return z; });
}

double Heights::Dilated(double x, double y, double radius_m, double slack_m) const {
  const double square = radius_m * radius_m;
  return Strongest(x, y, radius_m + slack_m, [&](double z, double distance_m) {
    const double d = std::max(0.0, distance_m - slack_m);
    return z + std::sqrt(square - d * d);
  });
}

bool Heights::IsFar(double x, double y, double radius_m) const {
  return !(x + radius_m > box_.min().x() && x - radius_m < box_.max().x()) || !(y + radius_m > box_.min().y() && y - radius_m < box_.max().y());
}

double Heights::Strongest(double x, double y, double radius_m, const std::function<double(double z, double distance_m)>& of) const {
  double best = kNothing;
  if (IsFar(x, y, radius_m)) return best;
  const Eigen::Vector2d from(x - box_.min().x(), y - box_.min().y());
  const auto cell = [&](double at, int axis, int cells) { return static_cast<int>(std::clamp(std::floor(at / cell_m_(axis)), 0.0, cells - 1.0)); };
  const int first_column = cell(from.x() - radius_m, 0, columns_), last_column = cell(from.x() + radius_m, 0, columns_);
  const int first_row = cell(from.y() - radius_m, 1, rows_), last_row = cell(from.y() + radius_m, 1, rows_);
  for (int row = first_row; row <= last_row; ++row) {
    const double dy = std::max({0.0, row * cell_m_.y() - from.y(), from.y() - (row + 1) * cell_m_.y()});
    for (int column = first_column; column <= last_column; ++column) {
      const double z = Top(column, row);
      // Also passes over NaN. No height that this column can give exceeds this.
      if (!(z + radius_m > best)) continue;
      const double dx = std::max({0.0, column * cell_m_.x() - from.x(), from.x() - (column + 1) * cell_m_.x()});
      const double distance_m = std::sqrt(dx * dx + dy * dy);
      if (distance_m < radius_m) best = std::max(best, of(z, distance_m));
    }
  }
  return best;
}

}  // namespace skyquilt::tour
