#include "evaluate/buildings/detection.h"

#include <array>
#include <limits>

#include "evaluate/buildings/shared_areas.h"
#include "evaluate/measured.h"

namespace skyquilt::evaluate::buildings {
namespace {

struct SizeClass {
  const char* name;
  double from_m2, to_m2;  // the first belongs to it, the second does not

  bool Has(double area_m2) const { return area_m2 >= from_m2 && area_m2 < to_m2; }
};
constexpr double kAnySize = std::numeric_limits<double>::infinity();
// Invented buildings may be smaller than outlines that count.
constexpr std::array<SizeClass, 3> kSizes = {{{"all", 0.0, kAnySize}, {"10 to 50 m2", 0.0, 50.0}, {"over 50 m2", 50.0, kAnySize}}};

double ShareOf(double part, double whole) {
  return whole > 0.0 ? part / whole : kNotMeasured;
}

// Areas of one outline or found building that counts.
struct CountedArea {
  double size_m2 = 0.0;  // decides on its class
  double area_m2 = 0.0;
  double shared_m2 = 0.0;  // with the other side
};

std::vector<CountedArea> TrueAreas(const TrueBuildings& truth, const BuildingMatches& matches, const std::vector<Polygon>& footprints) {
  std::vector<CountedArea> areas;
  for (size_t t = 0; t < truth.outlines.size(); ++t) {
    if (matches.truth[t] == TrueFate::kNotCounted) continue;
    const TrueBuilding& outline = truth.outlines[t];
    areas.push_back({outline.area_m2, outline.area_m2, CoveredArea(outline.walls, footprints)});
  }
  return areas;
}

std::vector<CountedArea> FoundAreas(const TrueBuildings& truth, const BuildingMatches& matches, const std::vector<Polygon>& footprints) {
  std::vector<Polygon> counted, taken;
  for (size_t t = 0; t < truth.outlines.size(); ++t) {
    (matches.truth[t] == TrueFate::kNotCounted ? taken : counted).push_back(truth.outlines[t].walls);
  }
  std::vector<CountedArea> areas;
  for (size_t f = 0; f < footprints.size(); ++f) {
    const std::optional<size_t> pair = matches.pair_of_found[f];
    CountedArea one;
    one.size_m2 = pair ? truth.outlines[matches.pairs[*pair].truth].area_m2 : Area(footprints[f]);
    for (const Polygon& rest : Without(footprints[f], taken)) {
      const std::vector<Polygon> pieces = truth.area ? Intersection(rest, *truth.area) : std::vector<Polygon>{rest};
      for (const Polygon& piece : pieces) {
        one.area_m2 += Area(piece);
        one.shared_m2 += CoveredArea(piece, counted);
      }
    }
    areas.push_back(one);
    taken.push_back(footprints[f]);  // where buildings overlap, the area counts once
  }
  return areas;
}

void CountObjects(const SizeClass& size, const BuildingSet& found, const TrueBuildings& truth, const BuildingMatches& matches,
                  BuildingDetection* score) {
  for (size_t t = 0; t < truth.outlines.size(); ++t) {
    if (matches.truth[t] == TrueFate::kNotCounted || !size.Has(truth.outlines[t].area_m2)) continue;
    ++score->outlines;
    ++(matches.truth[t] == TrueFate::kMatched ? score->matched : score->missed);
  }
  for (size_t f = 0; f < found.buildings.size(); ++f) {
    if (matches.found[f] == FoundFate::kInvented && size.Has(Area(found.buildings[f].footprint))) ++score->invented;
  }
  const auto matched = static_cast<double>(score->matched), missed = static_cast<double>(score->missed),
             invented = static_cast<double>(score->invented);
  score->completeness = ShareOf(matched, matched + missed);
  score->correctness = ShareOf(matched, matched + invented);
  score->quality = ShareOf(matched, matched + missed + invented);
}

void CompareAreas(const SizeClass& size, const std::vector<CountedArea>& truth, const std::vector<CountedArea>& found, BuildingDetection* score) {
  double true_m2 = 0.0, true_shared_m2 = 0.0, found_m2 = 0.0, found_shared_m2 = 0.0;
  for (const CountedArea& one : truth) {
    if (!size.Has(one.size_m2)) continue;
    true_m2 += one.area_m2;
    true_shared_m2 += one.shared_m2;
  }
  for (const CountedArea& one : found) {
    if (!size.Has(one.size_m2)) continue;
    found_m2 += one.area_m2;
    found_shared_m2 += one.shared_m2;
  }
  score->completeness_area = ShareOf(true_shared_m2, true_m2);
  score->correctness_area = ShareOf(found_shared_m2, found_m2);
  // Intersection over union when all sizes are taken.
  score->quality_area = ShareOf(true_shared_m2, true_m2 + found_m2 - found_shared_m2);
}

}  // namespace

std::vector<BuildingDetection> ScoreDetection(const BuildingSet& found, const TrueBuildings& truth, const BuildingMatches& matches) {
  std::vector<Polygon> footprints;
  for (const Building& building : found.buildings) footprints.push_back(building.footprint);
  const std::vector<CountedArea> true_areas = TrueAreas(truth, matches, footprints), found_areas = FoundAreas(truth, matches, footprints);
  std::vector<BuildingDetection> scores;
  for (const SizeClass& size : kSizes) {
    BuildingDetection& score = scores.emplace_back();
    score.size = size.name;
    CountObjects(size, found, truth, matches, &score);
    CompareAreas(size, true_areas, found_areas, &score);
  }
  return scores;
}

}  // namespace skyquilt::evaluate::buildings
