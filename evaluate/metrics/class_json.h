// Scores by class of surface in JSON, as in metrics.json and in the results of benches.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "evaluate/metrics/metrics.h"

namespace skyquilt::evaluate::metrics {

// An object with one member per class, in the given order: {"roof": {"pixels": 1200, "depth_nmad_m": 0.08, ...}, ...}. NaN becomes null.
nlohmann::ordered_json ToJson(std::span<const ClassScore> scores);
// Figures that are missing or null are NaN, missing counts 0. Nothing for null. Throws nlohmann::json::exception for wrong types.
std::vector<ClassScore> ClassScoresFromJson(const nlohmann::ordered_json& classes);

}  // namespace skyquilt::evaluate::metrics
