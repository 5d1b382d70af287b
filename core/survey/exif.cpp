#include "core/survey/exif.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exiv2/exiv2.hpp>
#include <limits>
#include <string_view>

#include "core/base/errors.h"
#include "core/image/develop.h"
#include "core/survey/dji_maker_note.h"
#include "core/survey/exiv2_guard.h"
#include "core/survey/orientation.h"

namespace skyquilt::survey {
namespace {

std::optional<double> Finite(double value) {
  return std::isfinite(value) ? std::optional<double>(value) : std::nullopt;
}

// Where 0 means "not given".
std::optional<double> Positive(std::optional<double> value) {
  return value && *value > 0.0 ? value : std::nullopt;
}

// Likewise; the name of a tag that is 0 is noted.
std::optional<double> PositiveTag(std::optional<double> value, const char* name, PhotoTags& tags) {
  if (value && *value == 0.0) tags.zero_tags.emplace_back(name);
  return Positive(value);
}

// Component `index` of a number tag; nothing for 0/0, n/0, a wrong type or too few components.
std::optional<double> ExifNumber(const Exiv2::ExifData& exif, const char* key, long index = 0) {
  const auto found = exif.findKey(Exiv2::ExifKey(key));
  if (found == exif.end() || index >= found->count()) return std::nullopt;
  switch (found->typeId()) {
    case Exiv2::unsignedRational:
    case Exiv2::signedRational: {
      // Exiv2 returns signed 32-bit numbers: unsigned values above 2^31 would be negative.
      const bool is_unsigned = found->typeId() == Exiv2::unsignedRational;
      const Exiv2::Rational pair = found->toRational(index);
      const double numerator = is_unsigned ? static_cast<double>(static_cast<uint32_t>(pair.first)) : static_cast<double>(pair.first);
      const double denominator = is_unsigned ? static_cast<double>(static_cast<uint32_t>(pair.second)) : static_cast<double>(pair.second);
      if (denominator == 0.0) return std::nullopt;
      return Finite(numerator / denominator);
    }
    case Exiv2::unsignedByte:
    case Exiv2::unsignedShort:
    case Exiv2::unsignedLong:
    case Exiv2::signedShort:
    case Exiv2::signedLong:
      return static_cast<double>(found->toLong(index));
    case Exiv2::tiffFloat:
    case Exiv2::tiffDouble:
      return Finite(static_cast<double>(found->toFloat(index)));
    default:
      return std::nullopt;
  }
}

std::string ExifText(const Exiv2::ExifData& exif, const char* key) {
  const auto found = exif.findKey(Exiv2::ExifKey(key));
  if (found == exif.end()) return {};
  std::string text = found->toString();
  while (!text.empty() && (text.back() == ' ' || text.back() == '\0')) text.pop_back();
  return text;
}

// Compares the name without its namespace prefix, which files may choose freely.
std::string XmpText(const Exiv2::XmpData& xmp, std::string_view name) {
  for (const Exiv2::Xmpdatum& datum : xmp) {
    if (datum.tagName() == name) return datum.toString();
  }
  return {};
}

// The number at the start of `text`, which is removed together with spaces around it. A plus sign may lead.
std::optional<double> TakeNumber(std::string_view* text) {
  constexpr std::string_view kSpaces = " \t\r\n";
  text->remove_prefix(std::min(text->find_first_not_of(kSpaces), text->size()));
  if (text->starts_with('+') && !text->starts_with("+-")) text->remove_prefix(1);
  double value = 0.0;
  const auto result = std::from_chars(text->data(), text->data() + text->size(), value);
  if (result.ec != std::errc()) return std::nullopt;
  text->remove_prefix(static_cast<size_t>(result.ptr - text->data()));
  text->remove_prefix(std::min(text->find_first_not_of(kSpaces), text->size()));
  return value;
}

// Nothing when the text is more than a number, such as "12abc": what it means is unknown then.
std::optional<double> XmpNumber(const Exiv2::XmpData& xmp, std::string_view name) {
  const std::string text = XmpText(xmp, name);
  std::string_view rest = text;
  std::optional<double> value = TakeNumber(&rest);
  if (!value) return std::nullopt;
  // Some vendors write rationals ("1500/10").
  if (rest.starts_with('/')) {
    rest.remove_prefix(1);
    const std::optional<double> denominator = TakeNumber(&rest);
    if (!denominator || *denominator == 0.0) return std::nullopt;
    *value /= *denominator;
  }
  return rest.empty() ? Finite(*value) : std::nullopt;
}

std::optional<double> ExifAngle(const Exiv2::ExifData& exif, const char* value_key, const char* reference_key, char negative) {
  const auto degrees = ExifNumber(exif, value_key, 0);
  if (!degrees) return std::nullopt;
  // Some programs put everything into the degrees and write 0/0 for minutes or seconds.
  const double angle = *degrees + ExifNumber(exif, value_key, 1).value_or(0.0) / 60.0 + ExifNumber(exif, value_key, 2).value_or(0.0) / 3600.0;
  const std::string reference = ExifText(exif, reference_key);
  return !reference.empty() && (reference[0] == negative || reference[0] == negative + ('a' - 'A')) ? -angle : angle;
}

std::optional<double> ExifAltitude(const Exiv2::ExifData& exif) {
  const auto altitude = ExifNumber(exif, "Exif.GPSInfo.GPSAltitude");
  if (!altitude) return std::nullopt;
  const auto reference = ExifNumber(exif, "Exif.GPSInfo.GPSAltitudeRef");
  return reference && *reference == 1.0 ? -std::abs(*altitude) : *altitude;
}

// What receivers without a fix write.
bool IsNoFix(const std::optional<double>& latitude_deg, const std::optional<double>& longitude_deg) {
  return latitude_deg && longitude_deg && *latitude_deg == 0.0 && *longitude_deg == 0.0;
}

bool IsPlausible(double latitude_deg, double longitude_deg) {
  return !IsNoFix(latitude_deg, longitude_deg) && std::abs(latitude_deg) <= 90.0 && std::abs(longitude_deg) <= 360.0;
}

// XMP first, because the EXIF of some firmware has fewer digits. XMP altitude and XMP latitude may each be present without the other.
std::optional<geo::Geodetic> ReadPosition(const Exiv2::ExifData& exif, const Exiv2::XmpData& xmp, PhotoTags& tags) {
  auto latitude = XmpNumber(xmp, "GpsLatitude");
  if (!latitude) latitude = XmpNumber(xmp, "Latitude");
  auto longitude = XmpNumber(xmp, "GpsLongitude");
  // A spelling mistake in many versions of DJI's firmware.
  if (!longitude) longitude = XmpNumber(xmp, "GpsLongtitude");
  if (!longitude) longitude = XmpNumber(xmp, "Longitude");
  bool no_fix = IsNoFix(latitude, longitude);
  if (!latitude || !longitude || !IsPlausible(*latitude, *longitude)) {
    latitude = ExifAngle(exif, "Exif.GPSInfo.GPSLatitude", "Exif.GPSInfo.GPSLatitudeRef", 'S');
    longitude = ExifAngle(exif, "Exif.GPSInfo.GPSLongitude", "Exif.GPSInfo.GPSLongitudeRef", 'W');
  }
  no_fix = no_fix || IsNoFix(latitude, longitude);
  if (!latitude || !longitude || !IsPlausible(*latitude, *longitude)) {
    if (no_fix) tags.zero_tags.emplace_back("GPSLatitude and GPSLongitude");
    return std::nullopt;
  }
  auto altitude = tags.absolute_altitude_m;
  const auto in_exif = ExifAltitude(exif);
  // Heights near 0 may be rounded in one of the two.
  constexpr double kNearZero_m = 5.0;
  if (!altitude || (*altitude == 0.0 && in_exif && std::abs(*in_exif) > kNearZero_m)) altitude = in_exif;
  return geo::Geodetic{*latitude, geo::WrapLongitudeDeg(*longitude), altitude.value_or(std::numeric_limits<double>::quiet_NaN())};
}

// Drones without RTK write zeros into its tags, which is nothing to note.
void ReadAccuracy(const Exiv2::ExifData& exif, const Exiv2::XmpData& xmp, PhotoTags& tags) {
  const std::optional<double> east = Positive(XmpNumber(xmp, "RtkStdLon"));
  const std::optional<double> north = Positive(XmpNumber(xmp, "RtkStdLat"));
  tags.horizontal_accuracy_m = std::max(east, north);  // nothing counts as less than a number
  if (!tags.horizontal_accuracy_m) tags.horizontal_accuracy_m = Positive(XmpNumber(xmp, "GPSXYAccuracy"));
  if (!tags.horizontal_accuracy_m) tags.horizontal_accuracy_m = Positive(ExifNumber(exif, kGpsHPositioningError));
  tags.vertical_accuracy_m = Positive(XmpNumber(xmp, "RtkStdHgt"));
  if (!tags.vertical_accuracy_m) tags.vertical_accuracy_m = Positive(XmpNumber(xmp, "GPSZAccuracy"));
  tags.dop = Positive(ExifNumber(exif, "Exif.GPSInfo.GPSDOP"));
}

// 0 is a speed: the drone may have hovered.
std::optional<double> ReadSpeed(const Exiv2::ExifData& exif, const Exiv2::XmpData& xmp) {
  const std::optional<double> x_mps = XmpNumber(xmp, "FlightXSpeed");
  const std::optional<double> y_mps = XmpNumber(xmp, "FlightYSpeed");
  if (x_mps && y_mps) return std::hypot(*x_mps, *y_mps);
  const std::optional<double> speed = ExifNumber(exif, "Exif.GPSInfo.GPSSpeed");
  if (!speed || *speed < 0.0) return std::nullopt;
  const std::string unit = ExifText(exif, "Exif.GPSInfo.GPSSpeedRef");
  if (unit == "M") return *speed * 1609.344 / 3600.0;    // miles per hour
  if (unit == "N") return *speed * 1852.0 / 3600.0;      // knots
  if (unit == "K" || unit.empty()) return *speed / 3.6;  // km/h, also where the unit is missing
  return std::nullopt;
}

// Of a file with several bands; cameras of several bands write them into files of one band too.
std::vector<std::string> ReadBandNames(const Exiv2::XmpData& xmp) {
  std::vector<std::string> names;
  for (const Exiv2::Xmpdatum& datum : xmp) {
    if (datum.tagName() != "BandName") continue;
    for (long i = 0; i < static_cast<long>(datum.count()); ++i) names.push_back(datum.toString(i));
    break;
  }
  return names;
}

void ReadOriginalSize(const Exiv2::ExifData& exif, PhotoTags& tags) {
  constexpr double kMost = 100'000.0;
  const std::optional<double> width = Positive(ExifNumber(exif, "Exif.Photo.PixelXDimension"));
  const std::optional<double> height = Positive(ExifNumber(exif, "Exif.Photo.PixelYDimension"));
  if (!width || !height || *width > kMost || *height > kMost) return;
  tags.original_width = static_cast<int>(*width);
  tags.original_height = static_cast<int>(*height);
}

std::optional<PanoramaTags> ReadPanorama(const Exiv2::XmpData& xmp) {
  if (XmpText(xmp, "ProjectionType") != "equirectangular") return std::nullopt;
  PanoramaTags panorama;
  panorama.heading_deg = XmpNumber(xmp, "PoseHeadingDegrees");
  panorama.pitch_deg = XmpNumber(xmp, "PosePitchDegrees");
  panorama.roll_deg = XmpNumber(xmp, "PoseRollDegrees");
  const auto pixels = [&xmp](std::string_view name) {
    constexpr double kMost = 1e6;
    const double value = XmpNumber(xmp, name).value_or(0.0);
    return value > 0.0 && value <= kMost ? static_cast<int>(value) : 0;
  };
  panorama.full_width = pixels("FullPanoWidthPixels");
  panorama.full_height = pixels("FullPanoHeightPixels");
  panorama.left = pixels("CroppedAreaLeftPixels");
  panorama.top = pixels("CroppedAreaTopPixels");
  panorama.area_width = pixels("CroppedAreaImageWidthPixels");
  return panorama;
}

// In APEX 0 is a value (1 s, f/1), but not beside another tag for the same that was left at 0.
std::optional<double> Apex(const Exiv2::ExifData& exif, const char* key, const std::optional<double>& other) {
  const auto apex = ExifNumber(exif, key);
  return apex && *apex == 0.0 && other && *other == 0.0 ? std::nullopt : apex;
}

ExposureSettings ReadExposure(const Exiv2::ExifData& exif, PhotoTags& tags) {
  ExposureSettings exposure;
  const auto time_s = ExifNumber(exif, "Exif.Photo.ExposureTime");
  exposure.time_s = PositiveTag(time_s, "ExposureTime", tags);
  if (!exposure.time_s) {
    if (const auto apex = Apex(exif, "Exif.Photo.ShutterSpeedValue", time_s)) exposure.time_s = Positive(Finite(std::exp2(-*apex)));
  }
  const auto f_number = ExifNumber(exif, "Exif.Photo.FNumber");
  exposure.f_number = PositiveTag(f_number, "FNumber", tags);
  if (!exposure.f_number) {
    if (const auto apex = Apex(exif, "Exif.Photo.ApertureValue", f_number)) exposure.f_number = Positive(Finite(std::exp2(*apex / 2.0)));
  }
  exposure.iso = PositiveTag(ExifNumber(exif, "Exif.Photo.ISOSpeedRatings"), "ISO", tags);
  // 65535 means that the value is in one of the 32-bit tags (EXIF 2.3).
  if (!exposure.iso || *exposure.iso >= 65535.0) {
    for (const char* key : {"Exif.Photo.RecommendedExposureIndex", "Exif.Photo.ISOSpeed", "Exif.Photo.StandardOutputSensitivity"}) {
      if (const auto iso = Positive(ExifNumber(exif, key))) {
        exposure.iso = iso;
        break;
      }
    }
  }
  return exposure;
}

std::optional<double> ReadCaptureTime(const Exiv2::ExifData& exif) {
  const std::pair<const char*, const char*> keys[] = {{"Exif.Photo.DateTimeOriginal", "Exif.Photo.SubSecTimeOriginal"},
                                                      {"Exif.Photo.DateTimeDigitized", "Exif.Photo.SubSecTimeDigitized"},
                                                      {"Exif.Image.DateTime", "Exif.Photo.SubSecTime"}};
  for (const auto& [key, sub_second_key] : keys) {
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
    if (std::sscanf(ExifText(exif, key).c_str(), "%d%*1[:-]%d%*1[:-]%d%*1[ T]%d:%d:%d", &year, &month, &day, &hour, &minute, &second) != 6) continue;
    const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(static_cast<unsigned>(month)),
                                           std::chrono::day(static_cast<unsigned>(day))};
    if (month < 1 || day < 1 || !date.ok() || year < 1900 || hour < 0 || minute < 0 || second < 0) continue;
    double time_s = static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count()) * 86400.0;
    time_s += hour * 3600.0 + minute * 60.0 + second;
    // Digits after the decimal point.
    const std::string digits = ExifText(exif, sub_second_key);
    double place = 0.1;
    for (const char digit : digits) {
      if (digit < '0' || digit > '9') break;
      time_s += place * (digit - '0');
      place *= 0.1;
    }
    return time_s;
  }
  return std::nullopt;
}

std::optional<double> ReadMakerNoteSpeed(const Exiv2::ExifData& exif, Exiv2::ByteOrder byte_order) {
  const auto found = exif.findKey(Exiv2::ExifKey("Exif.Photo.MakerNote"));
  if (found == exif.end() || found->size() <= 0) return std::nullopt;
  std::vector<uint8_t> note(static_cast<size_t>(found->size()));
  found->copy(note.data(), byte_order);
  return DjiMakerNoteSpeed(note, byte_order == Exiv2::littleEndian);
}

}  // namespace

PhotoTags ReadPhotoTags(const std::filesystem::path& file) {
  const auto lock = LockExiv2();
  try {
    const auto image = Exiv2::ImageFactory::open(file.string());
    image->readMetadata();
    Exiv2::ExifData& exif = image->exifData();
    if (exif.empty()) {
      // Exiv2 does not find that of every writer of HEIC.
      const std::string block = image::ExifOfHeif(file);
      if (!block.empty()) Exiv2::ExifParser::decode(exif, reinterpret_cast<const Exiv2::byte*>(block.data()), static_cast<uint32_t>(block.size()));
    }
    const Exiv2::XmpData& xmp = image->xmpData();
    PhotoTags tags;
    tags.relative_altitude_m = XmpNumber(xmp, "RelativeAltitude");
    tags.absolute_altitude_m = XmpNumber(xmp, "AbsoluteAltitude");
    tags.gps = ReadPosition(exif, xmp, tags);
    constexpr double kRtkFixed = 50.0;
    tags.rtk = XmpNumber(xmp, "RtkFlag").value_or(0.0) == kRtkFixed;
    ReadAccuracy(exif, xmp, tags);
    tags.speed_mps = ReadSpeed(exif, xmp);
    tags.gimbal_yaw_deg = XmpNumber(xmp, "GimbalYawDegree");
    tags.gimbal_pitch_deg = XmpNumber(xmp, "GimbalPitchDegree");
    tags.gimbal_roll_deg = XmpNumber(xmp, "GimbalRollDegree");
    tags.exposure = ReadExposure(exif, tags);
    tags.focal_length_mm = PositiveTag(ExifNumber(exif, "Exif.Photo.FocalLength"), "FocalLength", tags);
    tags.focal_length_35mm = PositiveTag(ExifNumber(exif, "Exif.Photo.FocalLengthIn35mmFilm"), "FocalLengthIn35mmFilm", tags);
    if (tags.focal_length_35mm && !IsPlausibleFocal35(*tags.focal_length_35mm)) tags.focal_length_35mm.reset();
    tags.calibrated_focal_px = Positive(XmpNumber(xmp, "CalibratedFocalLength"));
    tags.band_names = ReadBandNames(xmp);
    ReadOriginalSize(exif, tags);
    tags.panorama = ReadPanorama(xmp);
    const double orientation = ExifNumber(exif, "Exif.Image.Orientation").value_or(1.0);
    if (IsOrientation(orientation)) tags.orientation = static_cast<int>(orientation);
    tags.capture_time_s = ReadCaptureTime(exif);
    tags.make = ExifText(exif, "Exif.Image.Make");
    tags.model = ExifText(exif, "Exif.Image.Model");
    if (!tags.speed_mps && tags.make == "DJI") tags.speed_mps = ReadMakerNoteSpeed(exif, image->byteOrder());
    return tags;
  } catch (const Exiv2::AnyError& error) {
    throw base::InputError(file, std::string("is not an image that can be read (") + error.what() + ")",
                           "Copy the photo again or remove it from the folder");
  }
}

}  // namespace skyquilt::survey
