#include "prepare/control/fit/control_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/geo/enu_frame.h"
#include "prepare/tables/csv_field.h"

namespace skyquilt::prepare::control {
namespace {

using Json = nlohmann::ordered_json;

int64_t UsedMarks(const survey::ControlPointFit& point) {
  return std::count_if(point.marks.begin(), point.marks.end(), [](const survey::ControlMarkFit& mark) { return mark.used; });
}

// To the millimetre.
Json Rounded(double value) {
  return std::isfinite(value) ? Json(std::round(value * 1000.0) / 1000.0) : Json(nullptr);
}

Json Rounded(const Eigen::Vector3d& v) {
  return {Rounded(v.x()), Rounded(v.y()), Rounded(v.z())};
}

}  // namespace

void WriteControlTable(const survey::Survey& survey, const std::filesystem::path& file) {
  std::string text =
      "label,use,east_m,north_m,up_m,error_east_m,error_north_m,error_up_m,sigma_east_m,sigma_north_m,sigma_up_m,left_out_error_east_m,"
      "left_out_error_north_m,left_out_error_up_m,error_px,marks_used,marks_given,gsd_m\n";
  for (const survey::ControlPointFit& point : survey.control.points) {
    text += tables::CsvText(point.label) + "," + survey::NameOf(point.use) + ",";
    for (const Eigen::Vector3d& v : {point.given_in_enu, point.error_m, point.sigma_m, point.left_out_error_m}) {
      for (const double value : {v.x(), v.y(), v.z()}) text += tables::CsvNumber(value, 4) + ",";
    }
    text += tables::CsvNumber(point.error_px, 3) + "," + std::to_string(UsedMarks(point)) + "," + std::to_string(point.marks.size()) + "," +
            tables::CsvNumber(point.gsd_m, 4) + "\n";
  }
  base::WriteFileAtomically(file, text);
}

void WriteControlMap(const survey::Survey& survey, const std::filesystem::path& file) {
  const geo::EnuFrame frame(survey.origin);
  Json features = Json::array();
  for (const survey::ControlPointFit& point : survey.control.points) {
    const bool has_height = std::isfinite(point.given_in_enu.z());
    const Eigen::Vector3d enu(point.given_in_enu.x(), point.given_in_enu.y(), has_height ? point.given_in_enu.z() : 0.0);
    const geo::Geodetic place = frame.GeodeticFromEnu(enu);
    Json coordinates = {place.longitude_deg, place.latitude_deg};
    if (has_height) coordinates.push_back(place.height_m);
    Json properties = {{"label", point.label},
                       {"use", survey::NameOf(point.use)},
                       {"error_m", Rounded(point.error_m)},
                       {"sigma_m", Rounded(point.sigma_m)},
                       {"left_out_error_m", Rounded(point.left_out_error_m)},
                       {"error_px", Rounded(point.error_px)},
                       {"marks_used", UsedMarks(point)},
                       {"marks_given", point.marks.size()},
                       {"gsd_m", Rounded(point.gsd_m)}};
    features.push_back(
        {{"type", "Feature"}, {"geometry", {{"type", "Point"}, {"coordinates", std::move(coordinates)}}}, {"properties", std::move(properties)}});
  }
  const Json map = {{"type", "FeatureCollection"}, {"features", std::move(features)}};
  base::WriteFileAtomically(file, base::JsonText(map, 1) + "\n");
}

void WriteControlReport(const survey::Survey& survey, const std::filesystem::path& folder) {
  const std::filesystem::path table = folder / "geo_control.csv", map = folder / "control.geojson";
  const bool any = !survey.control.points.empty();
  if (any) {
    WriteControlTable(survey, table);
  } else {
    std::filesystem::remove(table);
  }
  if (any && survey.georeferenced) {
    WriteControlMap(survey, map);
  } else {
    std::filesystem::remove(map);
  }
}

}  // namespace skyquilt::prepare::control
