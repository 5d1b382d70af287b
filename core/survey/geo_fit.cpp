#include "core/survey/geo_fit.h"

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"

namespace skyquilt::survey {

using base::NanIfNull;
using base::NumberOrNull;
using nlohmann::json;
using nlohmann::ordered_json;

ordered_json ToJson(const geo::PlaceAccuracy& accuracy) {
  return {{"scale_percent", NumberOrNull(accuracy.scale_percent)},
          {"tilt_deg", NumberOrNull(accuracy.tilt_deg)},
          {"yaw_deg", NumberOrNull(accuracy.yaw_deg)},
          {"horizontal_m", NumberOrNull(accuracy.horizontal_m)},
          {"vertical_m", NumberOrNull(accuracy.vertical_m)}};
}

geo::PlaceAccuracy PlaceAccuracyFromJson(const json& value) {
  return {.scale_percent = NanIfNull(value.at("scale_percent")),
          .tilt_deg = NanIfNull(value.at("tilt_deg")),
          .yaw_deg = NanIfNull(value.at("yaw_deg")),
          .horizontal_m = NanIfNull(value.at("horizontal_m")),
          .vertical_m = NanIfNull(value.at("vertical_m"))};
}

ordered_json ToJson(const GeoFit& fit) {
  ordered_json gravity = ordered_json::array();
  for (const GravityEvidence& evidence : fit.gravity) {
    gravity.push_back({{"kind", evidence.kind},
                       {"n", evidence.n},
                       {"lean_east_deg", NumberOrNull(evidence.lean_east_deg)},
                       {"lean_north_deg", NumberOrNull(evidence.lean_north_deg)},
                       {"sigma_deg", NumberOrNull(evidence.sigma_deg)},
                       {"weight", evidence.weight}});
  }
  ordered_json json = {{"n_matches", fit.n_matches},
                       {"n_inliers", fit.n_inliers},
                       {"rmse_m", NumberOrNull(fit.rmse_m)},
                       {"rmse_horizontal_m", NumberOrNull(fit.rmse_horizontal_m)},
                       {"rmse_vertical_m", NumberOrNull(fit.rmse_vertical_m)},
                       {"scale", fit.scale},
                       {"tag_lag_s", fit.tag_lag_s},
                       {"tag_lag_sigma_s", NumberOrNull(fit.tag_lag_sigma_s)},
                       {"flight_vertical_offset_m", fit.flight_vertical_offset_m},
                       {"flight_vertical_drift_m", fit.flight_vertical_drift_m},
                       {"accuracy", ToJson(fit.accuracy)},
                       {"gravity", std::move(gravity)},
                       {"tags_alone_tilt_deg", NumberOrNull(fit.tags_alone_tilt_deg)},
                       {"adjusted_to_tags", fit.adjusted_to_tags}};
  for (const ScaleBarFit& bar : fit.scale_bars) {
    json["scale_bars"].push_back({{"a", bar.a}, {"b", bar.b}, {"length_m", bar.length_m}, {"measured_m", bar.measured_m}});
  }
  return json;
}

GeoFit GeoFitFromJson(const json& value) {
  GeoFit fit;
  fit.n_matches = value.at("n_matches").get<int>();
  fit.n_inliers = value.at("n_inliers").get<int>();
  fit.rmse_m = NanIfNull(value.at("rmse_m"));
  fit.rmse_horizontal_m = NanIfNull(value.at("rmse_horizontal_m"));
  fit.rmse_vertical_m = NanIfNull(value.at("rmse_vertical_m"));
  fit.scale = value.at("scale").get<double>();
  fit.tag_lag_s = value.at("tag_lag_s").get<double>();
  fit.tag_lag_sigma_s = NanIfNull(value.at("tag_lag_sigma_s"));
  fit.flight_vertical_offset_m = value.at("flight_vertical_offset_m").get<std::vector<double>>();
  fit.flight_vertical_drift_m = value.at("flight_vertical_drift_m").get<std::vector<double>>();
  fit.accuracy = PlaceAccuracyFromJson(value.at("accuracy"));
  for (const json& entry : value.at("gravity")) {
    fit.gravity.push_back({.kind = entry.at("kind").get<std::string>(),
                           .n = entry.at("n").get<int>(),
                           .lean_east_deg = NanIfNull(entry.at("lean_east_deg")),
                           .lean_north_deg = NanIfNull(entry.at("lean_north_deg")),
                           .sigma_deg = NanIfNull(entry.at("sigma_deg")),
                           .weight = entry.at("weight").get<double>()});
  }
  fit.tags_alone_tilt_deg = NanIfNull(value.at("tags_alone_tilt_deg"));
  // Only where there are any.
  for (const json& bar : value.value("scale_bars", json::array())) {
    fit.scale_bars.push_back(
        {bar.at("a").get<std::string>(), bar.at("b").get<std::string>(), bar.at("length_m").get<double>(), bar.at("measured_m").get<double>()});
  }
  fit.adjusted_to_tags = value.value("adjusted_to_tags", false);  // not in surveys of earlier versions
  return fit;
}

ordered_json ToJson(const FlightChecks& checks) {
  return {{"speed_mps", NumberOrNull(checks.speed_mps)},       {"speed_source", checks.speed_source},
          {"readout_ms", NumberOrNull(checks.readout_ms)},     {"camera_name", checks.camera_name},
          {"smear_px", NumberOrNull(checks.smear_px)},         {"dome_m", NumberOrNull(checks.dome_m)},
          {"dome_sigma_m", NumberOrNull(checks.dome_sigma_m)}, {"k1", NumberOrNull(checks.k1)},
          {"k1_sigma", NumberOrNull(checks.k1_sigma)}};
}

FlightChecks FlightChecksFromJson(const json& value) {
  return {.speed_mps = NanIfNull(value.at("speed_mps")),
          .speed_source = value.at("speed_source").get<std::string>(),
          .readout_ms = NanIfNull(value.at("readout_ms")),
          .camera_name = value.at("camera_name").get<std::string>(),
          .smear_px = NanIfNull(value.at("smear_px")),
          .dome_m = NanIfNull(value.at("dome_m")),
          .dome_sigma_m = NanIfNull(value.at("dome_sigma_m")),
          .k1 = NanIfNull(value.at("k1")),
          .k1_sigma = NanIfNull(value.at("k1_sigma"))};
}

ordered_json ToJson(const Problem& problem) {
  return {{"code", problem.code}, {"finding", problem.finding}, {"advice", problem.advice}, {"about_place", problem.about_place}};
}

Problem ProblemFromJson(const json& value) {
  return {.code = value.at("code").get<std::string>(),
          .finding = value.at("finding").get<std::string>(),
          .advice = value.at("advice").get<std::string>(),
          .about_place = value.at("about_place").get<bool>()};
}

}  // namespace skyquilt::survey
