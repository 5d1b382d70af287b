// What a drone camera writes beside the pixels: EXIF and XMP by Exiv2, with the known traps of UAV firmware.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/geo/geodetic.h"
#include "core/survey/survey.h"

namespace skyquilt::survey {

struct PhotoTags {
  std::optional<geo::Geodetic> gps;           // XMP latitude/longitude preferred (some firmware truncates EXIF); GPSAltitudeRef 1 = below.
                                              // Height: XMP AbsoluteAltitude, else EXIF, else NaN. Latitude = longitude = 0 counts as no fix.
  std::optional<double> relative_altitude_m;  // XMP drone-dji:RelativeAltitude
  std::optional<double> absolute_altitude_m;  // XMP drone-dji:AbsoluteAltitude
  bool rtk = false;                           // XMP drone-dji:RtkFlag says fixed: altitude is ellipsoidal
  std::optional<double> gimbal_yaw_deg, gimbal_pitch_deg, gimbal_roll_deg;
  ExposureSettings exposure;
  std::optional<double> focal_length_mm;
  std::optional<double> focal_length_35mm;
  std::optional<double> capture_time_s;  // seconds since 1970 of DateTimeOriginal (+ SubSec), camera clock
  std::string make, model;
};

// Unreadable or absent tags are simply absent. Throws base::InputError only if the file itself cannot be read as an image.
PhotoTags ReadPhotoTags(const std::filesystem::path& file);
// Adds the tags to an existing JPEG, as a drone would have written them. Throws base::InputError.
void WritePhotoTags(const PhotoTags& tags, const std::filesystem::path& file);

}  // namespace skyquilt::survey
