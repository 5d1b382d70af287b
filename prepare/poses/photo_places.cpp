#include "prepare/poses/photo_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"
#include "prepare/input/shots.h"

namespace skyquilt::prepare::poses {
namespace {

constexpr double kDistinct_m = 0.5;
constexpr double kDefaultHeight_m = 100.0;
constexpr double kMinHeight_m = 2.0, kMaxHeight_m = 10000.0;
constexpr double kObliqueFromNadir_deg = 5.0;
// Nearer to the horizon the middle of the photo is farther away than what can be matched.
constexpr double kMaxFromNadir_deg = 60.0;

double Radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

// The direction that the tags tell.
struct Looking {
  double from_nadir_deg, yaw_deg, height_m;
};

std::optional<Looking> LookingOf(const survey::PhotoTags& tags) {
  if (!tags.gimbal_pitch_deg || !tags.gimbal_yaw_deg || !tags.relative_altitude_m) return std::nullopt;
  const double from_nadir_deg = 90.0 + *tags.gimbal_pitch_deg, height_m = *tags.relative_altitude_m;
  // Upward by a hand's breadth is a camera at the horizon with a tilted drone.
  if (!(from_nadir_deg > -20.0 && from_nadir_deg < 120.0) || !std::isfinite(*tags.gimbal_yaw_deg)) return std::nullopt;
  if (!(height_m > kMinHeight_m && height_m < kMaxHeight_m)) return std::nullopt;
  return Looking{from_nadir_deg, *tags.gimbal_yaw_deg, height_m};
}

// False when all oblique photos have exactly the same yaw; one alone proves nothing.
bool YawsDiffer(const std::vector<input::PhotoFile>& photos) {
  std::optional<double> first;
  size_t n_oblique = 0;
  for (const input::PhotoFile& photo : photos) {
    const auto looking = LookingOf(photo.tags);
    if (!looking || std::abs(looking->from_nadir_deg) < kObliqueFromNadir_deg) continue;
    ++n_oblique;
    if (!first) first = looking->yaw_deg;
    if (*first != looking->yaw_deg) return true;
  }
  return n_oblique < 2;
}

bool HasPosition(const input::PhotoFile& photo) {
  return photo.tags.gps && geo::IsValid({photo.tags.gps->latitude_deg, photo.tags.gps->longitude_deg, 0.0});
}

// The tagged height, else that above take-off; 0 where neither is known.
double HeightOf(const survey::PhotoTags& tags) {
  for (const double height_m : {tags.gps->height_m, tags.relative_altitude_m.value_or(0.0)}) {
    if (std::abs(height_m) < kMaxHeight_m) return height_m;
  }
  return 0.0;
}

// Whether positions, rounded to a grid, tell at least every second shot from all others. Photos of a facade differ in height; those of one shot need
// not differ.
bool PlacesDiffer(const std::vector<std::optional<PhotoPlace>>& places, const std::vector<input::PhotoFile>& photos) {
  const std::vector<size_t> shots = input::FindShots(photos);
  std::set<std::array<int64_t, 3>> cells;
  size_t n_shots = 0;
  for (size_t i = 0; i < places.size(); ++i) {
    if (!places[i]) continue;
    // The first photo of a shot has a position if any has.
    n_shots += shots[i] == i ? 1 : 0;
    const Eigen::Vector3d x(places[i]->camera.x(), places[i]->camera.y(), HeightOf(photos[i].tags));
    cells.insert({std::llround(x.x() / kDistinct_m), std::llround(x.y() / kDistinct_m), std::llround(x.z() / kDistinct_m)});
  }
  return 2 * cells.size() >= n_shots;
}

}  // namespace

std::vector<std::optional<PhotoPlace>> FindPlaces(const std::vector<input::PhotoFile>& photos) {
  std::vector<std::optional<PhotoPlace>> places(photos.size());
  const auto first = std::find_if(photos.begin(), photos.end(), HasPosition);
  if (first == photos.end()) return places;
  const geo::EnuFrame frame({first->tags.gps->latitude_deg, first->tags.gps->longitude_deg, 0.0});

  std::vector<double> heights;
  for (const input::PhotoFile& photo : photos) {
    if (const auto looking = LookingOf(photo.tags)) heights.push_back(looking->height_m);
  }
  const double median_height_m = heights.empty() ? kDefaultHeight_m : base::Median(heights);
  const bool use_directions = YawsDiffer(photos);
  if (!use_directions) base::LogWarning("all oblique photos have the same gimbal yaw: directions are not used to choose the pairs to match");

  for (size_t i = 0; i < photos.size(); ++i) {
    if (!HasPosition(photos[i])) continue;
    const geo::Geodetic& gps = *photos[i].tags.gps;
    PhotoPlace place;
    place.camera = frame.EnuFromGeodetic({gps.latitude_deg, gps.longitude_deg, 0.0}).head<2>();
    place.target = place.camera;
    Eigen::Vector3d direction(0.0, 0.0, -1.0);
    if (const auto looking = use_directions ? LookingOf(photos[i].tags) : std::nullopt) {
      const double tilt = Radians(looking->from_nadir_deg), yaw = Radians(looking->yaw_deg);
      const Eigen::Vector2d ahead(std::sin(yaw), std::cos(yaw));
      direction << std::sin(tilt) * ahead, -std::cos(tilt);
      place.target += looking->height_m * std::tan(std::min(tilt, Radians(kMaxFromNadir_deg))) * ahead;
    }
    place.view = median_height_m * direction;
    places[i] = place;
  }

  if (!PlacesDiffer(places, photos)) {
    const auto n_tagged = std::count_if(places.begin(), places.end(), [](const auto& place) { return place.has_value(); });
    base::LogWarning("the GPS tags of {} photos hardly differ: they are not used to choose the pairs to match", n_tagged);
    std::fill(places.begin(), places.end(), std::nullopt);
  }
  return places;
}

bool HasObliquePhotos(const std::vector<std::optional<PhotoPlace>>& places) {
  return std::any_of(places.begin(), places.end(), [](const auto& place) { return place && (place->target - place->camera).norm() > kDistinct_m; });
}

}  // namespace skyquilt::prepare::poses
