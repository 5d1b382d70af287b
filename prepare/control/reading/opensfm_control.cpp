#include "prepare/control/reading/opensfm_control.h"

#include <map>

#include "core/base/json_document.h"

namespace skyquilt::prepare::control {
namespace {

using base::JsonDocument;
using base::JsonValue;

constexpr const char* kObservationsFix = "Write the file with OpenSfM's annotation tool again, or give the points as gcp_list.txt";

}  // namespace

RawControl ReadOpensfmControl(const std::filesystem::path& file) {
  const JsonDocument document(file, kObservationsFix);
  RawControl control;
  control.file = file;
  control.format = "OpenSfM's ground_control_points.json";
  control.crs = "EPSG:4979";
  const JsonValue points = document.Root().At("points");
  std::map<std::string, int> line_of;
  for (size_t i = 0; i < points.Size(); ++i) {
    const JsonValue entry = points.At(i);
    RawPoint point;
    point.label = entry.At("id").Text();
    point.line = entry.LineNumber();
    const auto [first, is_new] = line_of.emplace(point.label, point.line);
    if (!is_new) {
      entry.Fail("has the id " + point.label + ", as the point on line " + std::to_string(first->second), "Give every point an id of its own");
    }
    // Points without a position tie photos together, but tell nothing about their place.
    const std::optional<JsonValue> position = entry.Find("position");
    if (!position) continue;
    const std::optional<JsonValue> altitude = position->Find("altitude");
    point.given = {position->At("longitude").Number(), position->At("latitude").Number(),
                   altitude ? altitude->Number() : std::numeric_limits<double>::quiet_NaN()};
    const JsonValue observations = entry.At("observations");
    for (size_t j = 0; j < observations.Size(); ++j) {
      const JsonValue observation = observations.At(j);
      RawMark mark;
      mark.label = point.label;
      mark.line = observation.LineNumber();
      mark.photo = observation.At("shot_id").Text();
      const std::vector<double> projection = observation.At("projection").Numbers(2);
      mark.pixel = {projection[0], projection[1]};
      mark.origin = PixelOrigin::kMiddle;
      control.marks.push_back(std::move(mark));
    }
    control.points.push_back(std::move(point));
  }
  if (control.points.empty()) points.Fail("has no point with a position");
  return control;
}

}  // namespace skyquilt::prepare::control
