// Small maps of local metres for tests.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/gis/geotiff.h"

namespace skyquilt::evaluate::ortho {

inline gis::MapGrid LocalGrid(double left, double top, double cell_m, int width, int height) {
  return {.georeferenced = false, .zone = {}, .left = left, .top = top, .resolution_m = cell_m, .width = width, .height = height};
}

// Colours in levels by the place of a cell's centre; negative red: no data.
using PaintedMap = std::function<std::array<double, 3>(double x, double y)>;

inline void WriteColours(const gis::MapGrid& grid, const PaintedMap& paint, const std::filesystem::path& file) {
  std::vector<uint8_t> values;
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      const Eigen::Vector2d place = grid.CellCentre(column, row);
      const std::array<double, 3> colour = paint(place.x(), place.y());
      for (const double level : colour) values.push_back(static_cast<uint8_t>(std::lround(std::max(level, 0.0))));
      values.push_back(colour[0] < 0.0 ? 0 : 255);
    }
  }
  gis::GeoTiffSpec spec;
  spec.grid = grid;
  spec.bands = 4;
  gis::GeoTiffWriter writer(file, spec);
  writer.WriteRows(0, grid.height, std::span<const uint8_t>(values));
  writer.Close();
}

inline void WriteNumbers(const gis::MapGrid& grid, const std::function<double(double x, double y)>& number, const std::filesystem::path& file) {
  std::vector<float> values;
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      const Eigen::Vector2d place = grid.CellCentre(column, row);
      values.push_back(static_cast<float>(number(place.x(), place.y())));
    }
  }
  gis::GeoTiffSpec spec;
  spec.grid = grid;
  spec.type = gis::PixelType::kFloat32;
  gis::GeoTiffWriter writer(file, spec);
  writer.WriteRows(0, grid.height, std::span<const float>(values));
  writer.Close();
}

}  // namespace skyquilt::evaluate::ortho
