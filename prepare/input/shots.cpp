#include "prepare/input/shots.h"

#include <cmath>
#include <optional>
#include <string>

#include "core/geo/ecef.h"

namespace skyquilt::prepare::input {
namespace {

constexpr double kSamePlace_m = 0.5, kSameDirection_deg = 2.0;
constexpr double kLongestStep_s = 2.0, kLongestShot_s = 5.0, kLongestWithoutExposure_s = 1.0;
constexpr double kLeastStops = 0.3;
constexpr size_t kMostInShot = 9;

std::string ShotFolder(const PhotoFile& photo) {
  return photo.name.substr(0, photo.name.rfind('/') + 1);  // npos + 1 is 0
}

// Stops of light that the settings let in; nothing when the tags do not tell.
std::optional<double> LightOf(const survey::ExposureSettings& exposure) {
  if (!exposure.time_s || !(*exposure.time_s > 0.0)) return std::nullopt;
  const double aperture = exposure.f_number.value_or(1.0), iso = exposure.iso.value_or(100.0);
  if (!(aperture > 0.0) || !(iso > 0.0)) return std::nullopt;
  return std::log2(*exposure.time_s * iso / (aperture * aperture));
}

bool AreClose(const std::optional<double>& a, const std::optional<double>& b, double most) {
  return !a || !b || std::abs(std::remainder(*a - *b, 360.0)) <= most;
}

// With the height above take-off where the position has none; nothing without a position on Earth.
std::optional<Eigen::Vector3d> PlaceOf(const survey::PhotoTags& tags) {
  if (!tags.gps || !geo::IsValid({tags.gps->latitude_deg, tags.gps->longitude_deg, 0.0})) return std::nullopt;
  const double height_m = std::isfinite(tags.gps->height_m) ? tags.gps->height_m : tags.relative_altitude_m.value_or(0.0);
  return geo::EcefFromGeodetic({tags.gps->latitude_deg, tags.gps->longitude_deg, std::isfinite(height_m) ? height_m : 0.0});
}

bool HaveOnePlace(const survey::PhotoTags& a, const survey::PhotoTags& b) {
  const std::optional<Eigen::Vector3d> place_a = PlaceOf(a), place_b = PlaceOf(b);
  return place_a && place_b && (*place_a - *place_b).norm() <= kSamePlace_m;
}

// Whether `next` goes on with a shot of photos [first, last].
bool GoesOn(const std::vector<PhotoFile>& photos, size_t first, size_t last, size_t next) {
  if (last - first + 2 > kMostInShot) return false;
  const PhotoFile& a = photos[first];
  const PhotoFile& b = photos[next];
  const survey::PhotoTags& start = a.tags;
  const survey::PhotoTags& tags = b.tags;
  if (a.width != b.width || a.height != b.height || start.model != tags.model || ShotFolder(a) != ShotFolder(b)) return false;
  if (!HaveOnePlace(start, tags)) return false;
  if (!AreClose(start.gimbal_yaw_deg, tags.gimbal_yaw_deg, kSameDirection_deg) ||
      !AreClose(start.gimbal_pitch_deg, tags.gimbal_pitch_deg, kSameDirection_deg)) {
    return false;
  }
  const std::optional<double> before_s = photos[last].tags.capture_time_s;
  if (!start.capture_time_s || !before_s || !tags.capture_time_s) return false;
  const double step_s = std::abs(*tags.capture_time_s - *before_s), length_s = std::abs(*tags.capture_time_s - *start.capture_time_s);
  if (step_s > kLongestStep_s || length_s > kLongestShot_s) return false;
  const std::optional<double> light = LightOf(tags.exposure);
  for (size_t i = first; i <= last; ++i) {
    const std::optional<double> other = LightOf(photos[i].tags.exposure);
    if (light && other ? std::abs(*light - *other) < kLeastStops : step_s > kLongestWithoutExposure_s) return false;
  }
  return true;
}

}  // namespace

std::vector<size_t> FindShots(const std::vector<PhotoFile>& photos) {
  std::vector<size_t> shots(photos.size(), 0);
  for (size_t i = 1; i < photos.size(); ++i) shots[i] = GoesOn(photos, shots[i - 1], i - 1, i) ? shots[i - 1] : i;
  return shots;
}

size_t CountShots(const std::vector<size_t>& shots) {
  size_t n = 0;
  for (size_t i = 0; i < shots.size(); ++i) n += shots[i] == i ? 1 : 0;
  return n;
}

}  // namespace skyquilt::prepare::input
