#include "prepare/video/gpx.h"

#include <cmath>
#include <pugixml.hpp>
#include <string_view>

#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::prepare::video {
namespace {

constexpr const char* kGpxFix = "Export the track as GPX again, or remove the file to go on without it";

// Without the prefix of its namespace.
std::string_view LocalName(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  return name.substr(name.find(':') + 1);
}

std::optional<double> Number(const char* text) {
  size_t length = 0;
  const std::string_view view = text;
  const std::optional<double> number = LeadingNumber(view, &length);
  return number && view.find_first_not_of(" \t\r\n", length) == std::string_view::npos ? number : std::nullopt;
}

void AddPoint(const pugi::xml_node& node, FlightTrack& track) {
  TrackPoint point;
  std::optional<double> time_s;
  for (const pugi::xml_node& child : node.children()) {
    if (LocalName(child) == "time") time_s = FindClock(child.text().get());
    if (LocalName(child) == "ele") point.altitude_m = Number(child.text().get());
  }
  const std::optional<double> latitude = Number(node.attribute("lat").value()), longitude = Number(node.attribute("lon").value());
  if (!time_s || !latitude || !longitude) return;
  SetPosition(*latitude, *longitude, point);
  if (!point.latitude_deg) return;
  if (point.altitude_m && std::abs(*point.altitude_m) > 20'000.0) point.altitude_m.reset();
  point.time_s = *time_s;
  point.clock_s = *time_s;
  track.points.push_back(point);
}

}  // namespace

FlightTrack ReadGpx(const std::filesystem::path& file) {
  const std::string text = base::ReadFile(file);
  pugi::xml_document document;
  const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size());
  if (!result) throw base::InputError(file, std::string("is not XML (") + result.description() + ")", kGpxFix);
  const pugi::xml_node root = document.document_element();
  if (LocalName(root) != "gpx") throw base::InputError(file, "is not GPX: its first element is not <gpx>", kGpxFix);
  FlightTrack track{.file = file, .form = "GPX", .by_clock = true};
  for (const pugi::xml_node& part : root.children()) {
    if (LocalName(part) != "trk") continue;
    for (const pugi::xml_node& segment : part.children()) {
      if (LocalName(segment) != "trkseg") continue;
      for (const pugi::xml_node& point : segment.children()) {
        if (LocalName(point) == "trkpt") AddPoint(point, track);
      }
    }
  }
  TidyPoints(track.points);
  return track;
}

}  // namespace skyquilt::prepare::video
