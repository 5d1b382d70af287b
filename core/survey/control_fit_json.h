// The control points' part of survey.json. Numbers that are NaN are stored as null.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/survey/control_fit.h"

namespace skyquilt::survey {

nlohmann::ordered_json ToJson(const ControlFit& fit);

// Throws nlohmann::json::exception for missing keys and wrong types, std::invalid_argument for vectors of a wrong length, an unknown use, two points
// of one label, and a horizontal place or a marked pixel that is unknown.
ControlFit ControlFitFromJson(const nlohmann::json& value);

}  // namespace skyquilt::survey
