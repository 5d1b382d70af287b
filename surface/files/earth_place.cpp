#include "surface/files/earth_place.h"

#include <nlohmann/json.hpp>

namespace skyquilt::surface {

EarthPlace::EarthPlace(const MapFrame& frame) : heights_(frame.heights().In(geo::Vertical::kEllipsoid)), origin_(frame.origin()) {
  if (heights_.undulations() == 0) return;
  survey_.emplace(frame.origin());
  origin_.height_m = heights_.FromSurvey(frame.origin());
  tiles_.emplace(origin_);
}

Eigen::Vector3d EarthPlace::PositionOf(const Eigen::Vector3d& x_in_enu) const {
  if (!survey_) return x_in_enu;
  geo::Geodetic place = survey_->GeodeticFromEnu(x_in_enu);
  place.height_m = heights_.FromSurvey(place);
  return tiles_->EnuFromGeodetic(place);
}

bool StandInSurvey(nlohmann::ordered_json* tileset) {
  const nlohmann::ordered_json::json_pointer item(std::string("/asset/extras/") + kSurveyTransform);
  if (!tileset->contains(item)) return false;
  tileset->at("root")["transform"] = tileset->at(item);
  return true;
}

}  // namespace skyquilt::surface
