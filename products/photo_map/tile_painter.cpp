#include "products/photo_map/tile_painter.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/survey/picture_colors.h"
#include "products/photo_map/band_blend.h"
#include "products/photo_map/photo_map.h"

namespace skyquilt::products {
namespace {

constexpr int kLevels = 5;
constexpr int kAlign = 1 << kLevels;
constexpr int kReach = 2 * kAlign;  // cells over which coarse differences blend

TileArea Around(const TileArea& core, const gis::MapGrid& grid) {
  const int column = std::max(core.column - kReach, 0), row = std::max(core.row - kReach, 0);
  return {column, row, std::min(core.column + core.columns + kReach, grid.width) - column,
          std::min(core.row + core.rows + kReach, grid.height) - row};
}

// Cells of the surface under an area of the map, and one more on each side.
TileArea SurfaceUnder(const TileArea& area, const gis::MapGrid& map, const gis::MapGrid& surface) {
  const Eigen::Vector2d first = surface.CellOf(map.CellCentre(area.column, area.row));
  const Eigen::Vector2d last = surface.CellOf(map.CellCentre(area.column + area.columns, area.row + area.rows));
  const int column = std::clamp(static_cast<int>(std::floor(first.x())) - 2, 0, surface.width - 1);
  const int row = std::clamp(static_cast<int>(std::floor(first.y())) - 2, 0, surface.height - 1);
  return {column, row, std::clamp(static_cast<int>(std::ceil(last.x())) + 3, column + 1, surface.width) - column,
          std::clamp(static_cast<int>(std::ceil(last.y())) + 3, row + 1, surface.height) - row};
}

}  // namespace

TilePainter::TilePainter(const PhotoMapInput& input, const MapNodes& nodes, const PhotoLight& light, const std::vector<Eigen::Vector3d>& eyes_map,
                         survey::PhotoPictures& pictures, const TileArea& core)
    : input_(input),
      nodes_(nodes),
      light_(light),
      eyes_map_(eyes_map),
      pictures_(pictures),
      core_(core),
      area_(Around(core, input.grid)),
      places_(input.grid, input.projection, area_.column, area_.row, area_.columns, area_.rows),
      sight_(SurfaceUnder(area_, input.grid, input.surface.grid())),
      height_m_(static_cast<size_t>(area_.columns) * static_cast<size_t>(area_.rows)),
      shows_(height_m_.size(), kNobody),
      picture_(area_.columns, area_.rows, 3) {
  for (int y = 0; y < area_.rows; ++y) {
    for (int x = 0; x < area_.columns; ++x) {
      height_m_[Index(x, y)] = static_cast<float>(input_.surface.HeightAt(input_.grid.CellCentre(area_.column + x, area_.row + y)));
    }
  }
}

TilePainter::Used& TilePainter::UsedPhoto(int32_t photo) {
  for (auto& [number, used] : used_) {
    if (number == photo) return *used;
  }
  auto used = std::make_unique<Used>();
  used->picture = pictures_.Of(static_cast<size_t>(photo));
  used->sight.assign(static_cast<size_t>(sight_.columns) * static_cast<size_t>(sight_.rows), kUnknown);
  used_.emplace_back(photo, std::move(used));
  return *used_.back().second;
}

bool TilePainter::SeesCell(int32_t photo, Used& used, int surface_column, int surface_row) {
  const int x = surface_column - sight_.column, y = surface_row - sight_.row;
  if (x < 0 || y < 0 || x >= sight_.columns || y >= sight_.rows) return true;
  uint8_t& sight = used.sight[static_cast<size_t>(y) * static_cast<size_t>(sight_.columns) + static_cast<size_t>(x)];
  if (sight == kUnknown) {
    const float height_m = input_.surface.HeightOf(surface_column, surface_row);
    const Eigen::Vector2d position = input_.surface.grid().CellCentre(surface_column, surface_row);
    const auto slack_m = static_cast<double>(input_.slack_m[input_.surface.grid().Index(surface_column, surface_row)]);
    const bool seen = !std::isfinite(height_m) || input_.surface.IsVisible({position.x(), position.y(), static_cast<double>(height_m)},
                                                                           eyes_map_[static_cast<size_t>(photo)], slack_m);
    sight = seen ? kSeen : kHidden;
  }
  return sight == kSeen;
}

bool TilePainter::Sees(int32_t photo, Used& used, size_t cell, bool with_rim) {
  const auto columns = static_cast<size_t>(area_.columns);
  const Eigen::Vector2d at = input_.surface.grid().CellOf(
      input_.grid.CellCentre(area_.column + static_cast<int>(cell % columns), area_.row + static_cast<int>(cell / columns)));
  const int column = static_cast<int>(std::lround(at.x())), row = static_cast<int>(std::lround(at.y()));
  const int rim = with_rim ? 1 : 0;
  for (int y = row - rim; y <= row + rim; ++y) {
    for (int x = column - rim; x <= column + rim; ++x) {
      if (!SeesCell(photo, used, x, y)) return false;
    }
  }
  return true;
}

bool TilePainter::ColorOf(int32_t photo, const Used& used, size_t cell, float* rgb) const {
  if (!used.picture) return false;
  const survey::Photo& source = input_.survey.photos[static_cast<size_t>(photo)];
  const auto columns = static_cast<size_t>(area_.columns);
  const Eigen::Vector3d place = places_.At(area_.column + static_cast<double>(cell % columns), area_.row + static_cast<double>(cell / columns),
                                           static_cast<double>(height_m_[cell]));
  const std::optional<Eigen::Vector2d> pixel = survey::PixelIn(used.picture->camera, source.cam_from_enu, place);
  if (!pixel || survey::IsMasked(*used.picture, *pixel)) return false;
  const std::array<float, 3> factors =
      light_.At(static_cast<size_t>(photo), static_cast<size_t>(source.camera), survey::Radius2(used.picture->camera, *pixel));
  const std::array<float, 3> color = survey::InLight(LanczosAt(*used.picture, *pixel), factors);
  std::copy(color.begin(), color.end(), rgb);
  return true;
}

bool TilePainter::FieldColorOf(size_t cell, float* rgb) const {
  if (input_.field_rgba.empty()) return false;
  const gis::MapGrid& grid = input_.surface.grid();
  const auto columns = static_cast<size_t>(area_.columns);
  const Eigen::Vector2d at =
      grid.CellOf(input_.grid.CellCentre(area_.column + static_cast<int>(cell % columns), area_.row + static_cast<int>(cell / columns)));
  const int x0 = std::clamp(static_cast<int>(std::floor(at.x())), 0, grid.width - 1), x1 = std::min(x0 + 1, grid.width - 1);
  const int y0 = std::clamp(static_cast<int>(std::floor(at.y())), 0, grid.height - 1), y1 = std::min(y0 + 1, grid.height - 1);
  const auto u = static_cast<float>(std::clamp(at.x() - x0, 0.0, 1.0)), v = static_cast<float>(std::clamp(at.y() - y0, 0.0, 1.0));
  float weights = 0.0F;
  rgb[0] = rgb[1] = rgb[2] = 0.0F;
  for (const auto& [x, y, weight] : {std::tuple(x0, y0, (1.0F - u) * (1.0F - v)), std::tuple(x1, y0, u * (1.0F - v)),
                                     std::tuple(x0, y1, (1.0F - u) * v), std::tuple(x1, y1, u * v)}) {
    const uint8_t* rgba = input_.field_rgba.data() + 4 * grid.Index(x, y);
    if (rgba[3] == 0) continue;
    for (int k = 0; k < 3; ++k) rgb[k] += weight * static_cast<float>(rgba[k]) / 255.0F;
    weights += weight;
  }
  if (!(weights > 0.0F)) return false;
  for (int k = 0; k < 3; ++k) rgb[k] /= weights;
  return true;
}

void TilePainter::ChooseCells() {
  for (int y = 0; y < area_.rows; ++y) {
    for (int x = 0; x < area_.columns; ++x) {
      const size_t cell = Index(x, y);
      if (!std::isfinite(height_m_[cell])) continue;
      const auto& choices = nodes_.photos[nodes_.Index((area_.column + x) / kNodeCells, (area_.row + y) / kNodeCells)];
      float* rgb = picture_.At(x, y);
      for (const bool with_rim : {true, false}) {
        for (const int32_t photo : choices) {
          if (photo < 0 || shows_[cell] != kNobody) break;
          Used& used = UsedPhoto(photo);
          if (used.picture && Sees(photo, used, cell, with_rim) && ColorOf(photo, used, cell, rgb)) shows_[cell] = photo;
        }
      }
      if (shows_[cell] == kNobody && FieldColorOf(cell, rgb)) shows_[cell] = kField;
    }
  }
}

void TilePainter::FillGaps() {
  const auto copy = [&](int x, int y, int from_x, int from_y) { std::copy_n(picture_.At(from_x, from_y), 3, picture_.At(x, y)); };
  std::vector<char> empty_row(static_cast<size_t>(area_.rows), 0);
  for (int y = 0; y < area_.rows; ++y) {
    int before = -1;
    for (int x = 0; x < area_.columns; ++x) {
      if (shows_[Index(x, y)] == kNobody) continue;
      // The gap before this cell is divided between its two ends.
      for (int gap = before + 1; gap < x; ++gap) copy(gap, y, before >= 0 && gap - before < x - gap ? before : x, y);
      before = x;
    }
    if (before < 0) {
      empty_row[static_cast<size_t>(y)] = 1;
      continue;
    }
    for (int gap = before + 1; gap < area_.columns; ++gap) copy(gap, y, before, y);
  }
  int before = -1;
  for (int y = 0; y < area_.rows; ++y) {
    if (empty_row[static_cast<size_t>(y)] != 0) continue;
    for (int gap = before + 1; gap < y; ++gap) {
      for (int x = 0; x < area_.columns; ++x) copy(x, gap, x, before >= 0 && gap - before < y - gap ? before : y);
    }
    before = y;
  }
  if (before < 0) return;
  for (int gap = before + 1; gap < area_.rows; ++gap) {
    for (int x = 0; x < area_.columns; ++x) copy(x, gap, x, before);
  }
}

void TilePainter::Blend() {
  struct Extent {
    int32_t source;
    int x0, y0, x1, y1;
  };
  std::vector<Extent> extents;
  for (int y = 0; y < area_.rows; ++y) {
    for (int x = 0; x < area_.columns; ++x) {
      const int32_t source = shows_[Index(x, y)];
      if (source == kNobody) continue;
      auto found = std::find_if(extents.begin(), extents.end(), [&](const Extent& extent) { return extent.source == source; });
      if (found == extents.end()) found = extents.insert(extents.end(), {source, x, y, x, y});
      *found = {source, std::min(found->x0, x), found->y0, std::max(found->x1, x), y};
    }
  }
  if (extents.size() < 2) return;
  std::sort(extents.begin(), extents.end(), [](const Extent& a, const Extent& b) { return a.source < b.source; });
  BandBlender blender(area_.columns, area_.rows, kLevels);
  for (const Extent& extent : extents) {
    const int x0 = std::max(extent.x0 - kReach, 0) / kAlign * kAlign, y0 = std::max(extent.y0 - kReach, 0) / kAlign * kAlign;
    const int x1 = std::min(extent.x1 + 1 + kReach, area_.columns), y1 = std::min(extent.y1 + 1 + kReach, area_.rows);
    image::ImageF layer(x1 - x0, y1 - y0, 3);
    std::vector<float> mask(static_cast<size_t>(layer.width) * static_cast<size_t>(layer.height), 0.0F);
    Used* used = extent.source >= 0 ? &UsedPhoto(extent.source) : nullptr;
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) {
        const size_t cell = Index(x, y);
        float* rgb = layer.At(x - x0, y - y0);
        if (shows_[cell] == extent.source) {
          mask[static_cast<size_t>(y - y0) * static_cast<size_t>(layer.width) + static_cast<size_t>(x - x0)] = 1.0F;
        } else if (std::isfinite(height_m_[cell])) {
          const bool known = used ? Sees(extent.source, *used, cell, true) && ColorOf(extent.source, *used, cell, rgb) : FieldColorOf(cell, rgb);
          if (known) continue;
        }
        std::copy_n(picture_.At(x, y), 3, rgb);
      }
    }
    blender.Add(layer, mask, x0, y0);
  }
  picture_ = blender.Finish();
}

void TilePainter::Paint(uint8_t* rgba, uint16_t* sources, size_t row_cells) {
  ChooseCells();
  FillGaps();
  Blend();
  const int x0 = core_.column - area_.column, y0 = core_.row - area_.row;
  for (int y = 0; y < core_.rows; ++y) {
    for (int x = 0; x < core_.columns; ++x) {
      const int32_t source = shows_[Index(x0 + x, y0 + y)];
      const size_t cell = static_cast<size_t>(y) * row_cells + static_cast<size_t>(x);
      sources[cell] = source == kNobody ? kNoSource : source == kField ? kFromField : static_cast<uint16_t>(kFirstPhotoSource + source);
      for (size_t k = 0; k < 3; ++k) {
        const float value = source == kNobody ? 0.0F : std::clamp(picture_.At(x0 + x, y0 + y)[k], 0.0F, 1.0F);
        rgba[4 * cell + k] = static_cast<uint8_t>(std::lround(255.0F * value));
      }
      rgba[4 * cell + 3] = source == kNobody ? 0 : 255;
    }
  }
}

}  // namespace skyquilt::products
