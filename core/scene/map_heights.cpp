#include "core/scene/map_heights.h"

#include <cmath>
#include <stdexcept>

#include "core/base/errors.h"

namespace skyquilt::scene {
namespace {

using geo::HeightReference;
using geo::Vertical;

constexpr double kAround_m = 2000.0;  // cameras and margins beyond the scene's box

double RadiusOf(const SceneInfo& info) {
  const double radius_m = info.min_enu.cwiseAbs().cwiseMax(info.max_enu.cwiseAbs()).head<2>().norm();
  return kAround_m + (std::isfinite(radius_m) ? radius_m : 0.0);
}

const char* WantedName(Vertical wanted) {
  return wanted == Vertical::kEgm96 ? "egm96" : "ellipsoid";
}

}  // namespace

MapHeights::MapHeights(const SceneInfo& info, Vertical wanted)
    : MapHeights({.georeferenced = info.georeferenced,
                  .has_heights = std::isfinite(info.accuracy.vertical_m) || !std::isfinite(info.accuracy.horizontal_m),
                  .reference = info.height_reference,
                  .origin = info.origin,
                  .radius_m = RadiusOf(info)},
                 wanted) {}

MapHeights::MapHeights(const Given& given, Vertical wanted) : given_(given), wanted_(wanted) {
  if (!given.georeferenced) return;
  reference_ = wanted == Vertical::kEllipsoid ? HeightReference::kEllipsoid : wanted == Vertical::kEgm96 ? HeightReference::kEgm96 : given.reference;
  // Unknown heights are taken for ellipsoidal.
  if (wanted == Vertical::kEllipsoid && given.reference == HeightReference::kEgm96) undulations_ = 1;
  if (wanted == Vertical::kEgm96 && given.reference != HeightReference::kEgm96) undulations_ = -1;
  if (undulations_ == 0) return;
  try {
    geoid_ = std::make_shared<geo::GeoidPatch>(given.origin, given.radius_m);
  } catch (const std::runtime_error& missing) {
    throw base::InputError(
        "egm96_15.gtx", std::string("is needed to convert heights: ") + missing.what(),
        "Install PROJ's grids (Debian: proj-data), or set products.vertical to 'as-tagged'; 3D tiles of heights above EGM96 need it "
        "too (surface.tiles = false makes none)");
  }
}

MapHeights MapHeights::In(Vertical wanted) const {
  return {given_, wanted};
}

bool MapHeights::Assumed() const {
  return given_.georeferenced && wanted_ != Vertical::kAsTagged && given_.reference == HeightReference::kUnknown;
}

std::string MapHeights::Name() const {
  if (!given_.georeferenced) return "local frame";
  const char* const condition = Assumed() ? ", if tagged heights are above the ellipsoid" : "";
  switch (reference_) {
    case HeightReference::kEllipsoid:
      return std::string("WGS84 ellipsoid (EPSG:4979)") + condition;
    case HeightReference::kEgm96:
      return std::string("EGM96 geoid (EPSG:5773)") + condition;
    case HeightReference::kUnknown:
      break;
  }
  return given_.has_heights ? "as tagged (unknown)" : "unknown: the GPS tags have no usable heights";
}

std::map<std::string, std::string> MapHeights::Metadata() const {
  std::map<std::string, std::string> items = {{"VERTICAL_REFERENCE", Name()}};
  if (given_.georeferenced && reference_ == HeightReference::kUnknown) items["VERTICAL"] = "as tagged (unknown)";
  if (undulations_ != 0) items[geo::kUndulationsItem] = std::to_string(undulations_);
  return items;
}

std::string MapHeights::Caution() const {
  if (wanted_ == Vertical::kAsTagged) return "";
  const std::string option = std::string("products.vertical = \"") + WantedName(wanted_) + "\" ";
  if (!given_.georeferenced) return option + "changes nothing, because the survey has no geo-reference: heights are those of its local frame";
  if (!Assumed()) return "";
  const std::string why = given_.has_heights ? "the photos' tags do not say what their heights are above" : "the GPS tags have no usable heights";
  return option + "rests on an assumption: " + why + ", so they are taken for heights above the WGS84 ellipsoid" +
         (undulations_ != 0 ? " and the geoid is subtracted" : " and kept as they are") +
         ". Give control points with known heights, or use tags with RTK";
}

}  // namespace skyquilt::scene
