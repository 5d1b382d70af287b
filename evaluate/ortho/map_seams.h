// How much the error of a map changes where one photo ends and the next begins.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>

#include "evaluate/ortho/height_map.h"
#include "evaluate/ortho/true_map.h"

namespace skyquilt::evaluate::ortho {

// Cells around a border that are looked at.
constexpr int kSeamReach = 4;

// A window of the map, the truth and the values of ortho_sources.tif, with kSeamReach or more cells on each side of what belongs to it.
struct SeamWindow {
  const MapPart& map;
  const MapPart& truth;
  const image::ImageF& sources;  // one channel; NaN: none
  gis::MapGrid grid;             // of the window
  int border = kSeamReach;       // cells on each side that belong to other windows
};

// Sums over the cells along the border of two photos, the smaller value first: map minus truth on the first one's side less that on the other's.
struct SeamSum {
  std::array<double, 3> step{};
  int64_t n = 0;
};
using SeamSums = std::map<std::pair<int, int>, SeamSum>;

// Counts cells where the truth is flat: little contrast within three cells and, where heights are known, no step.
void AddSeams(const SeamWindow& window, const HeightMap* heights, SeamSums* sums);
void AddSeams(const SeamSums& others, SeamSums* sums);

// Over the pairs with at least 32 cells, in levels of 255: the size of the mean step, mean over the three colours.
struct SeamLevels {
  int64_t pairs = 0;
  double mean = 0.0, worst = 0.0;  // NaN without pairs
};
SeamLevels LevelsOf(const SeamSums& sums);

}  // namespace skyquilt::evaluate::ortho
