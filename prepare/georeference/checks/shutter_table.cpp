#include "prepare/georeference/checks/shutter_table.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>

#include "core/base/text.h"

namespace skyquilt::prepare::georeference {
namespace {

constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

struct Shutter {
  const char* camera;         // lower case, without spaces
  double readout_ms;          // electronic shutter, picture of the sensor's own shape; NaN: not measured
  double wide_readout_ms;     // for pictures of 16:9 or wider, which leave out rows; the same where no other time was measured
  double mechanical_above_s;  // exposures of at least this time use a mechanical (or the sensor a global) shutter; infinity: never
};

constexpr double kNever = std::numeric_limits<double>::infinity();

constexpr Shutter Rolling(const char* camera, double readout_ms) {
  return {camera, readout_ms, readout_ms, kNever};
}
constexpr Shutter RollingWide(const char* camera, double readout_ms, double wide_readout_ms) {
  return {camera, readout_ms, wide_readout_ms, kNever};
}
constexpr Shutter Mechanical(const char* camera, double electronic_readout_ms) {
  return {camera, electronic_readout_ms, electronic_readout_ms, 1.0 / 2000.0};
}

// Read-out times were measured by OpenDroneMap's users with a blinking light (OpenDroneMap, opendm/rollingshutter.py and RSCalibration). Cameras
// whose time depends on more than the picture's shape are left out. Mechanical shutters: DJI's specifications; all of these change to the electronic
// shutter for exposures shorter than 1/2000 s.
constexpr std::array kShutters = {
    Rolling("djiphantomvisionfc200", 74.0),          // Phantom 2 Vision
    Rolling("djifc300s", 33.0),                      // Phantom 3 Advanced
    Rolling("djifc300c", 33.0),                      // Phantom 3 Standard
    Rolling("djifc300x", 33.0),                      // Phantom 3 Professional
    Rolling("djifc330", 33.0),                       // Phantom 4
    Rolling("djifc350", 30.0),                       // Inspire 1
    Rolling("djifc220", 64.0),                       // Mavic Pro
    Rolling("djifc2103", 32.0),                      // Mavic Air
    Rolling("djifc3170", 27.0),                      // Mavic Air 2
    Rolling("djifc3411", 32.0),                      // Air 2S
    Rolling("djifc3682", 23.0),                      // Mini 3
    RollingWide("djifc7203", 25.0, 19.0),            // Mavic Mini
    RollingWide("hasselbladl1d-20c", 56.0, 47.0),    // Mavic 2 Pro
    Rolling("hasselbladl2d-20c", 16.6),              // Mavic 3
    Rolling("djimavic2-enterprise-advanced", 31.0),  // its colour camera
    Rolling("djizenmusez30", 8.0),
    Rolling("yuneece90", 44.0),
    Rolling("autelroboticsxt701", 25.0),  // EVO II 8k
    Rolling("autelroboticsxt705", 30.0),  // EVO II Pro
    Rolling("autelroboticsxl724", 29.0),  // EVO Nano+
    Rolling("parrotanafi", 39.0),
    Rolling("goprohero4black", 30.0),
    Rolling("goprohero8black", 17.0),
    Mechanical("djifc6310", 33.0),           // Phantom 4 Pro
    Mechanical("djifc6310s", kNotMeasured),  // Phantom 4 Pro V2
    Mechanical("djifc6310r", kNotMeasured),  // Phantom 4 RTK
    Mechanical("djim3e", kNotMeasured),      // Mavic 3 Enterprise
    Mechanical("djizenmusep1", kNotMeasured),
};

constexpr double kWide = 1.7;  // of width over height; 16:9 is 1.78, 3:2 is 1.5

std::string Trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

double SensorReadout(const ShutterQuery& query) {
  std::string key = base::LowerCase(query.camera_name);
  std::erase_if(key, [](unsigned char c) { return std::isspace(c) != 0; });
  const auto* found = std::find_if(kShutters.begin(), kShutters.end(), [&](const Shutter& shutter) { return key == shutter.camera; });
  if (found == kShutters.end()) return kNotMeasured;
  // Half a per mille of tolerance: tags round exposure times.
  const bool is_long = !query.exposure_s || *query.exposure_s >= 0.9995 * found->mechanical_above_s;
  if (is_long && found->mechanical_above_s != kNever) return 0.0;
  // The sensor's rows are along the longer side, however the picture was turned.
  const double width = std::max(query.width, query.height);
  const double height = std::min(query.width, query.height);
  return width > kWide * height ? found->wide_readout_ms : found->readout_ms;
}

std::string CameraName(const std::string& make, const std::string& model) {
  const std::string brand = Trimmed(make);
  std::string type = Trimmed(model);
  if (brand.empty() || base::LowerCase(type).starts_with(base::LowerCase(brand))) return type;
  return type.empty() ? brand : brand + " " + type;
}

}  // namespace skyquilt::prepare::georeference
