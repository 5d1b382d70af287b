// Paints a map from the photos of a survey on a known surface: each cell from one photo that sees it, seams where photos agree, coarse differences
// blended across them (Burt and Adelson 1983), one light, and nothing that moved. Cells that no photo sees have the field's colour.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "products/photo_map/map_nodes.h"

namespace skyquilt::products {

// Cells of consecutive rows.
struct PhotoMapRows {
  std::vector<uint8_t> rgba;      // display values; alpha 0 where there is no surface or neither photo nor field, otherwise 255
  std::vector<uint16_t> sources;  // see below
};
constexpr uint16_t kNoSource = 0, kFromField = 1, kFirstPhotoSource = 2;  // the value of photo i is kFirstPhotoSource + i
constexpr size_t kMostMapPhotos = 65000;

class PhotoMap {
 public:
  // Measures the photos' light and chooses which photo shows what. Keeps a copy of the input, and so references to what it refers to. Throws
  // base::Interrupted.
  PhotoMap(const PhotoMapInput& input, base::ThreadPool& threads);
  // With what another PhotoMap of the same input has found.
  PhotoMap(const PhotoMapInput& input, PhotoLight light, MapNodes nodes);

  const MapNodes& nodes() const { return nodes_; }
  const PhotoLight& light() const { return light_; }
  // Why photos could not be read: messages.
  const std::vector<std::string>& failures() const { return failures_; }

  // Rows to be asked for together: what a row of tiles has.
  static constexpr int kRows = 1024;
  // Paints rows first_row .. first_row + n_rows, at most kRows of them, n tiles at a time for n threads. The same bytes for any number of threads.
  // Memory: pictures as the input says, and about 90 MB per thread. Throws base::Interrupted.
  void PaintRows(int first_row, int n_rows, base::ThreadPool& threads, PhotoMapRows* rows);
  // The tiles that PaintRows paints, from west to east; they may also be painted one by one, several at the same time.
  static std::vector<TileArea> TilesOf(const gis::MapGrid& grid, int first_row, int n_rows);
  // `cells`: those of the tile alone.
  void PaintTile(const TileArea& tile, PhotoMapRows* cells);

 private:
  // row_cells: cells from one row to the next in both.
  void Paint(const TileArea& tile, uint8_t* rgba, uint16_t* sources, size_t row_cells);

  PhotoMapInput input_;
  PhotoLight light_;
  MapNodes nodes_;
  std::vector<std::string> failures_;
  survey::PhotoPictures pictures_;  // at the map's detail
  std::vector<Eigen::Vector3d> eyes_map_;
};

}  // namespace skyquilt::products
