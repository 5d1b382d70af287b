// Ground control in metrics.json.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/survey/control_fit.h"

namespace skyquilt::evaluate::control {

// An object: file, crs, heights, placed, adjusted, the groups control, left_out and check (control_summary.h), rejected, unseen, within_rule,
// statement, and the points. NaN becomes null; null without points.
nlohmann::ordered_json ControlJson(const survey::ControlFit& fit);

}  // namespace skyquilt::evaluate::control
