#include "products/map_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/progress.h"
#include "core/gis/geotiff.h"
#include "products/map_rays.h"

namespace skyquilt::products {
namespace {

constexpr float kMostStep_cells = 2.0F;

// The cells between which others are filled: every second one, and the last, so that each other cell has neighbours on both sides.
bool OnLattice(int index, int count) {
  return index % 2 == 0 || index == count - 1;
}

// The lattice cells on both sides of an index, or itself twice.
std::pair<int, int> LatticeAround(int index, int count) {
  return OnLattice(index, count) ? std::pair{index, index} : std::pair{index - 1, index + 1};
}

class BandRenderer {
 public:
  BandRenderer(const scene::SceneInfo& info, const gis::MapGrid& grid, const MapCasting& casting, const std::optional<gis::Boundary>& boundary)
      : grid_(grid),
        boundary_(boundary),
        every_second_(casting.every_second),
        rays_(info, grid),
        painter_(casting.caster, casting.min_opacity, casting.rays_per_call) {}

  void Render(int first_row, int n_rows, PaintedCells* band) {
    for (int row = 0; row < n_rows; ++row) {
      if (every_second_ && !OnLattice(row, n_rows)) continue;
      rays_.MakeRow(first_row + row, &row_);
      for (size_t i = 0; i < row_.rays.size(); ++i) {
        if (every_second_ && !OnLattice(row_.column[i], grid_.width)) continue;
        if (IsInside(i, first_row + row)) Cast(i, row, band);
      }
    }
    painter_.Finish(band);
    if (every_second_) RenderBetween(first_row, n_rows, band);
  }

  RenderedCells counts() const {
    RenderedCells counts = counts_;
    counts.filled += painter_.painted();
    return counts;
  }

 private:
  bool IsInside(size_t i, int row) {
    if (boundary_ && !boundary_->Contains(grid_.CellCentre(row_.column[i], row))) return false;
    ++counts_.inside;
    return true;
  }
  void Cast(size_t i, int row, PaintedCells* band) {
    ++counts_.rays;
    painter_.Add(row_.rays[i], grid_.Index(row_.column[i], row), row_.start_height_m[i], band);
  }

  // The cells that are not on the lattice. A cell gets a ray or its final value here, and only lattice cells are read, so that the order of calls of
  // the caster changes nothing.
  void RenderBetween(int first_row, int n_rows, PaintedCells* band) {
    for (int row = 0; row < n_rows; ++row) {
      const auto [above, below] = LatticeAround(row, n_rows);
      rays_.MakeRow(first_row + row, &row_);
      for (size_t i = 0; i < row_.rays.size(); ++i) {
        const int column = row_.column[i];
        const auto [left, right] = LatticeAround(column, grid_.width);
        if ((above == below && left == right) || !IsInside(i, first_row + row)) continue;
        const std::array<size_t, 4> around{grid_.Index(left, above), grid_.Index(right, above), grid_.Index(left, below), grid_.Index(right, below)};
        if (!FillBetween(around, grid_.Index(column, row), band)) Cast(i, row, band);
      }
    }
    painter_.Finish(band);
  }

  bool FillBetween(const std::array<size_t, 4>& around, size_t cell, PaintedCells* band) {
    float lowest = std::numeric_limits<float>::infinity();
    float highest = -lowest;
    float sum = 0.0F;
    std::array<int, 3> rgb{};
    for (const size_t at : around) {
      if (band->rgba[4 * at + 3] == 0 || band->place[at] == kNoHeight) return false;
      lowest = std::min(lowest, band->place[at]);
      highest = std::max(highest, band->place[at]);
      sum += band->place[at];
      for (size_t c = 0; c < 3; ++c) rgb[c] += band->rgba[4 * at + c];
    }
    if (highest - lowest > kMostStep_cells * static_cast<float>(grid_.resolution_m)) return false;
    band->place[cell] = 0.25F * sum;
    for (size_t c = 0; c < 3; ++c) band->rgba[4 * cell + c] = static_cast<uint8_t>((rgb[c] + 2) / 4);
    band->rgba[4 * cell + 3] = 255;
    ++counts_.filled;
    return true;
  }

  const gis::MapGrid& grid_;
  const std::optional<gis::Boundary>& boundary_;
  bool every_second_;
  MapRayGenerator rays_;
  CellPainter painter_;
  MapRays row_;
  RenderedCells counts_;
};

}  // namespace

RenderedCells RenderMapCells(const scene::SceneInfo& info, const gis::MapGrid& grid, const MapCasting& casting,
                             const std::optional<gis::Boundary>& boundary, const char* what, const MapRowSink& sink) {
  base::Progress progress(what, static_cast<double>(grid.width) * grid.height, "cells");
  BandRenderer renderer(info, grid, casting, boundary);
  PaintedCells band;
  for (int first_row = 0; first_row < grid.height; first_row += gis::GeoTiffWriter::kTile) {
    base::ThrowIfCancelled();
    const int n_rows = std::min(gis::GeoTiffWriter::kTile, grid.height - first_row);
    const size_t cells = grid.Index(0, n_rows);
    band.rgba.assign(4 * cells, 0);
    band.place.assign(cells, kNoHeight);
    renderer.Render(first_row, n_rows, &band);
    sink(first_row, n_rows, band);
    progress.Update(static_cast<double>(first_row + n_rows) * grid.width);
  }
  progress.Finish();
  return renderer.counts();
}

}  // namespace skyquilt::products
