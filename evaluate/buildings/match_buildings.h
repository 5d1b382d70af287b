// Which found building is which true one, and what is missed and invented.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "buildings/building.h"
#include "evaluate/buildings/true_buildings.h"

namespace skyquilt::evaluate::buildings {

inline constexpr double kMatchingOverlap = 0.5;      // least intersection over union of the footprints of a pair
inline constexpr double kSmallestCounted_m2 = 10.0;  // smaller outlines count neither as missed nor as found

struct BuildingPair {
  size_t found = 0, truth = 0;  // indices
  double overlap = 0.0;         // intersection over union
};

// One to one, the largest overlap first; equal overlaps in the order of the indices.
std::vector<BuildingPair> MatchFootprints(std::span<const Polygon> found, std::span<const Polygon> truth);

// A found building is not counted when it matches, or overlaps most, an outline that is not counted, or when it overlaps none and its middle is
// outside the surveyed area. Outlines that are not wholly inside that area, or very small, are not counted.
enum class FoundFate : uint8_t { kMatched, kInvented, kNotCounted };
enum class TrueFate : uint8_t { kMatched, kMissed, kNotCounted };

struct BuildingMatches {
  std::vector<BuildingPair> pairs;                   // of outlines that count, in the order of the found buildings
  std::vector<FoundFate> found;                      // one per found building
  std::vector<TrueFate> truth;                       // one per outline
  std::vector<std::optional<size_t>> pair_of_found;  // index into pairs
};

BuildingMatches MatchBuildings(const BuildingSet& found, const TrueBuildings& truth);

}  // namespace skyquilt::evaluate::buildings
