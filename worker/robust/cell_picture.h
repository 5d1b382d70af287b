// A photo in square cells of several pixels, at reference exposure, so that photos can be compared place by place.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/brightness/response.h"
#include "core/image/pixel_cache.h"
#include "worker/rays/ray_source.h"

namespace skyquilt::worker {

struct CellPicture {
  // A cell's mean display value at reference exposure, of each colour, in units of 1 / kUnits.
  static constexpr float kUnits = 160.0F;
  struct Cell {
    std::array<uint8_t, 3> rgb{};
    uint8_t usable = 0;  // 0: a pixel is masked; 1: as recorded; 2: too bright for the photo, so that it was at least this bright
  };

  // Of a cell and those around it.
  struct Range {
    std::array<uint8_t, 3> low{255, 255, 255}, high{0, 0, 0};
    bool usable = true;  // all of them are, as recorded

    // By how much a colour is outside, in units of 1 / kUnits: the largest over the channels.
    int Outside(const std::array<uint8_t, 3>& rgb) const;
  };

  int columns = 0, rows = 0;
  std::vector<Cell> cells;  // row by row

  // Of the cells at most one away from this one, inside the photo.
  Range RangeAround(int column, int row) const;
  const Cell& At(int column, int row) const { return cells[static_cast<size_t>(row) * static_cast<size_t>(columns) + static_cast<size_t>(column)]; }
};

// source: of the same photos and response. cell_px: side of a cell in pixels of the cached photo.
CellPicture MakeCellPicture(const RaySource& source, const image::PixelCache& pixels, const brightness::Response& response, int photo, int cell_px);

}  // namespace skyquilt::worker
