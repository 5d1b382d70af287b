#include <chrono>
#include <cmath>
#include <cstdio>
#include <exiv2/exiv2.hpp>

#include "core/base/errors.h"
#include "core/survey/exif.h"
#include "core/survey/exiv2_guard.h"

namespace skyquilt::survey {

std::unique_lock<std::mutex> LockExiv2() {
  static std::mutex mutex;
  std::unique_lock<std::mutex> lock(mutex);
  static const bool ready = [] {
    // Vendors' maker notes cause many irrelevant warnings.
    Exiv2::LogMsg::setLevel(Exiv2::LogMsg::mute);
    Exiv2::XmpParser::initialize();
    // The container of HEIC and CR3.
    Exiv2::enableBMFF(true);
    Exiv2::XmpProperties::registerNs("http://www.dji.com/drone-dji/1.0/", "drone-dji");
    Exiv2::XmpProperties::registerNs("http://pix4d.com/camera/1.0/", "Camera");
    Exiv2::XmpProperties::registerNs("http://ns.google.com/photos/1.0/panorama/", "GPano");
    return true;
  }();
  static_cast<void>(ready);
  return lock;
}

namespace {

std::string Format(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), format, value);
  return buffer;
}

void SetRational(Exiv2::ExifData& exif, const char* key, double value, uint32_t denominator) {
  const double numerator = std::round(value * denominator);
  SKYQUILT_CHECK(numerator >= 0.0 && numerator <= 4294967295.0, std::string(key) + " = " + std::to_string(value));
  exif[key] = Exiv2::URational(static_cast<uint32_t>(numerator), denominator);
}

// Degrees, minutes and 1e-7 seconds (3 micrometres).
void SetAngle(Exiv2::ExifData& exif, const char* key, double angle_deg) {
  constexpr int64_t kPerSecond = 10'000'000;
  const int64_t total = std::llround(std::abs(angle_deg) * 3600.0 * static_cast<double>(kPerSecond));
  Exiv2::URationalValue value;
  value.value_ = {{static_cast<uint32_t>(total / (3600 * kPerSecond)), 1U},
                  {static_cast<uint32_t>(total / (60 * kPerSecond) % 60), 1U},
                  {static_cast<uint32_t>(total % (60 * kPerSecond)), static_cast<uint32_t>(kPerSecond)}};
  exif[key].setValue(&value);
}

void SetPosition(Exiv2::ExifData& exif, Exiv2::XmpData& xmp, const geo::Geodetic& gps) {
  exif["Exif.GPSInfo.GPSVersionID"] = "2 3 0 0";
  exif["Exif.GPSInfo.GPSLatitudeRef"] = gps.latitude_deg < 0.0 ? "S" : "N";
  SetAngle(exif, "Exif.GPSInfo.GPSLatitude", gps.latitude_deg);
  exif["Exif.GPSInfo.GPSLongitudeRef"] = gps.longitude_deg < 0.0 ? "W" : "E";
  SetAngle(exif, "Exif.GPSInfo.GPSLongitude", gps.longitude_deg);
  xmp["Xmp.drone-dji.GpsLatitude"] = Format("%+.9f", gps.latitude_deg);
  xmp["Xmp.drone-dji.GpsLongitude"] = Format("%+.9f", gps.longitude_deg);
  if (std::isfinite(gps.height_m)) {
    Exiv2::DataValue below(Exiv2::unsignedByte);
    below.read(gps.height_m < 0.0 ? "1" : "0");
    exif["Exif.GPSInfo.GPSAltitudeRef"].setValue(&below);
    SetRational(exif, "Exif.GPSInfo.GPSAltitude", std::abs(gps.height_m), 1000);
  }
}

// With RTK as DJI does it. Without, DJI's drones say nothing: then EXIF's own tag, and Pix4D's for heights, for which EXIF has none.
void SetAccuracy(Exiv2::ExifData& exif, Exiv2::XmpData& xmp, const PhotoTags& tags) {
  if (tags.dop) SetRational(exif, "Exif.GPSInfo.GPSDOP", *tags.dop, 1000);
  if (tags.rtk) {
    if (tags.horizontal_accuracy_m) {
      const std::string horizontal = Format("%.5f", *tags.horizontal_accuracy_m);
      xmp["Xmp.drone-dji.RtkStdLon"] = horizontal;
      xmp["Xmp.drone-dji.RtkStdLat"] = horizontal;
    }
    if (tags.vertical_accuracy_m) xmp["Xmp.drone-dji.RtkStdHgt"] = Format("%.5f", *tags.vertical_accuracy_m);
    return;
  }
  if (tags.horizontal_accuracy_m) SetRational(exif, kGpsHPositioningError, *tags.horizontal_accuracy_m, 10'000);
  if (tags.vertical_accuracy_m) xmp["Xmp.Camera.GPSZAccuracy"] = Format("%.5f", *tags.vertical_accuracy_m);
}

void SetPanorama(Exiv2::XmpData& xmp, const PanoramaTags& panorama) {
  xmp["Xmp.GPano.ProjectionType"] = "equirectangular";
  xmp["Xmp.GPano.UsePanoramaViewer"] = "True";
  if (panorama.heading_deg) xmp["Xmp.GPano.PoseHeadingDegrees"] = Format("%.2f", *panorama.heading_deg);
  if (panorama.pitch_deg) xmp["Xmp.GPano.PosePitchDegrees"] = Format("%.2f", *panorama.pitch_deg);
  if (panorama.roll_deg) xmp["Xmp.GPano.PoseRollDegrees"] = Format("%.2f", *panorama.roll_deg);
  if (panorama.full_width == 0 || panorama.full_height == 0) return;
  xmp["Xmp.GPano.FullPanoWidthPixels"] = std::to_string(panorama.full_width);
  xmp["Xmp.GPano.FullPanoHeightPixels"] = std::to_string(panorama.full_height);
  xmp["Xmp.GPano.CroppedAreaLeftPixels"] = std::to_string(panorama.left);
  xmp["Xmp.GPano.CroppedAreaTopPixels"] = std::to_string(panorama.top);
  if (panorama.area_width > 0) xmp["Xmp.GPano.CroppedAreaImageWidthPixels"] = std::to_string(panorama.area_width);
}

// In EXIF, as the direction is not known that DJI's FlightXSpeed and FlightYSpeed need.
void SetSpeed(Exiv2::ExifData& exif, double speed_mps) {
  exif["Exif.GPSInfo.GPSSpeedRef"] = "K";
  SetRational(exif, "Exif.GPSInfo.GPSSpeed", 3.6 * speed_mps, 10'000);
}

void SetCaptureTime(Exiv2::ExifData& exif, double capture_time_s) {
  // Rounded once, so that 0.9999 s carries into the next second.
  const int64_t milliseconds = std::llround(capture_time_s * 1000.0);
  const auto time = std::chrono::sys_time<std::chrono::milliseconds>(std::chrono::milliseconds(milliseconds));
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(time - day);
  char text[64];
  std::snprintf(text, sizeof(text), "%04d:%02u:%02u %02d:%02d:%02d", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                static_cast<unsigned>(date.day()), static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()));
  exif["Exif.Image.DateTime"] = text;
  exif["Exif.Photo.DateTimeOriginal"] = text;
  exif["Exif.Photo.DateTimeDigitized"] = text;
  std::snprintf(text, sizeof(text), "%03d", static_cast<int>(clock.subseconds().count()));
  exif["Exif.Photo.SubSecTimeOriginal"] = text;
}

}  // namespace

void WritePhotoTags(const PhotoTags& tags, const std::filesystem::path& file) {
  const auto lock = LockExiv2();
  try {
    const auto image = Exiv2::ImageFactory::open(file.string());
    image->readMetadata();
    Exiv2::ExifData& exif = image->exifData();
    Exiv2::XmpData& xmp = image->xmpData();
    exif["Exif.Photo.ExifVersion"] = "48 50 51 48";
    if (!tags.make.empty()) exif["Exif.Image.Make"] = tags.make;
    if (!tags.model.empty()) exif["Exif.Image.Model"] = tags.model;
    if (tags.gps) SetPosition(exif, xmp, *tags.gps);
    if (tags.absolute_altitude_m) xmp["Xmp.drone-dji.AbsoluteAltitude"] = Format("%+.3f", *tags.absolute_altitude_m);
    if (tags.relative_altitude_m) xmp["Xmp.drone-dji.RelativeAltitude"] = Format("%+.3f", *tags.relative_altitude_m);
    if (tags.rtk) xmp["Xmp.drone-dji.RtkFlag"] = "50";
    SetAccuracy(exif, xmp, tags);
    if (tags.speed_mps) SetSpeed(exif, *tags.speed_mps);
    if (tags.gimbal_yaw_deg) xmp["Xmp.drone-dji.GimbalYawDegree"] = Format("%+.2f", *tags.gimbal_yaw_deg);
    if (tags.gimbal_pitch_deg) xmp["Xmp.drone-dji.GimbalPitchDegree"] = Format("%+.2f", *tags.gimbal_pitch_deg);
    if (tags.gimbal_roll_deg) xmp["Xmp.drone-dji.GimbalRollDegree"] = Format("%+.2f", *tags.gimbal_roll_deg);
    if (tags.exposure.time_s) SetRational(exif, "Exif.Photo.ExposureTime", *tags.exposure.time_s, 100'000'000);
    if (tags.exposure.f_number) SetRational(exif, "Exif.Photo.FNumber", *tags.exposure.f_number, 1000);
    if (tags.exposure.iso) exif["Exif.Photo.ISOSpeedRatings"] = static_cast<uint16_t>(std::lround(std::min(*tags.exposure.iso, 65534.0)));
    if (tags.focal_length_mm) SetRational(exif, "Exif.Photo.FocalLength", *tags.focal_length_mm, 10'000);
    if (tags.focal_length_35mm) exif["Exif.Photo.FocalLengthIn35mmFilm"] = static_cast<uint16_t>(std::lround(*tags.focal_length_35mm));
    if (tags.original_width > 0) exif["Exif.Photo.PixelXDimension"] = static_cast<uint32_t>(tags.original_width);
    if (tags.original_height > 0) exif["Exif.Photo.PixelYDimension"] = static_cast<uint32_t>(tags.original_height);
    if (tags.orientation != 1) exif["Exif.Image.Orientation"] = static_cast<uint16_t>(tags.orientation);
    if (tags.capture_time_s) SetCaptureTime(exif, *tags.capture_time_s);
    if (tags.panorama) SetPanorama(xmp, *tags.panorama);
    image->writeMetadata();
  } catch (const Exiv2::AnyError& error) {
    throw base::InputError(file, std::string("photo tags cannot be written (") + error.what() + ")",
                           "Check that the file is a JPEG and the disk has room");
  }
}

}  // namespace skyquilt::survey
