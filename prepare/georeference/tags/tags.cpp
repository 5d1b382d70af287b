#include "prepare/georeference/tags/tags.h"

#include <cmath>
#include <limits>
#include <optional>

#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"

namespace skyquilt::prepare::georeference {

using Eigen::Vector3d;

namespace {

// The tagged position with a height that can be computed with.
geo::Geodetic Place(const geo::Geodetic& gps) {
  return {gps.latitude_deg, gps.longitude_deg, std::isfinite(gps.height_m) ? gps.height_m : 0.0};
}

}  // namespace

// Medians are taken in an ENU frame, which has no special case at the poles and the date line. The frame starts at one of the tags and is moved to
// the median, where it is level.
geo::Geodetic MedianPosition(const std::vector<input::PreparedPhoto>& photos) {
  std::vector<double> heights;
  std::optional<geo::Geodetic> centre;
  for (const input::PreparedPhoto& photo : photos) {
    if (!photo.gps) continue;
    if (std::isfinite(photo.gps->height_m)) heights.push_back(photo.gps->height_m);
    if (!centre) centre = Place(*photo.gps);
  }
  const double height_m = heights.empty() ? 0.0 : base::Median(heights);
  centre->height_m = height_m;
  for (int round = 0; round < 3; ++round) {
    const geo::EnuFrame frame(*centre);
    std::vector<double> axis[3];
    for (const input::PreparedPhoto& photo : photos) {
      if (!photo.gps) continue;
      const Vector3d x = frame.EnuFromGeodetic({photo.gps->latitude_deg, photo.gps->longitude_deg, height_m});
      for (int i = 0; i < 3; ++i) axis[i].push_back(x[i]);
    }
    centre = frame.GeodeticFromEnu({base::Median(axis[0]), base::Median(axis[1]), base::Median(axis[2])});
  }
  return {centre->latitude_deg, centre->longitude_deg, height_m};
}

std::vector<Tag> CollectTags(const std::vector<input::PreparedPhoto>& photos, const std::vector<size_t>& order, const geo::Geodetic& origin,
                             HeightTags heights) {
  const geo::EnuFrame frame(origin);
  std::vector<Tag> tags;
  for (const size_t i : order) {
    const input::PreparedPhoto& photo = photos[i];
    if (!photo.gps) continue;
    geo::Geodetic place = *photo.gps;
    if (heights == HeightTags::kRelative) place.height_m = photo.file.tags.relative_altitude_m.value_or(std::numeric_limits<double>::quiet_NaN());
    const bool usable = heights != HeightTags::kUnknown && std::isfinite(place.height_m);
    if (!usable) place.height_m = origin.height_m;
    Tag tag{.photo = i,
            .x_in_enu = frame.EnuFromGeodetic(place),
            .horizontal_sigma_m = photo.horizontal_sigma_m,
            .vertical_sigma_m = photo.vertical_sigma_m};
    if (!usable) tag.x_in_enu.z() = std::numeric_limits<double>::quiet_NaN();
    tags.push_back(tag);
  }
  return tags;
}

double MedianSigma(const std::vector<Tag>& tags, double Tag::*sigma) {
  std::vector<double> values;
  values.reserve(tags.size());
  for (const Tag& tag : tags) values.push_back(tag.*sigma);
  return base::Median(values);
}

}  // namespace skyquilt::prepare::georeference
