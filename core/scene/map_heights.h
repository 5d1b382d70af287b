// The heights of maps and of all other files with coordinates: how they follow from those of a scene's frame, and what they are called.
// A scene's frame has the survey's heights (SceneInfo::height_reference), which computations take for ellipsoidal. Between the ellipsoid and EGM96
// the undulation of the geoid at each place is added or subtracted, see geo::GeoidPatch. Heights of unknown reference are taken for
// ellipsoidal when a reference is asked for, and every file says so.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "core/geo/geodetic.h"
#include "core/geo/geoid.h"
#include "core/geo/height_reference.h"
#include "core/scene/scene.h"

namespace skyquilt::scene {

class MapHeights {
 public:
  // Without geo-reference heights stay as they are. Throws base::InputError when heights have to be converted and PROJ has no geoid.
  MapHeights(const SceneInfo& info, geo::Vertical wanted);
  // The same scene's heights in another system.
  MapHeights In(geo::Vertical wanted) const;

  // Of what is written.
  geo::HeightReference reference() const { return reference_; }
  // How often the undulation of EGM96 is added to the survey's heights: -1, 0 or 1.
  int undulations() const { return undulations_; }
  // Height in the file, metres, of a place with the survey's height; and back.
  double FromSurvey(const geo::Geodetic& place) const { return place.height_m + Added(place); }
  double ToSurvey(const geo::Geodetic& place) const { return place.height_m - Added(place); }

  // What heights are above: "WGS84 ellipsoid (EPSG:4979)", "EGM96 geoid (EPSG:5773)", either of them followed by ", if tagged heights are above the
  // ellipsoid"; "as tagged (unknown)"; "unknown: the GPS tags have no usable heights"; "local frame".
  std::string Name() const;
  // Items for files with heights: VERTICAL_REFERENCE, the name; VERTICAL = "as tagged (unknown)" where that is all that is known;
  // geo::kUndulationsItem where heights were converted.
  std::map<std::string, std::string> Metadata() const;
  // What was asked for and could not be given for certain, a sentence without its full stop; empty: nothing.
  std::string Caution() const;

 private:
  struct Given {
    bool georeferenced = false;
    bool has_heights = true;  // the tags had usable heights
    geo::HeightReference reference = geo::HeightReference::kUnknown;
    geo::Geodetic origin;
    double radius_m = 0.0;  // of the scene around its origin
  };
  MapHeights(const Given& given, geo::Vertical wanted);
  bool Assumed() const;
  double Added(const geo::Geodetic& place) const {
    return undulations_ == 0 ? 0.0 : undulations_ * geoid_->At(place.latitude_deg, place.longitude_deg);
  }

  Given given_;
  geo::Vertical wanted_;
  geo::HeightReference reference_ = geo::HeightReference::kUnknown;
  int undulations_ = 0;
  std::shared_ptr<const geo::GeoidPatch> geoid_;  // null: no undulations
};

}  // namespace skyquilt::scene
