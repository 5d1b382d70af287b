#include "core/scene/background.h"

#include <stdexcept>

#include "core/base/errors.h"

namespace skyquilt::scene {
namespace {

constexpr const char* kMean[3] = {"background_r", "background_g", "background_b"};
constexpr const char* kHeights = "background/heights";
constexpr const char* kColors = "background/colors";

}  // namespace

std::array<float, 3> Background::Color(const Eigen::Vector3d& origin_enu, const Eigen::Vector3d& direction_enu) const {
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
  if (background.surface.Empty()) return;
  const geo::PlaneGrid& grid = background.surface.grid();
  writer.SetAttribute("background_min_x", grid.origin.x());
  writer.SetAttribute("background_min_y", grid.origin.y());
  writer.SetAttribute("background_cell_m", grid.cell_m);
  writer.Put(kHeights, background.surface.heights(), {grid.rows, grid.columns});
  writer.Put(kColors, background.rgb_srgb, {grid.rows, grid.columns, 3});
}

Background GetBackground(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file) {
  Background background;
  for (size_t c = 0; c < 3; ++c) {
    if (reader.HasAttribute(kMean[c])) background.mean_srgb[c] = static_cast<float>(reader.DoubleAttribute(kMean[c]));
  }
  if (!reader.Has(kHeights)) return background;
  const std::string fix = "Train it again with --restart";
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
  return background;
}

}  // namespace skyquilt::scene
