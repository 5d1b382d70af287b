#include "prepare/control/reading/metashape_markers.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <pugixml.hpp>
#include <string_view>

#include "core/base/json_document.h"
#include "prepare/tables/text_table.h"

namespace skyquilt::prepare::control {
namespace {

constexpr const char* kMarkersFix = "Export the markers of Metashape again (File > Export > Export Markers, Agisoft XML)";
constexpr int kMaxNesting = 64;  // of groups

struct MarkedPhoto {
  std::string label;
  Eigen::Vector2i size = Eigen::Vector2i::Zero();
};

class MarkerFile {
 public:
  MarkerFile(const std::filesystem::path& file, const std::string& text) : file_(file), text_(text) {}

  RawControl Read() {
    const pugi::xml_parse_result result = document_.load_buffer(text_.data(), text_.size());
    if (!result) tables::FailTableLine(file_, LineAt(result.offset), std::string("is not XML (") + result.description() + ")", kMarkersFix);
    const pugi::xml_node chunk = document_.child("document").child("chunk");
    if (!chunk) tables::FailTableLine(file_, 1, "has no <document> with a <chunk>, as Metashape's XML has", kMarkersFix);
    RawControl control;
    control.file = file_;
    control.format = "Metashape's markers";
    ReadCameras(chunk);
    ReadPoints(chunk, control);
    for (const pugi::xml_node& frame : chunk.child("frames").children("frame")) ReadMarks(frame.child("markers"), control);
    // Older versions have them in the chunk itself.
    if (!chunk.child("frames")) ReadMarks(chunk.child("markers"), control);
    if (const pugi::xml_node reference = chunk.child("reference")) {
      control.crs = reference.child_value();
      control.crs_line = LineAt(reference.offset_debug());
    }
    return control;
  }

 private:
  int LineAt(std::ptrdiff_t offset) const {
    return static_cast<int>(base::LineOf(text_, std::min(static_cast<size_t>(std::max<std::ptrdiff_t>(offset, 0)), text_.size())));
  }
  [[noreturn]] void Fail(const pugi::xml_node& node, const std::string& found, const std::string& fix = kMarkersFix) const {
    tables::FailTableLine(file_, LineAt(node.offset_debug()), std::string("<") + node.name() + "> " + found, fix);
  }
  std::string Attribute(const pugi::xml_node& node, const char* name) const {
    const std::string value = node.attribute(name).value();
    if (value.empty() || value.size() > 4096) Fail(node, std::string("has no ") + name);
    return value;
  }
  double Number(const pugi::xml_node& node, const char* name) const {
    const std::string text = Attribute(node, name);
    const std::optional<double> value = tables::ParseTableNumber(text, false);
    if (!value) Fail(node, std::string("has ") + name + " '" + text.substr(0, 60) + "', which is not a number");
    return *value;
  }
  std::optional<double> Sigma(const pugi::xml_node& node, const char* name) const {
    if (!node.attribute(name)) return std::nullopt;
    const double value = Number(node, name);
    if (value < 0.0) Fail(node, std::string("has a negative ") + name);
    return value > 0.0 ? std::optional(value) : std::nullopt;
  }
  int Pixels(const pugi::xml_node& node, const char* name) const {
    const double value = Number(node, name);
    if (!(value >= 1.0 && value <= 1e6) || value != std::floor(value)) Fail(node, std::string("has a ") + name + " that is not a number of pixels");
    return static_cast<int>(value);
  }
  static bool IsFalse(const pugi::xml_attribute& attribute) {
    const std::string_view value = attribute.value();
    return value == "false" || value == "0";
  }

  // Groups hold cameras and markers too.
  template <typename Use>
  static void ForEach(const pugi::xml_node& parent, const char* name, int depth, const Use& use) {
    for (const pugi::xml_node& child : parent.children()) {
      if (std::string_view(child.name()) == name) use(child);
      if (std::string_view(child.name()) == "group" && depth < kMaxNesting) ForEach(child, name, depth + 1, use);
    }
  }

  void ReadCameras(const pugi::xml_node& chunk) {
    std::map<std::string, Eigen::Vector2i> size_of_sensor;
    for (const pugi::xml_node& sensor : chunk.child("sensors").children("sensor")) {
      const pugi::xml_node resolution = sensor.child("resolution");
      if (resolution) size_of_sensor[sensor.attribute("id").value()] = {Pixels(resolution, "width"), Pixels(resolution, "height")};
    }
    ForEach(chunk.child("cameras"), "camera", 0, [&](const pugi::xml_node& camera) {
      MarkedPhoto photo{Attribute(camera, "label")};
      const auto size = size_of_sensor.find(camera.attribute("sensor_id").value());
      if (size != size_of_sensor.end()) photo.size = size->second;
      if (!cameras_.emplace(Attribute(camera, "id"), photo).second) Fail(camera, "has an id that another one has too");
    });
  }

  void ReadPoints(const pugi::xml_node& chunk, RawControl& control) {
    std::map<std::string, int> line_of;
    ForEach(chunk.child("markers"), "marker", 0, [&](const pugi::xml_node& marker) {
      // In old files the marks stand here, by number alone.
      if (!marker.attribute("label")) return;
      RawPoint point;
      point.label = Attribute(marker, "label");
      point.line = LineAt(marker.offset_debug());
      if (!labels_.emplace(Attribute(marker, "id"), point.label).second) Fail(marker, "has an id that another one has too");
      const auto [first, is_new] = line_of.emplace(point.label, point.line);
      if (!is_new) {
        Fail(marker, "has the label " + point.label + ", as the one on line " + std::to_string(first->second),
             "Give every marker a label of its own");
      }
      const pugi::xml_node reference = marker.child("reference");
      if (!reference.attribute("x") || !reference.attribute("y")) return;
      point.given = {Number(reference, "x"), Number(reference, "y"),
                     reference.attribute("z") ? Number(reference, "z") : std::numeric_limits<double>::quiet_NaN()};
      point.check = IsFalse(reference.attribute("enabled"));
      point.horizontal_sigma_m = point.vertical_sigma_m = Sigma(reference, "sxyz");
      for (const char* name : {"sxy", "sx", "sy"}) {
        const std::optional<double> sigma = Sigma(reference, name);
        if (sigma) point.horizontal_sigma_m = std::string_view(name) == "sy" ? std::max(*sigma, point.horizontal_sigma_m.value_or(0.0)) : *sigma;
      }
      if (const std::optional<double> sigma = Sigma(reference, "sz")) point.vertical_sigma_m = sigma;
      control.points.push_back(std::move(point));
    });
  }

  void ReadMarks(const pugi::xml_node& markers, RawControl& control) const {
    ForEach(markers, "marker", 0, [&](const pugi::xml_node& marker) {
      const std::string id = marker.attribute("marker_id") ? Attribute(marker, "marker_id") : Attribute(marker, "id");
      for (const pugi::xml_node& location : marker.children("location")) {
        if (IsFalse(location.attribute("pinned"))) continue;
        const auto label = labels_.find(id);
        if (label == labels_.end()) Fail(marker, "has the number " + id + ", but there is no such marker");
        const auto camera = cameras_.find(Attribute(location, "camera_id"));
        if (camera == cameras_.end()) Fail(location, "is in camera " + Attribute(location, "camera_id") + ", but there is no such <camera>");
        RawMark mark;
        mark.label = label->second;
        mark.photo = camera->second.label;
        mark.photo_size = camera->second.size;
        mark.pixel = {Number(location, "x"), Number(location, "y")};
        mark.line = LineAt(location.offset_debug());
        control.marks.push_back(std::move(mark));
      }
    });
  }

  std::filesystem::path file_;
  const std::string& text_;
  pugi::xml_document document_;
  std::map<std::string, MarkedPhoto> cameras_;
  std::map<std::string, std::string> labels_;
};

}  // namespace

RawControl ReadMetashapeMarkers(const std::filesystem::path& file, const std::string& text) {
  return MarkerFile(file, text).Read();
}

}  // namespace skyquilt::prepare::control
