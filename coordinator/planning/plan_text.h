// A plan and its outcome as text for people and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "coordinator/planning/needs.h"
#include "coordinator/planning/plan.h"
#include "evaluate/metrics/run_times.h"

namespace skyquilt::coordinator {

// Lines: the total, a line per stage with its time, a line per thing that is given up.
std::string PlanText(const Plan& plan);
// One line: "memory 1.2 GB of 12 GB, disk 3.4 GB of 80 GB".
std::string NeedsText(const Needs& needs, const Room& room);

nlohmann::ordered_json PlanJson(const Plan& plan);
nlohmann::ordered_json NeedsJson(const Needs& needs, const Room& room);
// Content of plan.json: what was planned, what is planned now, and what was taken.
std::string TimesJson(const evaluate::metrics::RunTimes& times);

// Totals for which a survey is worth asking: the least at which nothing has to be given up, rounded up to a usual duration, a third and three times
// as much. `whole`: the plan for a total. Ascending.
std::vector<double> UsualTotals(const std::function<Plan(double within_s)>& whole);

}  // namespace skyquilt::coordinator
