#include "viewer/data/map_files.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/gis/geotiff.h"
#include "core/gis/read_maps.h"
#include "core/image/image.h"

namespace skyquilt::viewer {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied into files as they are in memory");

constexpr int kTerrainCells = 512;
constexpr int kOrthophotoPixels = 2048;
constexpr size_t kMaxPoints = 2'000'000;
constexpr int64_t kMaxContourVertices = 300'000;
constexpr int kPictureQuality = 88;

template <typename T>
void Append(std::string* bytes, const T& value) {
  const size_t at = bytes->size();
  bytes->resize(at + sizeof(T));
  std::memcpy(bytes->data() + at, &value, sizeof(T));
}

void AppendAnchor(std::string* bytes, const Eigen::Vector3d& anchor) {
  for (int axis = 0; axis < 3; ++axis) Append(bytes, anchor(axis));
}

void AppendOffset(std::string* bytes, const Eigen::Vector3d& offset) {
  for (int axis = 0; axis < 3; ++axis) Append(bytes, static_cast<float>(offset(axis)));
}

// Columns to read a raster with, so that its longer side has at most `most`.
int ReducedWidth(const gis::MapGrid& grid, int most) {
  const int longer = std::max(grid.width, grid.height);
  if (longer <= most) return grid.width;
  return std::max(1, static_cast<int>(static_cast<int64_t>(grid.width) * most / longer));
}

uint8_t Byte(float value) {
  return static_cast<uint8_t>(std::lround(std::clamp(std::isfinite(value) ? value : 0.0F, 0.0F, 255.0F)));
}

}  // namespace

std::string TerrainFile(const std::filesystem::path& dsm, const SurveyFrame& frame) {
  const gis::MapGrid grid = gis::ReadMapGrid(dsm);
  const gis::ReducedRaster heights = gis::ReadReduced(dsm, ReducedWidth(grid, kTerrainCells));
  const int columns = heights.image.width, rows = heights.image.height;
  std::string bytes = "SKYTERR1";
  Append(&bytes, static_cast<uint32_t>(columns));
  Append(&bytes, static_cast<uint32_t>(rows));
  const Eigen::Vector2d middle = grid.CellCentre(0.5 * grid.width, 0.5 * grid.height);
  double ground = 0.0;
  for (const float value : heights.image.data) {
    if (!std::isfinite(value)) continue;
    ground = static_cast<double>(value);
    break;
  }
  const Eigen::Vector3d anchor = frame.EnuFromMap(middle, ground);
  AppendAnchor(&bytes, anchor);
  bytes.reserve(bytes.size() + heights.image.data.size() * 12);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const float height = *heights.image.At(column, row);
      // The middle of the cells that this one stands for.
      const Eigen::Vector2d map = grid.CellCentre((column + 0.5) * heights.scale - 0.5, (row + 0.5) * heights.scale_down - 0.5);
      if (std::isfinite(height)) {
        AppendOffset(&bytes, frame.EnuFromMap(map, static_cast<double>(height)) - anchor);
      } else {
        AppendOffset(&bytes, Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
      }
    }
  }
  return bytes;
}

std::string OrthophotoFile(const std::filesystem::path& orthophoto) {
  const gis::MapGrid grid = gis::ReadMapGrid(orthophoto);
  const gis::ReducedRaster raster = gis::ReadReduced(orthophoto, ReducedWidth(grid, kOrthophotoPixels));
  image::Image8 picture(raster.image.width, raster.image.height, 3, 128);
  const int channels = raster.image.channels;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const float* from = raster.image.At(x, y);
      if (channels == 4 && !(from[3] > 0.0F)) continue;
      for (int c = 0; c < 3; ++c) picture.At(x, y)[c] = Byte(from[std::min(c, channels - 1)]);
    }
  }
  const std::vector<uint8_t> jpeg = image::EncodeJpeg(picture, kPictureQuality);
  return {jpeg.begin(), jpeg.end()};
}

std::string PointsFile(const std::vector<survey::SparsePoint>& points) {
  const size_t step = std::max<size_t>(1, (points.size() + kMaxPoints - 1) / kMaxPoints);
  const size_t count = (points.size() + step - 1) / step;
  std::string bytes = "SKYPNTS1";
  Append(&bytes, static_cast<uint32_t>(count));
  Append(&bytes, uint32_t{0});
  const Eigen::Vector3d anchor = points.empty() ? Eigen::Vector3d::Zero() : points[points.size() / 2].x_in_enu;
  AppendAnchor(&bytes, anchor);
  bytes.reserve(bytes.size() + 15 * count);
  for (size_t i = 0; i < points.size(); i += step) AppendOffset(&bytes, points[i].x_in_enu - anchor);
  for (size_t i = 0; i < points.size(); i += step) bytes.append(reinterpret_cast<const char*>(points[i].rgb.data()), 3);
  return bytes;
}

std::string ContoursFile(const std::filesystem::path& gpkg, const SurveyFrame& frame) {
  const gis::Contours contours = gis::ReadContours(gpkg, kMaxContourVertices);
  double interval = 0.0;
  nlohmann::json lines = nlohmann::json::array();
  double last = std::numeric_limits<double>::quiet_NaN();
  for (const gis::ContourLine& line : contours.lines) {
    const double rise = line.height_m - last;
    if (rise > 1e-9 && (interval == 0.0 || rise < interval)) interval = rise;
    last = line.height_m;
    nlohmann::json points = nlohmann::json::array();
    for (const Eigen::Vector2d& map : line.map_xy) {
      const Eigen::Vector3d enu = frame.EnuFromMap(map, line.height_m);
      points.push_back(std::round(enu.x() * 1000.0) / 1000.0);
      points.push_back(std::round(enu.y() * 1000.0) / 1000.0);
    }
    lines.push_back({{"height_m", line.height_m}, {"index", line.index}, {"points", std::move(points)}});
  }
  return nlohmann::json{{"interval_m", interval}, {"thinned", contours.thinned}, {"lines", std::move(lines)}}.dump();
}

}  // namespace skyquilt::viewer
