// Reads the metadata of drone photos (position, exposure, time) from EXIF and XMP tags, and works around known errors of drone firmware.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geo/geodetic.h"
#include "core/survey/survey.h"

namespace skyquilt::survey {

// Whether there are such lenses: from 5 mm, which sees 150 degrees, to 1500 mm on film of 35 mm. Programs write 0, 1 or 65535 where they know
// nothing.
constexpr double kShortestFocal35_mm = 5.0, kLongestFocal35_mm = 1500.0;
constexpr bool IsPlausibleFocal35(double focal_mm) {
  return focal_mm >= kShortestFocal35_mm && focal_mm <= kLongestFocal35_mm;
}

// What GPano's XMP tags say of a panorama (Google, "Photo Sphere XMP Metadata"), of ProjectionType equirectangular alone.
struct PanoramaTags {
  std::optional<double> heading_deg;  // PoseHeadingDegrees: of the middle of the sphere, clockwise from north
  std::optional<double> pitch_deg;    // PosePitchDegrees: of the same, up is positive; missing: 0, the horizon is in the middle
  std::optional<double> roll_deg;     // PoseRollDegrees: the horizon turns counter-clockwise in the picture as it grows
  // Pixels of the whole sphere, and the part of it that the picture shows (FullPano..., CroppedArea...). All 0: the picture is the whole. Programs
  // that make pictures smaller leave these as they were: area_width need not be the picture's width.
  int full_width = 0, full_height = 0;
  int left = 0, top = 0;
  int area_width = 0;
};

struct PhotoTags {
  // Numbers that are 0 where 0 is none that a camera can have (focal length, exposure time, ...) count as missing.
  std::optional<geo::Geodetic> gps;  // latitude and longitude from XMP if present (some firmware truncates EXIF), else EXIF; both 0 counts as
                                     // no GPS fix. Height: XMP AbsoluteAltitude, else EXIF (GPSAltitudeRef 1 = negative), else NaN;
                                     // an AbsoluteAltitude of 0 goes behind another EXIF one
  std::optional<double> relative_altitude_m;  // XMP drone-dji:RelativeAltitude
  std::optional<double> absolute_altitude_m;  // XMP drone-dji:AbsoluteAltitude
  bool rtk = false;                           // XMP drone-dji:RtkFlag is 50 (RTK fixed): accurate, altitude is ellipsoidal
  // Stated accuracy of the tagged position, one standard deviation in metres: XMP RtkStdLon/RtkStdLat (the larger) and RtkStdHgt, else XMP
  // GPSXYAccuracy and GPSZAccuracy, else EXIF GPSHPositioningError.
  std::optional<double> horizontal_accuracy_m, vertical_accuracy_m;
  std::optional<double> dop;        // EXIF GPSDOP, dilution of precision: about 1 is good, above 5 poor
  std::optional<double> speed_mps;  // over ground: XMP FlightXSpeed and FlightYSpeed, else EXIF GPSSpeed, else DJI's maker note
  std::optional<double> gimbal_yaw_deg, gimbal_pitch_deg, gimbal_roll_deg;
  ExposureSettings exposure;
  std::optional<double> focal_length_mm;
  std::optional<double> focal_length_35mm;    // IsPlausibleFocal35, else nothing
  std::optional<double> calibrated_focal_px;  // XMP drone-dji:CalibratedFocalLength, pixels of the photo as taken
  std::vector<std::string> band_names;        // XMP Camera:BandName, in the order of the bands; empty: not named
  // EXIF PixelXDimension and PixelYDimension, as the camera took the photo: programs that make photos smaller often leave them. 0: no such tags.
  int original_width = 0, original_height = 0;
  int orientation = 1;                   // EXIF Orientation, 1 to 8, see core/survey/orientation.h; 1 when missing or unknown
  std::optional<double> capture_time_s;  // DateTimeOriginal (+ SubSec) in seconds since 1970, by the camera's clock
  std::string make, model;
  std::optional<PanoramaTags> panorama;  // nothing for photos that do not say that they are equirectangular
  std::string position_file;             // that `gps` comes from; empty: the photo itself
  std::vector<std::string> zero_tags;    // names of tags that are 0 and count as missing therefore
};

// Tags that are missing or unreadable stay empty. Throws base::InputError only if the file itself cannot be read as an image.
PhotoTags ReadPhotoTags(const std::filesystem::path& file);
// Adds the tags to an existing JPEG in the form DJI drones use; for simulated surveys. Throws base::InputError.
void WritePhotoTags(const PhotoTags& tags, const std::filesystem::path& file);

}  // namespace skyquilt::survey
