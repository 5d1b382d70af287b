// Tags of value 0 that nobody measured: altitudes, RelativeAltitude and gimbal angles that a program or a drone left unfilled. A survey may well be
// at sea level or look north, so each photo is judged by what the others say.
//   altitude          exactly 0. With RelativeAltitude: no value when the photo's own RelativeAltitude and the other photos' difference of the two
//                     say another height, by more than 2 m and 5 sigmas of that difference. Without: when 0 is outside the range of the other
//                     altitudes by more than 5 m and a quarter of that range. Where all altitudes are 0 nothing is known, see JudgeHeights.
//   RelativeAltitude  0 in all photos; else exactly 0 and contradicted likewise by altitude, or without altitude by the range of the others
//   gimbal angles     yaw, pitch and roll exactly 0 in all photos; or in some while most others look down or up by more than 5 degrees
// A photo without an altitude gets one from RelativeAltitude and the median difference of altitude and RelativeAltitude in the photos of its flight,
// or of all flights, that have both. Otherwise its height is NaN: then it is placed by latitude and longitude alone.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::georeference {

struct UnfilledTags {
  size_t n_photos = 0;
  size_t n_altitudes = 0;                    // were 0 and count as missing
  size_t n_filled = 0;                       // altitudes that come from RelativeAltitude now, whether they were 0 or missing
  size_t n_relative = 0, n_gimbal = 0;       // were 0 and count as missing
  std::map<std::string, size_t> at_reading;  // photos by PhotoTags::zero_tags

  bool Any() const { return n_altitudes + n_filled + n_relative + n_gimbal + at_reading.size() > 0; }
  // One line for the log.
  std::string Describe() const;
};

// Changes the photos' tags as said above. `flight_gap_s`: see SplitFlights.
UnfilledTags ClearUnfilledTags(double flight_gap_s, std::vector<input::PhotoFile>& photos);
// The same, with a warning when there are such tags.
void LogUnfilledTags(double flight_gap_s, std::vector<input::PhotoFile>& photos);

// Some makers write +90 for a camera that looks straight down. No survey looks up so steeply: when at least nine in ten gimbal pitches are above
// 60 degrees, all pitches change their sign, with a warning. Returns whether they did.
bool TurnPitchesThatLookUp(std::vector<input::PhotoFile>& photos);

}  // namespace skyquilt::prepare::georeference
