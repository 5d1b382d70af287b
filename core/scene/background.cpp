#include "core/scene/background.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "core/base/errors.h"

namespace skyquilt::scene {
namespace {

constexpr const char* kMean[3] = {"background_r", "background_g", "background_b"};
constexpr const char* kHeights = "background/heights";
constexpr const char* kColors = "background/colors";
constexpr const char* kPhotos = "background/photos";
constexpr const char* kSky = "background/sky";

// Between the centres of the sky's cells.
std::array<float, 3> SkyColor(const std::vector<float>& sky_srgb, const Eigen::Vector3d& direction) {
  const Eigen::Vector2d shares = SkyShares(direction);
  const double v = std::clamp(shares.y() * Background::kSkyRows - 0.5, 0.0, Background::kSkyRows - 1.0);
  const double u = shares.x() * Background::kSkyColumns + Background::kSkyColumns - 0.5;
  const int row = std::min(static_cast<int>(v), Background::kSkyRows - 2), column = static_cast<int>(u);
  std::array<float, 3> rgb = {0.0F, 0.0F, 0.0F};
  for (int i = 0; i < 4; ++i) {
    const double along_v = i / 2 == 0 ? 1.0 - (v - row) : v - row, along_u = i % 2 == 0 ? 1.0 - (u - column) : u - column;
    const int cell = (row + i / 2) * Background::kSkyColumns + (column + i % 2) % Background::kSkyColumns;
    for (int c = 0; c < 3; ++c) rgb[static_cast<size_t>(c)] += static_cast<float>(along_v * along_u) * sky_srgb[static_cast<size_t>(3 * cell + c)];
  }
  return rgb;
}

}  // namespace

Eigen::Vector2d SkyShares(const Eigen::Vector3d& direction_enu) {
  const double azimuth = std::atan2(direction_enu.y(), direction_enu.x()) / (2.0 * std::numbers::pi);
  return {azimuth - std::floor(azimuth), std::atan2(direction_enu.z(), direction_enu.head<2>().norm()) / (0.5 * std::numbers::pi)};
}

std::array<float, 3> Background::Color(const Eigen::Vector3d& origin_enu, const Eigen::Vector3d& direction_enu) const {
  if (direction_enu.z() > 0.0 && !sky_srgb.empty()) return SkyColor(sky_srgb, direction_enu);
  Eigen::Vector3d x;
  if (!surface.Intersect(origin_enu, direction_enu, &x)) return mean_srgb;
  const HeightMap::Corners corners = surface.Around(x.x(), x.y());
  std::array<float, 3> rgb = {0.0F, 0.0F, 0.0F};
  for (size_t i = 0; i < 4; ++i) {
    for (size_t c = 0; c < 3; ++c) rgb[c] += static_cast<float>(corners.weight[i]) * rgb_srgb[3 * corners.cell[i] + c];
  }
  return rgb;
}

void PutBackground(const Background& background, checkpoint::ArchiveWriter& writer) {
  for (size_t c = 0; c < 3; ++c) writer.SetAttribute(kMean[c], static_cast<double>(background.mean_srgb[c]));
  if (!background.sky_srgb.empty()) writer.Put(kSky, background.sky_srgb, {Background::kSkyRows, Background::kSkyColumns, 3});
  if (background.surface.Empty()) return;
  const geo::PlaneGrid& grid = background.surface.grid();
  writer.SetAttribute("background_min_x", grid.origin.x());
  writer.SetAttribute("background_min_y", grid.origin.y());
  writer.SetAttribute("background_cell_m", grid.cell_m);
  writer.Put(kHeights, background.surface.heights(), {grid.rows, grid.columns});
  writer.Put(kColors, background.rgb_srgb, {grid.rows, grid.columns, 3});
  if (!background.photos.empty()) writer.Put(kPhotos, background.photos, {grid.rows, grid.columns});
}

Background GetBackground(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file) {
  Background background;
  for (size_t c = 0; c < 3; ++c) {
    if (reader.HasAttribute(kMean[c])) background.mean_srgb[c] = static_cast<float>(reader.DoubleAttribute(kMean[c]));
  }
  const std::string fix = "Train it again with --restart";
  if (reader.Has(kSky)) {
    if (reader.Shape(kSky) != std::vector<int64_t>{Background::kSkyRows, Background::kSkyColumns, 3}) {
      throw base::InputError(file, "the background's sky has another size", fix);
    }
    background.sky_srgb = reader.Floats(kSky);
  }
  if (!reader.Has(kHeights)) return background;
  const std::vector<int64_t> shape = reader.Shape(kHeights);
  if (shape.size() != 2 || reader.Shape(kColors) != std::vector<int64_t>{shape[0], shape[1], 3}) {
    throw base::InputError(file, "heights and colours of the background have different sizes", fix);
  }
  try {
    const Eigen::Vector2d corner(reader.DoubleAttribute("background_min_x"), reader.DoubleAttribute("background_min_y"));
    const geo::PlaneGrid grid(corner, reader.DoubleAttribute("background_cell_m"), static_cast<int>(shape[1]), static_cast<int>(shape[0]));
    background.surface = HeightMap(grid, reader.Doubles(kHeights));
  } catch (const std::invalid_argument& error) {
    throw base::InputError(file, std::string("its background is damaged: ") + error.what(), fix);
  }
  background.rgb_srgb = reader.Floats(kColors);
  if (reader.Has(kPhotos)) {
    if (reader.Shape(kPhotos) != shape) throw base::InputError(file, "the background's numbers of photos have another size", fix);
    background.photos = reader.Bytes(kPhotos);
  }
  return background;
}

}  // namespace skyquilt::scene
