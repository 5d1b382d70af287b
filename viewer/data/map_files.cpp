#include "viewer/data/map_files.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/geo/geoid.h"
#include "core/gis/geotiff.h"
#include "core/gis/read_maps.h"
#include "core/image/image.h"
#include "surface/files/earth_place.h"

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

// The reduced surface model: points at the centres of cells, in rows.
struct PointGrid {
  gis::MapGrid map;
  int columns = 0, rows = 0;

  // Throws base::InputError, also when there is no place between the points.
  explicit PointGrid(const std::filesystem::path& dsm) : map(gis::ReadMapGrid(dsm)) {
    // Whole cells are read by columns, from which the rows follow.
    const int longer = std::max(map.width, map.height);
    columns = longer <= kTerrainCells ? map.width : static_cast<int>(std::lround(static_cast<double>(map.width) * kTerrainCells / longer));
    if (columns > 0) rows = static_cast<int>(std::lround(static_cast<double>(map.height) * columns / map.width));
    if (columns < 2 || rows < 2) throw base::InputError(dsm, "is too small or too narrow to be shown", "");
  }
  // Easting and northing.
  Eigen::Vector2d At(int column, int row) const {
    return map.CellCentre((column + 0.5) * map.width / columns - 0.5, (row + 0.5) * map.height / rows - 0.5);
  }
};

// The survey's heights from those of a map around a place.
class SurveyHeights {
 public:
  // undulations: gis::ReadUndulations of the file. Throws base::InputError when PROJ has no geoid but it is needed.
  SurveyHeights(int undulations, const Eigen::Vector2d& middle_xy, double radius_m, const geo::UtmZone& zone, const std::filesystem::path& file)
      : undulations_(undulations), zone_(zone) {
    if (undulations == 0) return;
    try {
      geoid_.emplace(geo::GeodeticFromUtm(middle_xy, 0.0, zone), radius_m);
    } catch (const std::runtime_error& missing) {
      throw base::InputError(file, std::string("has heights that cannot be converted: ") + missing.what(), "Install proj-data");
    }
  }
  double At(const Eigen::Vector2d& map_xy, double height_m) const {
    if (!geoid_) return height_m;
    const geo::Geodetic place = geo::GeodeticFromUtm(map_xy, height_m, zone_);
    return height_m - undulations_ * geoid_->At(place.latitude_deg, place.longitude_deg);
  }

 private:
  int undulations_;
  geo::UtmZone zone_;
  std::optional<geo::GeoidPatch> geoid_;
};

uint8_t Byte(float value) {
  return static_cast<uint8_t>(std::lround(std::clamp(std::isfinite(value) ? value : 0.0F, 0.0F, 255.0F)));
}

}  // namespace

std::string TerrainFile(const std::filesystem::path& dsm, const SurveyFrame& frame) {
  const PointGrid grid(dsm);
  frame.RequireFits(grid.map.georeferenced, dsm);
  // The highest of each cell: ways of tours keep away from what these points and the surface between them show.
  const gis::ReducedRaster heights = gis::ReadReduced(dsm, grid.columns, gis::Reduction::kMaximum);
  SKYQUILT_CHECK(heights.image.width == grid.columns && heights.image.height == grid.rows, dsm.string());
  const SurveyHeights in_survey(gis::ReadUndulations(dsm), grid.At(grid.columns / 2, grid.rows / 2),
                                grid.map.resolution_m * std::max(grid.map.width, grid.map.height), grid.map.zone, dsm);
  const auto place_at = [&](int column, int row, double height_m) {
    const Eigen::Vector2d at = grid.At(column, row);
    return frame.EnuFromMap(at, in_survey.At(at, height_m), grid.map.zone);
  };
  std::string bytes = "SKYTERR1";
  Append(&bytes, static_cast<uint32_t>(grid.columns));
  Append(&bytes, static_cast<uint32_t>(grid.rows));
  const auto known = std::find_if(heights.image.data.begin(), heights.image.data.end(), [](float height) { return std::isfinite(height); });
  const double some_height = known == heights.image.data.end() ? 0.0 : static_cast<double>(*known);
  const Eigen::Vector3d anchor = place_at(grid.columns / 2, grid.rows / 2, some_height);
  AppendAnchor(&bytes, anchor);
  bytes.reserve(bytes.size() + heights.image.data.size() * 12);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const float height = *heights.image.At(column, row);
      if (std::isfinite(height)) {
        AppendOffset(&bytes, place_at(column, row, static_cast<double>(height)) - anchor);
      } else {
        AppendOffset(&bytes, Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
      }
    }
  }
  return bytes;
}

std::string OrthophotoFile(const std::filesystem::path& orthophoto, const std::filesystem::path& dsm) {
  const PointGrid grid(dsm);
  const gis::MapGrid own = gis::ReadMapGrid(orthophoto);
  if (own.georeferenced != grid.map.georeferenced || (own.georeferenced && own.zone.Epsg() != grid.map.zone.Epsg())) {
    throw base::InputError(orthophoto, "has another coordinate system than dsm.tif", "Make both again with 'skyquilt render'");
  }
  // The picture's edges are the outermost points, not the outer edges of their cells: that is how it is laid over them.
  Eigen::AlignedBox2d part(grid.At(0, 0));
  part.extend(grid.At(grid.columns - 1, grid.rows - 1));
  const double pixel_m = std::max(own.resolution_m, part.sizes().maxCoeff() / kOrthophotoPixels);
  const auto pixels = [&](double length_m) { return std::clamp(static_cast<int>(std::lround(length_m / pixel_m)), 1, kOrthophotoPixels); };
  const image::ImageF raster = gis::ReadMapPart(orthophoto, part, pixels(part.sizes().x()), pixels(part.sizes().y()));
  image::Image8 picture(raster.width, raster.height, 3, 128);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const float* from = raster.At(x, y);
      if (!std::isfinite(from[0]) || (raster.channels == 4 && !(from[3] > 0.0F))) continue;
      for (int c = 0; c < 3; ++c) picture.At(x, y)[c] = Byte(from[std::min(c, raster.channels - 1)]);
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
  frame.RequireFits(contours.georeferenced, gpkg);
  const Eigen::Vector2d some_place = contours.lines.empty() ? Eigen::Vector2d::Zero() : contours.lines.front().map_xy.front();
  constexpr double kNear_m = 10000.0;
  const SurveyHeights in_survey(contours.lines.empty() ? 0 : contours.undulations, some_place, kNear_m, contours.zone, gpkg);
  double interval = 0.0;
  nlohmann::json lines = nlohmann::json::array();
  double last = std::numeric_limits<double>::quiet_NaN();
  for (const gis::ContourLine& line : contours.lines) {
    const double rise = line.height_m - last;
    if (rise > 1e-9 && (interval == 0.0 || rise < interval)) interval = rise;
    last = line.height_m;
    // A line has one height, so that of its first point stands for it: along a line the geoid changes by centimetres.
    const double height_m = in_survey.At(line.map_xy.front(), line.height_m);
    nlohmann::json points = nlohmann::json::array();
    for (const Eigen::Vector2d& map : line.map_xy) {
      const Eigen::Vector3d enu = frame.EnuFromMap(map, height_m, contours.zone);
      // Millimetres.
      points.push_back(std::round(enu.x() * 1000.0) / 1000.0);
      points.push_back(std::round(enu.y() * 1000.0) / 1000.0);
    }
    lines.push_back({{"height_m", height_m}, {"index", line.index}, {"points", std::move(points)}});
  }
  return base::JsonText(nlohmann::json{{"interval_m", interval}, {"thinned", contours.thinned}, {"lines", std::move(lines)}});
}

std::string TilesetFile(const std::filesystem::path& tileset_json) {
  std::string text = base::ReadFile(tileset_json);
  try {
    nlohmann::ordered_json tileset = base::ParseOrderedJson(text);
    if (surface::StandInSurvey(&tileset)) text = base::JsonText(tileset, 1) + "\n";
  } catch (const nlohmann::json::exception&) {
  }
  return text;
}

}  // namespace skyquilt::viewer
