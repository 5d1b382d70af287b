#include "tour/format/write_tour.h"

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"

namespace skyquilt::tour {
namespace {

using Ordered = nlohmann::ordered_json;

template <typename Value>
Ordered OrNull(const std::optional<Value>& value) {
  return value ? Ordered(*value) : Ordered(nullptr);
}

Ordered ListOf(const Eigen::Vector3d& point) {
  return {point.x(), point.y(), point.z()};
}

Ordered JsonOf(const Path& path) {
  switch (path.kind) {
    case PathKind::kDirect:
      return {{"kind", "direct"}};
    case PathKind::kOrbit:
      return {{"kind", "orbit"}, {"about", ListOf(path.about)}};
    case PathKind::kOver:
      return {{"kind", "over"}};
    case PathKind::kJump:
      break;
  }
  return {{"kind", "jump"}};
}

Ordered JsonOf(const Pose& pose) {
  const Eigen::Quaterniond& q = pose.cam_from_enu;
  return {{"eye_enu", ListOf(pose.eye_enu)}, {"rotation", {q.w(), q.x(), q.y(), q.z()}}, {"fovy_deg", pose.fovy_deg}};
}

Ordered JsonOf(const Stop& stop) {
  Ordered json = {{"id", stop.id}, {"title", stop.title}, {"text", stop.text}, {"picture", OrNull(stop.picture)}};
  json["link"] = stop.link ? Ordered{{"label", stop.link->label}, {"url", stop.link->url}} : Ordered(nullptr);
  json["pose"] = JsonOf(stop.pose);
  json["exposure_stops"] = OrNull(stop.exposure_stops);
  json["layers"] = nullptr;
  if (stop.layers) {
    json["layers"] = Ordered::object();
    for (const auto& [layer, shown] : *stop.layers) json["layers"][layer] = shown;
  }
  json["measurements"] = stop.measurements;
  json["pause_s"] = stop.pause_s;
  json["next"] = stop.next ? Ordered{{"to", OrNull(stop.next->to)}, {"path", JsonOf(stop.next->path)}} : Ordered(nullptr);
  json["branches"] = Ordered::array();
  for (const Branch& branch : stop.branches) {
    json["branches"].push_back(Ordered{{"to", branch.to}, {"label", branch.label}, {"path", JsonOf(branch.path)}});
  }
  return json;
}

Ordered JsonOf(const Thing& thing) {
  Ordered json = {{"id", thing.id}};
  switch (thing.kind) {
    case ThingKind::kLabel:
      json["kind"] = "label";
      json["at"] = ListOf(thing.at);
      json["text"] = thing.text;
      break;
    case ThingKind::kMarker:
      json["kind"] = "marker";
      json["at"] = ListOf(thing.at);
      json["text"] = thing.text;
      json["to"] = OrNull(thing.to);
      break;
    case ThingKind::kModel:
      json["kind"] = "model";
      json["at"] = ListOf(thing.at);
      json["yaw_deg"] = thing.yaw_deg;
      json["scale"] = thing.scale;
      json["name"] = thing.text;
      json["asset"] = thing.asset;
      break;
  }
  json["stops"] = OrNull(thing.stops);
  return json;
}

}  // namespace

std::string FormatTour(const Tour& tour) {
  Ordered json = {{"version", kTourVersion}, {"title", tour.title}, {"start", OrNull(tour.start)}};
  json["stops"] = Ordered::array();
  for (const Stop& stop : tour.stops) json["stops"].push_back(JsonOf(stop));
  json["things"] = Ordered::array();
  for (const Thing& thing : tour.things) json["things"].push_back(JsonOf(thing));
  json["assets"] = Ordered::object();
  for (const auto& [name, entry] : tour.assets) json["assets"][name] = {{"name", entry.name}, {"bytes", entry.bytes}};
  std::string text = base::JsonText(json, 1) + "\n";
  if (text.size() > kMaxTourBytes) text = base::JsonText(json) + "\n";
  return text;
}

}  // namespace skyquilt::tour
