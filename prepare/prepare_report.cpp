#include "prepare/prepare_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"
#include "core/survey/geo_fit.h"
#include "prepare/tables/csv_field.h"

namespace skyquilt::prepare {
namespace {

void LogProblems(const survey::Survey& survey) {
  for (const survey::Problem& problem : survey.problems) base::LogWarning("{}. What to do: {}", problem.finding, problem.advice);
}

void LogFlights(const survey::GeoFit& fit, const std::vector<survey::Photo>& photos) {
  for (size_t flight = 0; flight < fit.flight_vertical_drift_m.size(); ++flight) {
    const double offset_m = fit.flight_vertical_offset_m[flight], drift_m = fit.flight_vertical_drift_m[flight];
    if (fit.flight_vertical_drift_m.size() < 2 && std::abs(drift_m) < 1.0) continue;
    const auto n_photos =
        std::count_if(photos.begin(), photos.end(), [flight](const survey::Photo& photo) { return photo.flight == static_cast<int>(flight); });
    base::LogInfo("flight {}: {} photos, tagged heights moved by {:+.1f} m, their drift over the flight {:+.1f} m", flight + 1, n_photos, offset_m,
                  drift_m);
  }
}

const char* EvidenceName(const std::string& kind) {
  if (kind == "gimbal") return "gimbal angles";
  if (kind == "cameras") return "camera axes";
  if (kind == "stated") return "prepare.up";
  if (kind == "wall") return "plane of a wall";
  return kind == "ground" ? "plane of the ground" : "heights of the tags";
}

void LogGravity(const survey::GeoFit& fit) {
  for (const survey::GravityEvidence& evidence : fit.gravity) {
    if (std::isnan(evidence.sigma_deg)) continue;
    base::LogInfo("gravity by {}: leans {:.2f} deg from the result, accuracy {:.2f} deg, weight {:.0f} %", EvidenceName(evidence.kind),
                  std::hypot(evidence.lean_east_deg, evidence.lean_north_deg), evidence.sigma_deg, 100.0 * evidence.weight);
  }
}

const char* HeightsText(geo::HeightReference reference) {
  switch (reference) {
    case geo::HeightReference::kEllipsoid:
      return "height above the ellipsoid";
    case geo::HeightReference::kEgm96:
      return "height above EGM96, as drones without RTK tag it: often barometric and then metres off";
    case geo::HeightReference::kUnknown:
      break;
  }
  return "height as tagged; what it is above is not known";
}

void LogTags(const survey::Survey& survey) {
  const survey::GeoFit& fit = survey.fit;
  if (fit.n_inliers > 0) {
    const std::string vertical = std::isfinite(fit.rmse_vertical_m) ? tables::CsvNumber(fit.rmse_vertical_m, 2) + " m vertical" : "heights not used";
    base::LogInfo("GPS: {} of {} tags agree, RMSE {:.2f} m ({:.2f} m horizontal, {}), {:.6g} m per model unit", fit.n_inliers, fit.n_matches,
                  fit.rmse_m, fit.rmse_horizontal_m, vertical, fit.scale);
    return;
  }
  std::vector<double> distances_m;
  for (const survey::Photo& photo : survey.photos) {
    if (std::isfinite(photo.gps_residual_m)) distances_m.push_back(photo.gps_residual_m);
  }
  if (distances_m.empty()) return;
  base::LogInfo("GPS: none of {} tags agrees with the place found; they are {:.1f} m from their photos (median)", distances_m.size(),
                base::Median(distances_m));
}

}  // namespace

void LogSummary(const survey::Survey& survey) {
  const size_t n_all = survey.photos.size() + survey.unregistered.size();
  const auto n_test = std::count_if(survey.photos.begin(), survey.photos.end(), [](const survey::Photo& photo) { return photo.is_test; });
  base::LogInfo("photos with a pose: {} of {}, {} of them held out for testing{}", survey.photos.size(), n_all, n_test,
                survey.resected_holdout ? " and placed by the points of the others" : "");
  for (const camera::Camera& camera : survey.cameras) {
    base::LogInfo("camera: {} {}x{}, focal length {:.1f} px", camera::ModelName(camera.model), camera.width, camera.height, camera.FocalX());
  }
  const double agl = survey.MedianAgl();
  LogProblems(survey);
  if (!survey.georeferenced) {
    LogGravity(survey.fit);
    return;
  }
  const survey::GeoFit& fit = survey.fit;
  base::LogInfo("origin: {:.7f} deg latitude, {:.7f} deg longitude, {:.2f} m ({})", survey.origin.latitude_deg, survey.origin.longitude_deg,
                survey.origin.height_m, HeightsText(survey.height_reference));
  LogTags(survey);
  if (std::isfinite(fit.tag_lag_sigma_s)) base::LogInfo("GPS tags lag {:.2f} s behind the photos (+- {:.2f} s)", fit.tag_lag_s, fit.tag_lag_sigma_s);
  LogFlights(fit, survey.photos);
  LogGravity(fit);
  const geo::PlaceAccuracy& accuracy = fit.accuracy;
  base::LogInfo("accuracy (one standard deviation): position {} m, height {}, scale {} %, tilt {} deg, yaw {} deg",
                tables::CsvNumber(accuracy.horizontal_m, 2),
                std::isfinite(accuracy.vertical_m) ? tables::CsvNumber(accuracy.vertical_m, 2) + " m" : "unknown",
                tables::CsvNumber(accuracy.scale_percent, 3), tables::CsvNumber(accuracy.tilt_deg, 2), tables::CsvNumber(accuracy.yaw_deg, 2));
  std::vector<double> relative;
  for (const survey::Photo& photo : survey.photos) {
    if (photo.relative_altitude_m) relative.push_back(*photo.relative_altitude_m);
  }
  const std::string tagged = relative.empty() ? "no RelativeAltitude tag to compare with"
                                              : "median RelativeAltitude tag " + tables::CsvNumber(base::Median(relative), 1) + " m above take-off";
  base::LogInfo("height above ground: median {} m; {}", std::isfinite(agl) ? tables::CsvNumber(agl, 1) : "unknown", tagged);
}

void WriteResidualTable(const survey::Survey& survey, const georeference::Georeference& georeference, const std::filesystem::path& file) {
  const geo::EnuFrame frame(survey.origin);
  std::string text =
      "name,east_m,north_m,up_m,latitude_deg,longitude_deg,height_m,tag_latitude_deg,tag_longitude_deg,tag_height_m,"
      "correction_east_m,correction_north_m,correction_up_m,residual_east_m,residual_north_m,residual_up_m,residual_m,inlier,flight,agl_m,"
      "relative_altitude_m,test\n";
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const survey::Photo& photo = survey.photos[i];
    const Eigen::Vector3d centre = photo.cam_from_enu.OriginInSource();
    text += tables::CsvText(photo.name) + "," + tables::CsvNumber(centre.x(), 3) + "," + tables::CsvNumber(centre.y(), 3) + "," +
            tables::CsvNumber(centre.z(), 3) + ",";
    if (survey.georeferenced) {
      const geo::Geodetic position = frame.GeodeticFromEnu(centre);
      text += tables::CsvNumber(position.latitude_deg, 9) + "," + tables::CsvNumber(position.longitude_deg, 9) + "," +
              tables::CsvNumber(position.height_m, 3) + ",";
    } else {
      text += ",,,";
    }
    text += photo.gps ? tables::CsvNumber(photo.gps->latitude_deg, 9) + "," + tables::CsvNumber(photo.gps->longitude_deg, 9) + "," +
                            tables::CsvNumber(photo.gps->height_m, 3) + ","
                      : ",,,";
    for (const Eigen::Vector3d& v : {photo.gps_correction_m, georeference.photos[i].residual_m}) {
      for (const double value : {v.x(), v.y(), v.z()}) text += tables::CsvNumber(value, 3) + ",";
    }
    text += tables::CsvNumber(photo.gps_residual_m, 3) + "," + (photo.gps_inlier ? "1" : "0") + "," + std::to_string(photo.flight) + "," +
            tables::CsvNumber(photo.agl_m, 2) + ",";
    text += (photo.relative_altitude_m ? tables::CsvNumber(*photo.relative_altitude_m, 2) : "") + "," + (photo.is_test ? "1" : "0") + "\n";
  }
  base::WriteFileAtomically(file, text);
}

void WriteCameraMap(const survey::Survey& survey, const std::filesystem::path& file) {
  const geo::EnuFrame frame(survey.origin);
  const auto number = [](double value, double step) {
    return std::isfinite(value) ? nlohmann::ordered_json(std::round(value / step) * step) : nlohmann::ordered_json(nullptr);
  };
  nlohmann::ordered_json features = nlohmann::ordered_json::array();
  for (const survey::Photo& photo : survey.photos) {
    const geo::Geodetic position = frame.GeodeticFromEnu(photo.cam_from_enu.OriginInSource());
    nlohmann::ordered_json geometry = {{"type", "Point"}, {"coordinates", {position.longitude_deg, position.latitude_deg, position.height_m}}};
    nlohmann::ordered_json properties = {{"name", photo.name},
                                         {"agl_m", number(photo.agl_m, 0.01)},
                                         {"gps_residual_m", number(photo.gps_residual_m, 0.001)},
                                         {"gps_inlier", photo.gps_inlier},
                                         {"flight", photo.flight},
                                         {"test", photo.is_test}};
    features.push_back({{"type", "Feature"}, {"geometry", std::move(geometry)}, {"properties", std::move(properties)}});
  }
  const nlohmann::ordered_json map = {
      {"type", "FeatureCollection"}, {"skyquilt:accuracy", survey::ToJson(survey.fit.accuracy)}, {"features", std::move(features)}};
  base::WriteFileAtomically(file, base::JsonText(map, 1) + "\n");
}

}  // namespace skyquilt::prepare
