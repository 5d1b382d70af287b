#include "prepare/prepare_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"
#include "core/survey/geo_fit_json.h"

namespace skyquilt::prepare {
namespace {

std::string Field(double value, int digits) {
  if (!std::isfinite(value)) return "";
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), "%.*f", digits, value);
  return buffer;
}

// RFC 4180.
std::string Quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char character : text) quoted += character == '"' ? std::string("\"\"") : std::string(1, character);
  return quoted + "\"";
}

void LogFlights(const survey::Survey& survey) {
  int n_flights = 0;
  for (const survey::Photo& photo : survey.photos) n_flights = std::max(n_flights, photo.flight + 1);
  if (n_flights < 2) return;
  const std::vector<double>& offset = survey.fit.flight_vertical_offset_m;
  for (int flight = 0; flight < n_flights; ++flight) {
    const auto n_photos =
        std::count_if(survey.photos.begin(), survey.photos.end(), [flight](const survey::Photo& photo) { return photo.flight == flight; });
    const double offset_m = offset.empty() ? 0.0 : offset[static_cast<size_t>(flight)];
    spdlog::info("flight {}: {} photos, {:+.2f} m added to its tagged heights", flight, n_photos, offset_m);
  }
}

}  // namespace

void LogSummary(const survey::Survey& survey, const Georeference& georeference) {
  const size_t n_all = survey.photos.size() + survey.unregistered.size();
  const auto n_test = std::count_if(survey.photos.begin(), survey.photos.end(), [](const survey::Photo& photo) { return photo.is_test; });
  spdlog::info("photos with a pose: {} of {}, {} of them held out for testing", survey.photos.size(), n_all, n_test);
  for (const camera::Camera& camera : survey.cameras) {
    spdlog::info("camera: {} {}x{}, focal length {:.1f} px", camera::ModelName(camera.model), camera.width, camera.height, camera.FocalX());
  }
  const double agl = survey.MedianAgl();
  if (!survey.georeferenced) {
    spdlog::warn(
        "no geo-reference: {}. The survey gets a local frame of unknown scale (median depth {:.0f} units), and maps cannot be placed on Earth. To "
        "geo-reference it, use photos with GPS tags",
        georeference.reason, kLocalDepth);
    return;
  }
  const survey::GeoFit& fit = survey.fit;
  spdlog::info(
      "origin: {:.7f} deg latitude, {:.7f} deg longitude, {:.2f} m (height as tagged; without RTK usually above sea level, not the ellipsoid)",
      survey.origin.latitude_deg, survey.origin.longitude_deg, survey.origin.height_m);
  spdlog::info("GPS: {} of {} tags fit, RMSE {:.2f} m ({:.2f} m horizontal, {:.2f} m vertical), {:.6g} m per model unit", fit.n_inliers,
               fit.n_matches, fit.rmse_m, fit.rmse_horizontal_m, fit.rmse_vertical_m, fit.scale);
  for (size_t i = 0, n_named = 0; i < survey.photos.size() && n_named < 5; ++i) {
    if (!survey.photos[i].gps || survey.photos[i].gps_inlier) continue;
    spdlog::warn("GPS tag of {} is {:.1f} m from the fitted position and is not used; if many are, raise prepare.ransac_threshold_m",
                 survey.photos[i].name, survey.photos[i].gps_residual_m);
    ++n_named;
  }
  LogFlights(survey);
  std::vector<double> relative;
  for (const survey::Photo& photo : survey.photos) {
    if (photo.relative_altitude_m) relative.push_back(*photo.relative_altitude_m);
  }
  const std::string tagged = relative.empty() ? "no RelativeAltitude tag to compare with"
                                              : "median RelativeAltitude tag " + Field(base::Median(relative), 1) + " m above take-off";
  spdlog::info("height above ground: median {} m; {}", std::isfinite(agl) ? Field(agl, 1) : "unknown", tagged);
}

void WriteResidualTable(const survey::Survey& survey, const Georeference& georeference, const std::filesystem::path& file) {
  const geo::EnuFrame frame(survey.origin);
  std::string text =
      "name,east_m,north_m,up_m,latitude_deg,longitude_deg,height_m,tag_latitude_deg,tag_longitude_deg,tag_height_m,"
      "residual_m,residual_up_m,inlier,flight,flight_offset_m,agl_m,relative_altitude_m,test\n";
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const survey::Photo& photo = survey.photos[i];
    const Eigen::Vector3d centre = photo.cam_from_enu.OriginInSource();
    text += Quoted(photo.name) + "," + Field(centre.x(), 3) + "," + Field(centre.y(), 3) + "," + Field(centre.z(), 3) + ",";
    if (survey.georeferenced) {
      const geo::Geodetic position = frame.GeodeticFromEnu(centre);
      text += Field(position.latitude_deg, 9) + "," + Field(position.longitude_deg, 9) + "," + Field(position.height_m, 3) + ",";
    } else {
      text += ",,,";
    }
    text +=
        photo.gps ? Field(photo.gps->latitude_deg, 9) + "," + Field(photo.gps->longitude_deg, 9) + "," + Field(photo.gps->height_m, 3) + "," : ",,,";
    const std::vector<double>& offset = survey.fit.flight_vertical_offset_m;
    text += Field(photo.gps_residual_m, 3) + "," + Field(georeference.residual_up_m[i], 3) + "," + (photo.gps_inlier ? "1" : "0") + "," +
            std::to_string(photo.flight) + "," + Field(offset.empty() ? 0.0 : offset[static_cast<size_t>(photo.flight)], 3) + "," +
            Field(photo.agl_m, 2) + ",";
    text += (photo.relative_altitude_m ? Field(*photo.relative_altitude_m, 2) : "") + "," + (photo.is_test ? "1" : "0") + "\n";
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
  base::WriteFileAtomically(file, map.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace skyquilt::prepare
