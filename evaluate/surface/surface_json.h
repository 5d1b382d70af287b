// Scores of the surface in JSON, as in metrics.json, and the table of what was made of it.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "evaluate/surface/surface_scores.h"

namespace skyquilt::evaluate::surface {

// NaN and infinity become null, and so do counts that are not known.
nlohmann::ordered_json ToJson(const SurfaceScores& scores);
// Figures that are missing, null or of a wrong type are not measured.
SurfaceScores SurfaceScoresFromJson(const nlohmann::ordered_json& json);
// Reads surface.json. A file that is missing or damaged gives an empty record, because it is only shown.
SurfaceRecord ReadSurfaceRecord(const std::filesystem::path& file);

}  // namespace skyquilt::evaluate::surface
