// Scores of buildings in JSON, as in metrics.json.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "evaluate/buildings/building_scores.h"

namespace skyquilt::evaluate::buildings {

// NaN and infinity become null.
nlohmann::ordered_json ToJson(const BuildingScores& scores);
// Figures that are missing, null or of a wrong type are not measured.
BuildingScores BuildingScoresFromJson(const nlohmann::ordered_json& json);

}  // namespace skyquilt::evaluate::buildings
