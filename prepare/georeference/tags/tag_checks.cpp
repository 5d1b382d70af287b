#include "prepare/georeference/tags/tag_checks.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "core/geo/enu_frame.h"

namespace skyquilt::prepare::georeference {
namespace {

// Even a drone that holds its height, and a receiver that rounds to centimetres, vary more than this.
constexpr double kSameHeight_m = 0.005;
constexpr double kSamePlace_m = 1.0;
constexpr double kNoHeight = std::numeric_limits<double>::quiet_NaN();

// The file, or the one of most of them, that most positions come from; empty: the photos' own tags.
std::string PositionFile(const std::vector<input::PreparedPhoto>& photos) {
  std::map<std::string, size_t> count;
  size_t n_gps = 0;
  for (const input::PreparedPhoto& photo : photos) {
    if (!photo.gps) continue;
    ++n_gps;
    if (!photo.file.tags.position_file.empty()) ++count[photo.file.tags.position_file];
  }
  size_t n_of_files = 0, most = 0;
  std::string found;
  for (const auto& [file, n] : count) {
    n_of_files += n;
    if (n > most) found = file;
    most = std::max(most, n);
  }
  return 2 * n_of_files > n_gps ? found : "";
}

}  // namespace

bool HeightsVary(const std::vector<double>& heights_m) {
  if (heights_m.size() < 2) return !heights_m.empty();
  const auto [low, high] = std::minmax_element(heights_m.begin(), heights_m.end());
  return *high - *low > kSameHeight_m;
}

HeightTags JudgeHeights(const std::vector<input::PreparedPhoto>& photos) {
  std::vector<double> tagged, relative;
  size_t n_gps = 0;
  for (const input::PreparedPhoto& photo : photos) {
    if (!photo.gps) continue;
    ++n_gps;
    if (std::isfinite(photo.gps->height_m)) tagged.push_back(photo.gps->height_m);
    if (photo.file.tags.relative_altitude_m) relative.push_back(*photo.file.tags.relative_altitude_m);
  }
  if (HeightsVary(tagged)) return HeightTags::kTagged;
  const bool all_zero = std::all_of(relative.begin(), relative.end(), [](double height_m) { return height_m == 0.0; });
  return 2 * relative.size() > n_gps && !all_zero ? HeightTags::kRelative : HeightTags::kUnknown;
}

bool TagsAboveOneAnother(const std::vector<input::PreparedPhoto>& photos) {
  std::optional<geo::EnuFrame> frame;
  for (const input::PreparedPhoto& photo : photos) {
    if (!photo.gps) continue;
    const geo::Geodetic place{photo.gps->latitude_deg, photo.gps->longitude_deg, 0.0};
    if (!frame) {
      frame.emplace(place);
    } else if (!(frame->EnuFromGeodetic(place).norm() <= kSamePlace_m)) {
      return false;
    }
  }
  return true;
}

bool AllTagsEqual(const std::vector<input::PreparedPhoto>& photos) {
  if (!TagsAboveOneAnother(photos)) return false;
  const HeightTags heights = JudgeHeights(photos);
  if (heights == HeightTags::kUnknown) return true;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const input::PreparedPhoto& photo : photos) {
    if (!photo.gps) continue;
    const double height_m = heights == HeightTags::kTagged ? photo.gps->height_m : photo.file.tags.relative_altitude_m.value_or(kNoHeight);
    if (!std::isfinite(height_m)) continue;
    low = std::min(low, height_m);
    high = std::max(high, height_m);
  }
  return !(high - low > kSamePlace_m);
}

std::vector<CoordinateFault> PossibleCoordinateFaults(const std::vector<input::PreparedPhoto>& photos) {
  struct Kind {
    const char* code;
    const char* finding;
    const char* advice;
    // The same of a file of positions.
    const char* of_file;
    const char* otherwise;
    const char* repair_file;
    std::function<geo::Geodetic(const geo::Geodetic&)> repair;
  };
  const Kind kinds[] = {
      {"swapped_coordinates", "latitude and longitude are exchanged in the GPS tags: read the other way round, they fit the camera positions",
       "Exchange them in the photos (exiftool: \"-GPSLatitude<GPSLongitude\" \"-GPSLongitude<GPSLatitude\" and the two Ref tags likewise, XMP too) "
       "or "
       "tag the photos again from the flight log, then run the same command with --restart",
       "x and y (longitude and latitude, or east and north) look exchanged in ", "the other way round",
       "Write x (longitude or east) before y (latitude or north), or name the columns in a first line below the coordinate system, for instance "
       "photo,lat,lon,height",
       [](const geo::Geodetic& p) {
         return geo::Geodetic{p.longitude_deg, p.latitude_deg, p.height_m};
       }},
      // Either sign alone mirrors the flight, so the positions cannot tell which of the two is wrong.
      {"mirrored_coordinates",
       "the latitudes or the longitudes of the GPS tags have the wrong sign (north for south, or east for west): with the other sign they fit the "
       "camera positions",
       "Correct GPSLatitudeRef (N or S) or GPSLongitudeRef (E or W) in the photos, for instance with exiftool, then run the same command with "
       "--restart",
       "the latitudes or the longitudes have the wrong sign in ", "with the other sign", "West and south are negative: correct the signs",
       [](const geo::Geodetic& p) {
         return geo::Geodetic{p.latitude_deg, -p.longitude_deg, p.height_m};
       }}};
  const std::string file = PositionFile(photos);
  std::vector<CoordinateFault> faults;
  for (const Kind& kind : kinds) {
    CoordinateFault fault{.problem = {.code = kind.code, .finding = kind.finding, .advice = kind.advice, .about_place = true}, .repaired = photos};
    if (!file.empty()) {
      fault.problem.finding = std::string(kind.of_file) + file + ": read " + kind.otherwise + ", its positions fit those of the cameras";
      fault.problem.advice =
          std::string(kind.repair_file) + ", or remove the file to use the photos' own tags, then run the same command with --restart";
    }
    bool possible = true;
    for (input::PreparedPhoto& photo : fault.repaired) {
      if (!photo.gps) continue;
      const geo::Geodetic place = kind.repair(*photo.gps);
      possible = possible && std::abs(place.latitude_deg) <= 90.0;
      photo.gps = geo::Geodetic{place.latitude_deg, geo::WrapLongitudeDeg(place.longitude_deg), place.height_m};
    }
    if (possible) faults.push_back(std::move(fault));
  }
  return faults;
}

}  // namespace skyquilt::prepare::georeference
