#include "odm/report/stats.h"

#include <fmt/chrono.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <nlohmann/json.hpp>

#include "core/base/amounts.h"
#include "core/base/errors.h"

namespace skyquilt::odm {
namespace {

using Json = nlohmann::ordered_json;

// As OpenSfM writes it.
std::string DateText(double seconds_since_1970) {
  return fmt::format("{:%d/%m/%Y at %H:%M:%S}", fmt::gmtime(static_cast<std::time_t>(seconds_since_1970)));
}

void AddTimes(const std::vector<survey::PhotoTags>& tags, Json* json) {
  std::vector<double> times;
  for (const survey::PhotoTags& one : tags) {
    if (one.capture_time_s) times.push_back(*one.capture_time_s);
  }
  if (times.empty()) return;
  const auto [first, last] = std::minmax_element(times.begin(), times.end());
  (*json)["start_date"] = DateText(*first);
  (*json)["end_date"] = DateText(*last);
}

// Root mean square errors, and the mean length.
Json GpsErrors(const survey::GeoFit& fit) {
  return {{"average_error", fit.rmse_m}, {"rmse_horizontal", fit.rmse_horizontal_m}, {"rmse_vertical", fit.rmse_vertical_m}};
}

Json ControlErrors(const survey::ControlFit& control) {
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  double lengths = 0.0;
  int n = 0;
  for (const survey::ControlPointFit& point : control.points) {
    if (point.use != survey::ControlUse::kControl || !point.error_m.allFinite()) continue;
    squares += point.error_m.cwiseAbs2();
    lengths += point.error_m.norm();
    ++n;
  }
  if (n == 0) return Json::object();
  const Eigen::Vector3d rms = (squares / n).cwiseSqrt();
  return {{"average_error", lengths / n}, {"rmse", {{"x", rms.x()}, {"y", rms.y()}, {"z", rms.z()}}}, {"points", n}};
}

}  // namespace

Json StatsJson(const StatsInput& input) {
  SKYQUILT_CHECK(input.survey != nullptr && input.tags != nullptr, "survey and tags must be set");
  const survey::Survey& survey = *input.survey;
  Json processing = Json::object();
  if (std::isfinite(input.area_m2)) processing["area"] = input.area_m2;
  AddTimes(*input.tags, &processing);
  const bool has_gps = survey.fit.n_inliers > 0;
  const bool has_gcp = survey.control.placed;
  Json stats = {{"processing_statistics", processing}};
  stats["reconstruction_statistics"] = {{"components", 1},
                                        {"has_gps", has_gps},
                                        {"has_gcp", has_gcp},
                                        {"initial_shots_count", survey.photos.size() + survey.unregistered.size()},
                                        {"reconstructed_shots_count", survey.photos.size()},
                                        {"reconstructed_points_count", survey.points.size()}};
  if (has_gps) stats["gps_errors"] = GpsErrors(survey.fit);
  if (!survey.control.points.empty()) stats["gcp_errors"] = ControlErrors(survey.control);
  // WebODM takes the count of the first dimension for that of the cloud.
  Json cloud = {{"dense", input.cloud_points >= 0}};
  if (input.cloud_points >= 0) cloud["stats"] = {{"statistic", Json::array({{{"name", "X"}, {"position", 0}, {"count", input.cloud_points}}})}};
  stats["point_cloud_statistics"] = cloud;
  stats["odm_processing_statistics"] = {{"total_time", input.seconds}, {"total_time_human", base::FormatDuration(input.seconds)}};
  if (std::isfinite(input.gsd_m)) stats["odm_processing_statistics"]["average_gsd"] = 100.0 * input.gsd_m;  // centimetres
  return stats;
}

}  // namespace skyquilt::odm
