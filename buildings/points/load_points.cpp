#include <algorithm>
#include <cmath>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "buildings/points/surface_points.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "surface/tile_store.h"

namespace skyquilt::buildings {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMakeAgain = "Run 'skyquilt surface' with --restart and --set surface.cloud=true";

// The points of one tile, relative to a place of their own, so that single precision is enough before the middle of all is known.
struct TilePoints {
  Eigen::Vector3d middle;
  std::vector<SurfacePoint> points;
};

// The number of a tile from the name of its file, "0_<column>_<row>.bin"; false for other files.
bool ReadTileName(const fs::path& file, surface::TileId* id) {
  if (file.extension() != ".bin") return false;
  const std::string name = file.stem().string();
  if (!name.starts_with("0_")) return false;
  const size_t second = name.find('_', 2);
  if (second == std::string::npos) return false;
  try {
    size_t column_end = 0, row_end = 0;
    const std::string column = name.substr(2, second - 2), row = name.substr(second + 1);
    *id = {0, std::stoi(column, &column_end), std::stoi(row, &row_end)};
    return column_end == column.size() && row_end == row.size();
  } catch (const std::logic_error&) {
    return false;
  }
}

// In the order in which the surface was made, which is that of its cloud: by number, not by name.
std::vector<std::pair<surface::TileId, fs::path>> FinestTiles(const fs::path& folder) {
  std::vector<std::pair<surface::TileId, fs::path>> tiles;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    surface::TileId id;
    if (ReadTileName(entry->path(), &id)) tiles.emplace_back(id, entry->path());
  }
  if (error) throw base::InputError(folder, "cannot be read: " + error.message() + "; it holds the points of the surface", kMakeAgain);
  std::sort(tiles.begin(), tiles.end());
  return tiles;
}

// Without points that are not finite, which the cloud leaves out too, and with their repair of normals.
TilePoints Convert(const std::vector<surface::CloudPoint>& points) {
  TilePoints tile;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  size_t n = 0;
  for (const surface::CloudPoint& point : points) {
    if (!point.position.allFinite()) continue;
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
    ++n;
  }
  tile.middle = n > 0 ? Eigen::Vector3d(0.5 * (low + high)) : Eigen::Vector3d::Zero();
  tile.points.reserve(n);
  for (const surface::CloudPoint& point : points) {
    if (!point.position.allFinite()) continue;
    SurfacePoint& kept = tile.points.emplace_back();
    kept.position = (point.position - tile.middle).cast<float>();
    const double length = point.normal.cast<double>().norm();
    kept.normal =
        length > 1e-12 && std::isfinite(length) ? Eigen::Vector3f((point.normal.cast<double>() / length).cast<float>()) : Eigen::Vector3f::UnitZ();
    kept.rgb = point.rgb;
    kept.views = point.views;
    kept.filled = point.filled;
  }
  return tile;
}

Eigen::Vector3d MiddleOf(const std::vector<TilePoints>& tiles) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const TilePoints& tile : tiles) {
    if (tile.points.empty()) continue;
    low = low.cwiseMin(tile.middle);
    high = high.cwiseMax(tile.middle);
  }
  return (0.5 * (low + high)).array().round();
}

}  // namespace

PointCloud LoadSurfacePoints(const fs::path& surface_work_folder, double spacing_m) {
  SKYQUILT_CHECK(spacing_m > 0.0 && std::isfinite(spacing_m), "spacing " + std::to_string(spacing_m));
  const fs::path folder = surface_work_folder / "textures";
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw base::InputError(folder, "does not exist; it holds the points of the surface", kMakeAgain);
  std::vector<TilePoints> tiles;
  size_t n = 0;
  for (const auto& [id, file] : FinestTiles(folder)) {
    base::ThrowIfCancelled();
    try {
      const surface::BakedTile baked = surface::LoadBakedTile(file);
      tiles.push_back(Convert(baked.points));
    } catch (const base::InputError& damaged) {
      // The store's own advice, to delete the file and go on, holds only while a surface is being made.
      const std::string& finding = damaged.finding();
      throw base::InputError(file, finding.substr(0, finding.find(". ")), kMakeAgain);
    }
    n += tiles.back().points.size();
  }
  if (n == 0) throw base::InputError(folder, "has no points: the surface was made without a cloud, or nothing was found", kMakeAgain);
  PointCloud cloud;
  cloud.spacing_m = spacing_m;
  cloud.middle = MiddleOf(tiles);
  cloud.points.reserve(n);
  for (TilePoints& tile : tiles) {
    const Eigen::Vector3d shift = tile.middle - cloud.middle;
    for (SurfacePoint& point : tile.points) {
      point.position = (point.position.cast<double>() + shift).cast<float>();
      cloud.points.push_back(point);
    }
    tile.points = {};  // freed at once: all points are in memory about once
  }
  return cloud;
}

}  // namespace skyquilt::buildings
