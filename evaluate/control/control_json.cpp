#include "evaluate/control/control_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "evaluate/control/control_summary.h"

namespace skyquilt::evaluate::control {

namespace {

using Json = nlohmann::ordered_json;
using base::NumberOrNull;

Json Numbers(const Eigen::Vector3d& v) {
  return {NumberOrNull(v.x()), NumberOrNull(v.y()), NumberOrNull(v.z())};
}

Json ErrorsJson(const ControlErrors& errors) {
  if (errors.n == 0) return nullptr;
  return {{"points", errors.n},
          {"heights", errors.n_heights},
          {"mean_m", Numbers(errors.mean_m)},
          {"sigma_m", Numbers(errors.sigma_m)},
          {"rmse_m", Numbers(errors.rmse_m)},
          {"rmse_horizontal_m", NumberOrNull(errors.rmse_horizontal_m)},
          {"rmse_vertical_m", NumberOrNull(errors.rmse_vertical_m)},
          {"rmse_horizontal_gsd", NumberOrNull(errors.rmse_horizontal_gsd)},
          {"rmse_vertical_gsd", NumberOrNull(errors.rmse_vertical_gsd)},
          {"systematic", errors.Systematic()},
          {"systematic_beyond_chance", errors.SystematicBeyondChance()}};
}

Json PointJson(const survey::ControlPointFit& point) {
  const auto n_used = std::count_if(point.marks.begin(), point.marks.end(), [](const survey::ControlMarkFit& mark) { return mark.used; });
  return {{"label", point.label},
          {"use", survey::NameOf(point.use)},
          {"given_enu_m", Numbers(point.given_in_enu)},
          {"error_m", Numbers(point.error_m)},
          {"sigma_m", Numbers(point.sigma_m)},
          {"left_out_error_m", Numbers(point.left_out_error_m)},
          {"error_px", NumberOrNull(point.error_px)},
          {"gsd_m", NumberOrNull(point.gsd_m)},
          {"marks", point.marks.size()},
          {"marks_used", n_used}};
}

}  // namespace

Json ControlJson(const survey::ControlFit& fit) {
  if (fit.points.empty()) return nullptr;
  const ControlSummary summary = SummariseControl(fit);
  const ControlErrors* const judged = summary.Judged();
  const std::optional<bool> within = judged == nullptr ? std::nullopt : judged->WithinRule();
  Json json = {{"file", fit.file},
               {"crs", fit.crs},
               {"heights", fit.heights},
               {"placed", fit.placed},
               {"adjusted", fit.adjusted},
               {"control", ErrorsJson(summary.control)},
               {"left_out", ErrorsJson(summary.left_out)},
               {"check", ErrorsJson(summary.check)},
               {"rejected", summary.n_rejected},
               {"unseen", summary.n_unseen},
               {"within_rule", within ? Json(*within) : Json(nullptr)},
               {"statement", AccuracyStatement(summary)},
               {"points", Json::array()}};
  for (const survey::ControlPointFit& point : fit.points) json["points"].push_back(PointJson(point));
  return json;
}

}  // namespace skyquilt::evaluate::control
