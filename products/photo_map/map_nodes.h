// Plans a map that is painted from photos: which photo shows which part of the ground best.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/brightness/unshade.h"
#include "core/gis/map_projection.h"
#include "core/survey/photo_pictures.h"
#include "core/survey/survey.h"
#include "products/photo_map/height_grid.h"
#include "products/photo_map/photo_light.h"

namespace skyquilt::products {

// References must outlive what is made from it.
struct PhotoMapInput {
  const survey::Survey& survey;
  std::span<const char> usable;  // per photo: 1 if it may be shown
  const gis::MapGrid& grid;      // of the map
  const gis::MapProjection& projection;
  const HeightGrid& surface;               // heights as of MapProjection
  std::span<const float> slack_m;          // SightSlack of the surface
  std::span<const uint8_t> field_rgba;     // the field's colours on the surface's grid, display values; empty: not known
  double ground_z = 0.0;                   // ENU, of most of the ground
  double flown_height_m = 0.0;             // of most photos, above the ground
  size_t picture_bytes = size_t{1} << 30;  // of photos kept in memory
  brightness::PhotoShading shading = {};   // is taken out of the photos
};

// A part of a map or of a surface, in cells.
struct TileArea {
  int column = 0, row = 0, columns = 0, rows = 0;

  size_t size() const { return static_cast<size_t>(columns) * static_cast<size_t>(rows); }
};

// A node stands for kNodeCells x kNodeCells cells of the map, which it is in the middle of.
constexpr int kNodeCells = 8;
constexpr size_t kKeptChoices = 4;

struct MapNodes {
  int columns = 0, rows = 0;
  std::vector<std::array<int32_t, kKeptChoices>> photos;  // the one that is to show the node, then others that see it, the best first; -1: none
  std::vector<uint8_t> seen;                              // number of photos with it in their frame, hidden or not, kMostSeen at most

  static MapNodes Of(const gis::MapGrid& map);  // no photo shows any of them
  size_t Index(int column, int row) const { return static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column); }
  gis::MapGrid GridOf(const gis::MapGrid& map) const;  // with the nodes as cells
};
constexpr int kMostSeen = 8;
// The middle of a node in cells of the map, whole numbers at centres of cells.
Eigen::Vector2d NodeCell(int column, int row);

// Places of the cells of a part of a map on Earth. The part must be smaller than a few kilometres: lines down are linear between its corners.
class CellPlaces {
 public:
  CellPlaces(const gis::MapGrid& grid, const gis::MapProjection& projection, int column, int row, int columns, int rows);
  // ENU place of a position in cells of the grid (whole numbers at centres) at a height of the map.
  Eigen::Vector3d At(double column, double row, double height_m) const;

 private:
  double column_, row_, width_, height_, start_height_m_;
  std::array<gis::MapProjection::VerticalLine, 4> corners_;
};

// Cameras in map space (easting, northing, height), as HeightGrid::IsVisible wants them.
std::vector<Eigen::Vector3d> EyesOnMap(const survey::Survey& survey, const gis::MapProjection& projection);

// Photos whose colours are far from what the others and the field show of a place are not chosen there: something moved. Progress is shown; the same
// result for any number of threads. Throws base::Interrupted.
MapNodes ChoosePhotosOfNodes(const PhotoMapInput& input, const PhotoLight& light, survey::PhotoPictures& small, base::ThreadPool& threads);

}  // namespace skyquilt::products
