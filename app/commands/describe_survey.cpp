#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/commands/describe.h"
#include "app/commands/describe_number.h"
#include "core/survey/survey.h"
#include "evaluate/control/control_summary.h"

namespace skyquilt::app {
namespace {

using Json = nlohmann::ordered_json;

Json Gravity(const survey::GeoFit& fit) {
  Json rows = Json::array();
  for (const survey::GravityEvidence& evidence : fit.gravity) {
    rows.push_back({{"evidence", evidence.kind},
                    {"n", evidence.n},
                    {"lean_east_deg", Round(evidence.lean_east_deg, 2)},
                    {"lean_north_deg", Round(evidence.lean_north_deg, 2)},
                    {"sigma_deg", RoundSignificant(evidence.sigma_deg)},
                    {"weight", Round(evidence.weight, 3)}});
  }
  return rows;
}

// Errors of one group of points.
Json Errors(const evaluate::control::ControlErrors& errors) {
  const auto metres = [](double value) { return Round(value, 4); };
  return {{"points", errors.n},
          {"mean_m", {metres(errors.mean_m.x()), metres(errors.mean_m.y()), metres(errors.mean_m.z())}},
          {"rmse_horizontal_m", metres(errors.rmse_horizontal_m)},
          {"rmse_vertical_m", metres(errors.rmse_vertical_m)},
          {"rmse_horizontal_gsd", Round(errors.rmse_horizontal_gsd, 2)},
          {"rmse_vertical_gsd", Round(errors.rmse_vertical_gsd, 2)}};
}

Json Control(const survey::ControlFit& fit) {
  const evaluate::control::ControlSummary summary = evaluate::control::SummariseControl(fit);
  Json json = {{"file", fit.file}, {"crs", fit.crs}, {"heights", fit.heights}, {"placed", fit.placed}, {"adjusted", fit.adjusted}};
  if (summary.check.n > 0) json["check"] = Errors(summary.check);
  if (summary.left_out.n > 0) json["left_out"] = Errors(summary.left_out);
  if (summary.control.n > 0) json["control"] = Errors(summary.control);
  json["rejected"] = Json::array();
  json["unseen"] = Json::array();
  for (const survey::ControlPointFit& point : fit.points) {
    if (point.use == survey::ControlUse::kRejected) json["rejected"].push_back(point.label);
    if (point.use == survey::ControlUse::kUnseen) json["unseen"].push_back(point.label);
  }
  json["accuracy"] = evaluate::control::AccuracyStatement(summary);
  return json;
}

}  // namespace

nlohmann::ordered_json DescribeAccuracy(const geo::PlaceAccuracy& accuracy) {
  return {{"scale_percent", RoundSignificant(accuracy.scale_percent)},
          {"tilt_deg", RoundSignificant(accuracy.tilt_deg)},
          {"yaw_deg", RoundSignificant(accuracy.yaw_deg)},
          {"horizontal_m", RoundSignificant(accuracy.horizontal_m)},
          {"vertical_m", RoundSignificant(accuracy.vertical_m)}};
}

nlohmann::ordered_json DescribePlace(const survey::Survey& survey) {
  const survey::GeoFit& fit = survey.fit;
  Json place = {{"georeferenced", survey.georeferenced}};
  if (survey.georeferenced) {
    place["origin"] = DescribeOrigin(survey.origin);
    place["gps_fit"] = {{"matches", fit.n_matches},
                        {"inliers", fit.n_inliers},
                        {"rmse_m", Round(fit.rmse_m, 3)},
                        {"rmse_horizontal_m", Round(fit.rmse_horizontal_m, 3)},
                        {"rmse_vertical_m", Round(fit.rmse_vertical_m, 3)},
                        {"scale", fit.scale},
                        {"tag_lag_s", Round(fit.tag_lag_s, 3)},
                        {"tag_lag_sigma_s", RoundSignificant(fit.tag_lag_sigma_s)},
                        {"flight_vertical_offset_m", fit.flight_vertical_offset_m},
                        {"flight_vertical_drift_m", fit.flight_vertical_drift_m}};
  }
  for (const survey::ScaleBarFit& bar : fit.scale_bars) {
    place["scale_bars"].push_back({{"a", bar.a}, {"b", bar.b}, {"length_m", bar.length_m}, {"measured_m", Round(bar.measured_m, 4)}});
  }
  place["accuracy"] = DescribeAccuracy(fit.accuracy);
  if (!fit.gravity.empty()) place["gravity"] = Gravity(fit);
  if (!survey.control.points.empty()) place["control"] = Control(survey.control);
  Json problems = Json::array();
  for (const survey::Problem& problem : survey.problems) {
    problems.push_back({{"code", problem.code}, {"finding", problem.finding}, {"advice", problem.advice}});
  }
  place["problems"] = problems;
  return place;
}

nlohmann::ordered_json DescribeSurvey(const std::filesystem::path& folder) {
  const survey::Survey survey = survey::LoadSurvey(folder);
  const auto n_test = std::count_if(survey.photos.begin(), survey.photos.end(), [](const survey::Photo& photo) { return photo.is_test; });
  const auto n_gps = std::count_if(survey.photos.begin(), survey.photos.end(), [](const survey::Photo& photo) { return photo.gps.has_value(); });
  Json cameras = Json::array();
  for (const camera::Camera& camera : survey.cameras) {
    cameras.push_back({{"model", camera::ModelName(camera.model)}, {"width", camera.width}, {"height", camera.height}, {"params", camera.params}});
  }
  Json json = {{"what", "survey"},  {"photo_root", survey.photo_root.string()}, {"photos", survey.photos.size()},       {"held_out", n_test},
               {"with_gps", n_gps}, {"without_pose", survey.unregistered},      {"sparse_points", survey.points.size()}};
  json.update(DescribePlace(survey));
  json["kept_points"] = survey.kept_points.size();
  json["observations"] = survey.tracks.observations() + survey.kept_tracks.observations();
  json["median_agl_m"] = Round(survey.MedianAgl(), 2);
  json["cameras"] = cameras;
  json["has_ground_truth"] = survey.truth.has_value();
  return json;
}

}  // namespace skyquilt::app
