#include "evaluate/buildings/match_buildings.h"

#include <algorithm>

#include "evaluate/buildings/shared_areas.h"

namespace skyquilt::evaluate::buildings {
namespace {

bool IsCounted(const TrueBuilding& outline) {
  return outline.inside && outline.area_m2 >= kSmallestCounted_m2;
}

// The outline that the footprint overlaps most; nothing when it overlaps none.
std::optional<size_t> MostOverlapped(const Polygon& footprint, const std::vector<Polygon>& outlines) {
  std::optional<size_t> most;
  double largest_m2 = 0.0;
  for (size_t i = 0; i < outlines.size(); ++i) {
    const double shared_m2 = SharedArea(footprint, outlines[i]);
    if (shared_m2 <= largest_m2) continue;
    largest_m2 = shared_m2;
    most = i;
  }
  return most;
}

}  // namespace

std::vector<BuildingPair> MatchFootprints(std::span<const Polygon> found, std::span<const Polygon> truth) {
  std::vector<BuildingPair> candidates;
  for (size_t f = 0; f < found.size(); ++f) {
    const double found_m2 = Area(found[f]);
    for (size_t t = 0; t < truth.size(); ++t) {
      const double shared_m2 = SharedArea(found[f], truth[t]);
      if (!(shared_m2 > 0.0)) continue;
      const double either_m2 = found_m2 + Area(truth[t]) - shared_m2;
      if (shared_m2 >= kMatchingOverlap * either_m2) candidates.push_back({f, t, shared_m2 / either_m2});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const BuildingPair& a, const BuildingPair& b) { return a.overlap > b.overlap; });
  std::vector<bool> found_taken(found.size()), truth_taken(truth.size());
  std::vector<BuildingPair> pairs;
  for (const BuildingPair& pair : candidates) {
    if (found_taken[pair.found] || truth_taken[pair.truth]) continue;
    found_taken[pair.found] = truth_taken[pair.truth] = true;
    pairs.push_back(pair);
  }
  return pairs;
}

BuildingMatches MatchBuildings(const BuildingSet& found, const TrueBuildings& truth) {
  std::vector<Polygon> footprints, outlines;
  for (const Building& building : found.buildings) footprints.push_back(building.footprint);
  for (const TrueBuilding& building : truth.outlines) outlines.push_back(building.walls);

  BuildingMatches matches;
  matches.found.assign(footprints.size(), FoundFate::kInvented);
  matches.pair_of_found.resize(footprints.size());
  for (const TrueBuilding& outline : truth.outlines) matches.truth.push_back(IsCounted(outline) ? TrueFate::kMissed : TrueFate::kNotCounted);

  std::vector<bool> paired(footprints.size());
  for (const BuildingPair& pair : MatchFootprints(footprints, outlines)) {
    paired[pair.found] = true;
    if (matches.truth[pair.truth] == TrueFate::kNotCounted) {
      matches.found[pair.found] = FoundFate::kNotCounted;
    } else {
      matches.found[pair.found] = FoundFate::kMatched;
      matches.truth[pair.truth] = TrueFate::kMatched;
      matches.pairs.push_back(pair);
    }
  }
  std::sort(matches.pairs.begin(), matches.pairs.end(), [](const BuildingPair& a, const BuildingPair& b) { return a.found < b.found; });
  for (size_t i = 0; i < matches.pairs.size(); ++i) matches.pair_of_found[matches.pairs[i].found] = i;

  for (size_t f = 0; f < footprints.size(); ++f) {
    if (paired[f]) continue;
    const std::optional<size_t> most = MostOverlapped(footprints[f], outlines);
    const bool counted = most ? matches.truth[*most] != TrueFate::kNotCounted : !truth.area || Contains(*truth.area, Centroid(footprints[f]));
    if (!counted) matches.found[f] = FoundFate::kNotCounted;
  }
  return matches;
}

}  // namespace skyquilt::evaluate::buildings
