#include "evaluate/control/tag_positions.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geo/enu_frame.h"

namespace skyquilt::evaluate::control {

namespace {

std::optional<TagPosition> PositionOf(const survey::Photo& photo, const geo::EnuFrame& enu) {
  if (!photo.gps) return std::nullopt;
  const bool has_height = !std::isnan(photo.gps->height_m);
  geo::Geodetic tag = *photo.gps;
  if (!has_height) tag.height_m = enu.origin().height_m;
  if (!geo::IsValid(tag)) return std::nullopt;
  TagPosition position;
  position.recorded = enu.EnuFromGeodetic(tag);
  if (!has_height) position.recorded.z() = std::numeric_limits<double>::quiet_NaN();
  position.corrected = position.recorded + photo.gps_correction_m;
  position.residual = photo.cam_from_enu.OriginInSource() - position.corrected;
  return position;
}

}  // namespace

std::vector<std::optional<TagPosition>> TagPositions(const survey::Survey& survey) {
  std::vector<std::optional<TagPosition>> tags(survey.photos.size());
  if (!survey.georeferenced || !geo::IsValid(survey.origin)) return tags;
  const geo::EnuFrame enu(survey.origin);
  std::transform(survey.photos.begin(), survey.photos.end(), tags.begin(), [&](const survey::Photo& photo) { return PositionOf(photo, enu); });
  return tags;
}

std::map<int, std::vector<size_t>> PhotosByFlight(const survey::Survey& survey) {
  std::map<int, std::vector<size_t>> flights;
  for (size_t i = 0; i < survey.photos.size(); ++i) flights[survey.photos[i].flight].push_back(i);
  const auto time_of = [&](size_t i) { return survey.photos[i].time_s.value_or(-std::numeric_limits<double>::infinity()); };
  for (auto& [flight, photos] : flights) {
    std::stable_sort(photos.begin(), photos.end(), [&](size_t a, size_t b) { return time_of(a) < time_of(b); });
  }
  return flights;
}

}  // namespace skyquilt::evaluate::control
