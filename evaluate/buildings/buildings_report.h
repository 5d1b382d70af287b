// What the report shows of the buildings, beside their scores.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluate/buildings/buildings_pictures.h"
#include "evaluate/buildings/buildings_scorer.h"
#include "evaluate/evaluate_input.h"

namespace skyquilt::evaluate::buildings {

inline constexpr size_t kBuildingCards = 60;  // largest buildings that have a card

struct BuildingsReport {
  ComparedBuildings compared;
  std::vector<BuildingPicture> pictures;  // one per building, or none at all
  // What is added to the heights of each building, which are of ENU, to get map heights; empty: nothing.
  std::vector<double> map_height_m;
  std::string vertical;            // what map heights are above
  std::vector<std::string> files;  // in the project's folder buildings/
};

// Everything but the pictures, which are written later; nothing when no buildings were searched. Throws base::InputError.
std::optional<BuildingsReport> CollectBuildings(const EvaluateInput& input);
// Indices of the buildings that have a card, the largest first.
std::vector<size_t> BuildingsWithCards(const BuildingSet& set);

}  // namespace skyquilt::evaluate::buildings
