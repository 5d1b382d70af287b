// Paints one tile of a map from photos (photo_map.h).
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/image/image.h"
#include "products/photo_map/map_nodes.h"

namespace skyquilt::products {

class TilePainter {
 public:
  // References are kept. eyes_map: EyesOnMap. Paints `core` and what is around it as far as blending reaches.
  TilePainter(const PhotoMapInput& input, const MapNodes& nodes, const PhotoLight& light, const std::vector<Eigen::Vector3d>& eyes_map,
              survey::PhotoPictures& pictures, const TileArea& core);
  // Writes the core's cells; row_cells: cells from one row to the next in both.
  void Paint(uint8_t* rgba, uint16_t* sources, size_t row_cells);

 private:
  static constexpr int32_t kNobody = -1, kField = -2;  // in shows_, beside photos

  // Whether the photo sees the surface cell: 0 not asked yet.
  enum Sight : uint8_t { kUnknown = 0, kHidden, kSeen };
  // A photo that is used in this tile.
  struct Used {
    std::shared_ptr<const survey::PhotoPicture> picture;  // null: cannot be read
    std::vector<uint8_t> sight;                           // per cell of the surface around the tile
  };
  Used& UsedPhoto(int32_t photo);
  bool SeesCell(int32_t photo, Used& used, int surface_column, int surface_row);
  // with_rim: also all neighbours of the surface cell, so that nothing bleeds over an edge.
  bool Sees(int32_t photo, Used& used, size_t cell, bool with_rim);
  // The photo's colour of the cell, in the map's light. False when it does not show it.
  bool ColorOf(int32_t photo, const Used& used, size_t cell, float* rgb) const;
  bool FieldColorOf(size_t cell, float* rgb) const;
  void ChooseCells();
  void FillGaps();
  void Blend();
  size_t Index(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(area_.columns) + static_cast<size_t>(x); }

  const PhotoMapInput& input_;
  const MapNodes& nodes_;
  const PhotoLight& light_;
  const std::vector<Eigen::Vector3d>& eyes_map_;
  survey::PhotoPictures& pictures_;
  TileArea core_, area_;
  CellPlaces places_;
  TileArea sight_;  // cells of the surface
  std::vector<float> height_m_;
  std::vector<int32_t> shows_;  // per cell: photo, kField or kNobody
  image::ImageF picture_;       // colours of the cells
  std::vector<std::pair<int32_t, std::unique_ptr<Used>>> used_;
};

}  // namespace skyquilt::products
