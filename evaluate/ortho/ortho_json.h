// Scores of the orthophoto in JSON, as in metrics.json.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "evaluate/ortho/ortho_scores.h"

namespace skyquilt::evaluate::ortho {

// NaN becomes null, and so do counts that are not known.
nlohmann::ordered_json ToJson(const OrthoScores& scores);
// Figures that are missing, null or of a wrong type are not measured.
OrthoScores OrthoScoresFromJson(const nlohmann::ordered_json& json);

}  // namespace skyquilt::evaluate::ortho
