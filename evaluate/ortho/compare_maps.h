// Compares the orthophoto with the true map, tile by tile, so that maps of any size take little memory.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/metrics/psnr.h"
#include "evaluate/ortho/map_seams.h"
#include "evaluate/ortho/ortho_scores.h"
#include "evaluate/ortho/true_map.h"

namespace skyquilt::evaluate::ortho {

struct MapFiles {
  std::filesystem::path map, truth;
  std::filesystem::path sources;  // empty: seams are not looked for
};

// Cells [left, right) x [top, bottom) of the orthophoto.
struct CellArea {
  int left = 0, top = 0, right = 0, bottom = 0;
  bool Empty() const { return left >= right || top >= bottom; }
};

// One reader of each file; each thread needs its own.
struct OpenMaps {
  gis::MapReader map;
  TrueMap truth;
  std::optional<gis::MapReader> sources;
  explicit OpenMaps(const MapFiles& files);
};
std::vector<OpenMaps> OpenForThreads(const MapFiles& files, const base::ThreadPool& threads);

// How far the map lies east and north of the truth, metres: from the brightness in at most 16 places spread over the area. Zero when nothing fits
// better than no shift.
Eigen::Vector2d MeasureShift(const std::vector<OpenMaps>& maps, const CellArea& area, base::ThreadPool& threads);

constexpr int kLightCells = 16;

struct MapComparison {
  skyquilt::metrics::SquaredError error;
  double ssim_sum = 0.0;
  int64_t ssim_cells = 0;
  SeamSums seams;
  // Root mean square over squares of kLightCells cells of log2 of the map's linear light over the truth's, without the median: how unevenly the map
  // is lit. Squares that both maps know all of; NaN without any.
  double light_error_stops = kNotMeasured;
  std::vector<OrthoCrop> crops;  // where they differ most, more than nine tenths of the map do, and as usual
};
// The same result for any number of threads. heights may be null. Throws base::Interrupted.
MapComparison CompareMaps(const std::vector<OpenMaps>& maps, const CellArea& area, const Eigen::Vector2d& shift_m, const HeightMap* heights,
                          base::ThreadPool& threads);

}  // namespace skyquilt::evaluate::ortho
