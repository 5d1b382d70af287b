// Where 3D tiles stand on Earth. Their CRS, EPSG:4978, has heights above the ellipsoid only.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "core/geo/enu_frame.h"
#include "surface/map_frame.h"

namespace skyquilt::surface {

// The frame of the tiles is the survey's east-north-up frame with its origin raised to its true height above the ellipsoid. Where the survey's
// heights are ellipsoidal, unknown or local, it is the survey's frame itself.
class EarthPlace {
 public:
  // Throws base::InputError when heights have to be converted and PROJ has no geoid.
  explicit EarthPlace(const MapFrame& frame);

  bool raised() const { return survey_.has_value(); }
  const geo::Geodetic& origin() const { return origin_; }
  // In the frame of the tiles, of a place in the survey's: both differ by what the geoid's height changes from the origin to there, and by the
  // curvature of the Earth, 8 micrometres per metre of the geoid's height and kilometre.
  Eigen::Vector3d PositionOf(const Eigen::Vector3d& x_in_enu) const;
  // See scene::MapHeights::Name.
  std::string VerticalName() const { return heights_.Name(); }

 private:
  scene::MapHeights heights_;
  geo::Geodetic origin_;
  std::optional<geo::EnuFrame> survey_, tiles_;  // set when raised
};

// Item of asset.extras in tileset.json of raised tiles: the transform that the root would have with the survey's heights.
inline constexpr const char* kSurveyTransform = "surveyTransform";
// Gives the root the transform kSurveyTransform, for programs that show tiles together with the survey's cameras and points. False for tilesets
// without it, which stay as they are. Throws nlohmann::json::exception when the tileset is damaged.
bool StandInSurvey(nlohmann::ordered_json* tileset);

}  // namespace skyquilt::surface
