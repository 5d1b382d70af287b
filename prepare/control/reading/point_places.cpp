#include "prepare/control/reading/point_places.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/base/errors.h"
#include "core/geo/geoid.h"
#include "prepare/tables/text_table.h"

namespace skyquilt::prepare::control {
namespace {

enum class Above { kAsSystem, kEllipsoid, kEgm96 };

constexpr const char* kCrsFix = "Give their coordinate system with prepare.gcp_crs, for instance EPSG:32632, or EPSG:4326 for longitude and latitude";
constexpr const char* kPlaceFix =
    "Check that x is east or longitude and y north or latitude (prepare.gcp_columns says what the columns are), and that the coordinate system is "
    "theirs";
constexpr const char* kGridFix =
    "Install PROJ's grid of that system (projsync, or Debian's proj-data), or say with prepare.gcp_heights what the heights are: ellipsoid or egm96";

Above ParseHeights(const std::string& heights) {
  if (heights.empty() || heights == "crs") return Above::kAsSystem;
  if (heights == "ellipsoid") return Above::kEllipsoid;
  if (heights == "egm96") return Above::kEgm96;
  throw base::UsageError("gcp_heights is '" + heights + "', but must be crs, ellipsoid or egm96");
}

geo::Crs MakeCrs(const RawControl& control, const std::string& option) {
  const std::string& definition = option.empty() ? control.crs : option;
  if (definition.empty()) throw base::InputError(control.file, "does not say what coordinate system its points are in", kCrsFix);
  try {
    // OpenSfM's short form.
    return geo::Crs(definition == "WGS84" ? "EPSG:4326" : definition);
  } catch (const std::invalid_argument& error) {
    const std::string found = "'" + definition.substr(0, 60) + "' is not a coordinate system (" + error.what() + ")";
    if (!option.empty()) throw base::UsageError("gcp_crs: " + found);
    tables::FailTableLine(control.file, control.crs_line, found, kCrsFix);
  }
}

std::string NameOfSystem(const geo::Crs& crs, const std::string& definition) {
  return crs.name().empty() || crs.name() == "unknown" ? definition : crs.name();
}

// Metres per unit of the heights.
double HeightUnit(const geo::Crs& crs) {
  if (crs.heights() != geo::CrsHeights::kNone) return crs.vertical().unit_m;
  return crs.horizontal().unit_m > 0.0 ? crs.horizontal().unit_m : 1.0;
}

std::string NameOfHeights(const geo::Crs& crs, Above above) {
  if (above == Above::kEgm96) return "egm96";
  if (above == Above::kEllipsoid || crs.heights() != geo::CrsHeights::kGravity) return "ellipsoid";
  return crs.vertical().name == "EGM96 height" ? "egm96" : crs.vertical().name;
}

class Placer {
 public:
  Placer(const geo::Crs& crs, Above above)
      : crs_(&crs), by_system_(above == Above::kAsSystem && crs.heights() != geo::CrsHeights::kNone), above_(above) {
    if (crs.heights() != geo::CrsHeights::kNone) {
      // A geocentric system has no plane, so its heights cannot be replaced.
      try {
        plane_.emplace(crs.WithoutHeights());
      } catch (const std::invalid_argument&) {
        if (!by_system_) throw;
      }
    }
  }
  const geo::Crs& plane() const { return plane_ ? *plane_ : *crs_; }

  geo::Geodetic Place(const Eigen::Vector3d& given) const {
    if (!std::isnan(given.z()) && by_system_) return crs_->ToGeodetic(given);
    if (crs_->heights() != geo::CrsHeights::kNone && !plane_)
      throw std::invalid_argument("a point of a geocentric system needs all three coordinates");
    geo::Geodetic place = plane().ToGeodetic({given.x(), given.y(), 0.0});
    place.height_m = given.z() * HeightUnit(*crs_);
    if (above_ == Above::kEgm96 && !std::isnan(given.z())) place.height_m += geo::Egm96Undulation(place.latitude_deg, place.longitude_deg);
    return place;
  }

 private:
  const geo::Crs* crs_;
  bool by_system_;
  Above above_;
  std::optional<geo::Crs> plane_;
};

// What was assumed about heights, for the log; empty: nothing.
std::string Assumption(const geo::Crs& crs, Above above) {
  if (crs.heights() != geo::CrsHeights::kNone || crs.horizontal().unit_m == 1.0) return "";
  if (crs.horizontal().unit_m > 0.0)
    return "heights are taken in the unit of x and y (" + crs.horizontal().unit + "), as the system has none for heights";
  return above == Above::kAsSystem ? "heights are taken as metres above the ellipsoid, as the system says nothing about them" : "";
}

}  // namespace

PointPlaces PlacePoints(const RawControl& control, const std::string& option, const std::string& heights) {
  const Above above = ParseHeights(heights);
  const geo::Crs crs = MakeCrs(control, option);
  if (crs.IsGeographic() && !control.order_known) {
    throw base::InputError(control.file, "has longitudes and latitudes, but nothing says which come first",
                           "Name the columns in its first line, or with prepare.gcp_columns: label,lon,lat,up or label,lat,lon,up");
  }
  PointPlaces result;
  result.definition = option.empty() ? control.crs : option;
  if (result.definition == "WGS84") result.definition = "EPSG:4326";
  result.crs = NameOfSystem(crs, result.definition);
  result.heights = NameOfHeights(crs, above);
  bool has_height = false, guessed = false;
  std::optional<Placer> placer;
  try {
    placer.emplace(crs, above);
  } catch (const std::invalid_argument& error) {
    throw base::InputError(control.file, std::string("gcp_heights cannot be used with ") + result.crs + ": " + error.what(), "Leave it away");
  }
  result.places.resize(control.points.size());
  for (size_t i = 0; i < control.points.size(); ++i) {
    const RawPoint& point = control.points[i];
    try {
      result.places[i] = placer->Place(point.given);
      has_height = has_height || !std::isnan(point.given.z());
      guessed = guessed || placer->plane().IsDatumGuessed({point.given.x(), point.given.y(), std::isnan(point.given.z()) ? 0.0 : point.given.z()});
    } catch (const std::invalid_argument& error) {
      const std::string what = error.what();
      result.problems[i] = {point.line, point.label + ": " + what, what.find("grid") == std::string::npos ? kPlaceFix : kGridFix};
    }
  }
  const std::string assumption = has_height ? Assumption(crs, above) : "";
  if (!assumption.empty()) result.warnings.push_back(assumption);
  if (guessed) {
    result.warnings.push_back("PROJ knows no exact way from the datum of " + result.crs +
                              " to WGS84; the survey may be placed metres off, with old datums more");
  }
  return result;
}

}  // namespace skyquilt::prepare::control
