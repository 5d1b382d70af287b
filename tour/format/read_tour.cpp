#include "tour/format/read_tour.h"

#include <array>
#include <cmath>
#include <utility>

#include "tour/format/asset_name.h"
#include "tour/format/read_parts.h"

namespace skyquilt::tour {
namespace {

constexpr size_t kMaxLabelCharacters = 200;
constexpr size_t kMaxKindCharacters = 40;
constexpr size_t kMaxMeasurements = 100;
constexpr double kMaxPauseS = 600.0;
constexpr std::array kLayers = {"surface", "exact",    "buildings", "blocks",       "cameras",
                                "points",  "contours", "errorMap",  "measurements", "controlPoints"};

// Of another version, what cannot be read is left out.
template <typename Read>
void Attempt(const std::string& path, Reading* reading, const Read& read) {
  try {
    read();
  } catch (const base::Refused& refused) {
    if (!reading->other_version) throw;
    reading->missing.push_back(path + " is left out: " + refused.what() + ".");
  }
}

// Calls read(member) for all members of a list.
template <typename Read>
void ReadEach(const std::vector<base::JsonValue>& list, Reading* reading, const Read& read) {
  for (const base::JsonValue& member : list) {
    Attempt(member.path(), reading, [&] { read(member); });
  }
}

Path ReadPath(Fields* owner) {
  Path path;
  if (!owner->Has("path") && owner->reading().other_version) return path;
  Fields fields(owner->Need("path"), &owner->reading());
  const std::string kind = fields.Line("kind", kMaxKindCharacters);
  if (kind == "direct") {
    path.kind = PathKind::kDirect;
  } else if (kind == "orbit") {
    path.kind = PathKind::kOrbit;
    path.about = fields.Position("about");
  } else if (kind == "over") {
    path.kind = PathKind::kOver;
  } else if (kind == "jump") {
    path.kind = PathKind::kJump;
  } else {
    if (owner->reading().strict) fields.Refuse("kind", "must be direct, orbit, over or jump");
    owner->reading().missing.push_back(fields.Path("kind") + " \"" + kind + "\" is not known: the direct path is taken.");
    return path;
  }
  fields.End();
  return path;
}

bool IsUrl(const std::string& url) {
  for (const std::string_view scheme : {"https://", "http://"}) {
    // Spaces and what browsers take for a slash: an address must be read by all programs alike.
    if (url.starts_with(scheme)) return url.size() > scheme.size() && url[scheme.size()] != '/' && url.find_first_of(" \\\"<>") == std::string::npos;
  }
  return false;
}

std::optional<Link> ReadLink(Fields* owner) {
  const auto value = owner->FindUnlessNull("link");
  if (!value) return {};
  Fields fields(*value, &owner->reading());
  Link link{.label = fields.Line("label", kMaxLabelCharacters), .url = fields.Line("url", kMaxUrlCharacters)};
  if (!IsUrl(link.url)) fields.Refuse("url", "must be an address that begins with https:// or http://, without spaces");
  fields.End();
  return link;
}

Pose ReadPose(Fields* owner) {
  Fields fields(owner->Need("pose"), &owner->reading());
  Pose pose;
  pose.eye_enu = fields.Position("eye_enu");
  const std::vector<base::JsonValue> rotation = fields.List("rotation", 4);
  std::array<double, 4> wxyz = {};
  bool good = rotation.size() == wxyz.size();
  for (size_t i = 0; good && i < wxyz.size(); ++i) {
    good = rotation[i].json().is_number();
    if (good) wxyz[i] = rotation[i].json().get<double>();
  }
  pose.cam_from_enu = Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!good || !(std::abs(pose.cam_from_enu.norm() - 1.0) <= 1e-6)) fields.Refuse("rotation", "must be a quaternion w, x, y, z of norm 1");
  pose.fovy_deg = fields.Number("fovy_deg", 10.0, 120.0);
  fields.End();
  return pose;
}

std::optional<std::map<std::string, bool>> ReadLayers(Fields* owner) {
  const auto value = owner->FindUnlessNull("layers");
  if (!value) return {};
  Fields fields(*value, &owner->reading());
  std::map<std::string, bool> layers;
  for (const char* layer : kLayers) {
    if (fields.Has(layer)) layers[layer] = fields.Flag(layer);
  }
  fields.End();
  return layers;
}

// Name of an asset of one of these types.
std::string ReadAsset(Fields* owner, const char* key, bool glb) {
  const std::string name = owner->Line(key, kMaxLabelCharacters);
  const auto parsed = ParseAssetName(name);
  if (!parsed || (parsed->type == AssetType::kGlb) != glb) {
    owner->Refuse(key, std::string("must be the name of ") + (glb ? "a model (.glb)" : "a picture (.png or .jpg)") + " in assets");
  }
  return name;
}

std::optional<Next> ReadNext(Fields* owner) {
  const auto value = owner->FindUnlessNull("next");
  if (!value) return {};
  Fields fields(*value, &owner->reading());
  Next next;
  next.to = fields.OptionalId("to");
  next.path = ReadPath(&fields);
  fields.End();
  return next;
}

Stop ReadStop(const base::JsonValue& value, Reading* reading) {
  Fields fields(value, reading);
  const auto attempt = [&](const char* key, const auto& read) { Attempt(fields.Path(key), reading, read); };
  Stop stop;
  stop.id = fields.Id("id");
  stop.pose = ReadPose(&fields);
  attempt("title", [&] { stop.title = fields.Line("title", kMaxTitleCharacters); });
  if (stop.title.empty()) stop.title = stop.id;
  attempt("text", [&] { stop.text = fields.Paragraphs("text", kMaxTextCharacters); });
  attempt("picture", [&] {
    if (fields.FindUnlessNull("picture")) stop.picture = ReadAsset(&fields, "picture", false);
  });
  attempt("link", [&] { stop.link = ReadLink(&fields); });
  attempt("exposure_stops", [&] {
    if (fields.FindUnlessNull("exposure_stops")) stop.exposure_stops = fields.Number("exposure_stops", -10.0, 10.0);
  });
  attempt("layers", [&] { stop.layers = ReadLayers(&fields); });
  attempt("measurements", [&] { stop.measurements = fields.Lines("measurements", kMaxMeasurements, kMaxLabelCharacters); });
  attempt("pause_s", [&] { stop.pause_s = fields.NumberOrZero("pause_s", kMaxPauseS); });
  attempt("next", [&] { stop.next = ReadNext(&fields); });
  ReadEach(fields.List("branches", kMaxBranches), reading, [&](const base::JsonValue& member) {
    Fields branch(member, reading);
    stop.branches.push_back({.to = branch.Id("to"), .label = branch.Line("label", kMaxLabelCharacters), .path = ReadPath(&branch)});
    branch.End();
  });
  fields.End();
  return stop;
}

// Nothing for a kind that is not known, unless reading strictly.
std::optional<Thing> ReadThing(const base::JsonValue& value, Reading* reading) {
  Fields fields(value, reading);
  Thing thing;
  thing.id = fields.Id("id");
  const std::string kind = fields.Line("kind", kMaxKindCharacters);
  if (kind == "label") {
    thing.text = fields.Line("text", kMaxLabelCharacters);
  } else if (kind == "marker") {
    thing.kind = ThingKind::kMarker;
    thing.text = fields.Line("text", kMaxLabelCharacters);
    thing.to = fields.OptionalId("to");
  } else if (kind == "model") {
    thing.kind = ThingKind::kModel;
    thing.text = fields.Line("name", kMaxLabelCharacters);
    thing.yaw_deg = fields.Number("yaw_deg", -360.0, 360.0);
    thing.scale = fields.Number("scale", 1e-4, 1e4);
    thing.asset = ReadAsset(&fields, "asset", true);
  } else {
    if (reading->strict) fields.Refuse("kind", "must be label, marker or model");
    reading->missing.push_back(value.path() + " \"" + thing.id + "\" is of the unknown kind \"" + kind + "\" and is left out.");
    return {};
  }
  thing.at = fields.Position("at");
  if (fields.FindUnlessNull("stops")) thing.stops = fields.Ids("stops", kMaxStops);
  fields.End();
  return thing;
}

std::map<std::string, AssetEntry> ReadAssets(Fields* owner) {
  std::map<std::string, AssetEntry> assets;
  const auto list = owner->Find("assets");
  if (!list) return assets;
  if (!list->IsObject()) list->Fail("must be an object");
  for (const auto& [name, value] : list->Members()) {
    Attempt(list->path(), &owner->reading(), [&, &key = name, &described = value] {
      if (!ParseAssetName(key)) owner->Refuse("assets", "may only have names of 64 digits 0-9 a-f with .glb, .png or .jpg");
      Fields fields(described, &owner->reading());
      AssetEntry entry;
      entry.name = fields.Line("name", kMaxLabelCharacters);
      entry.bytes = fields.Count("bytes");
      fields.End();
      assets[key] = std::move(entry);
    });
  }
  return assets;
}

void ReadVersion(Fields* fields, Reading* reading) {
  const uint64_t version = fields->Count("version");
  if (version == kTourVersion) return;
  const std::string number = std::to_string(version);
  if (reading->strict) fields->Refuse("version", "must be " + std::to_string(kTourVersion) + ", and is " + number);
  reading->other_version = true;
  reading->missing.push_back("This tour has version " + number + " of the format. Version " + std::to_string(kTourVersion) +
                             " is known here: what is not understood is left out.");
}

}  // namespace

Tour ReadMembers(std::string_view text, Reading* reading) {
  if (text.size() > kMaxTourBytes) throw base::Refused("it is longer than 1 MiB: shorten its texts or delete stops");
  const nlohmann::json json = base::ParseDocument(text);
  Fields fields(base::JsonValue(json), reading);
  ReadVersion(&fields, reading);
  Tour tour;
  Attempt("title", reading, [&] { tour.title = fields.LineOrEmpty("title", kMaxTitleCharacters); });
  Attempt("start", reading, [&] { tour.start = fields.OptionalId("start"); });
  fields.Need("stops");
  ReadEach(fields.List("stops", kMaxStops), reading, [&](const base::JsonValue& member) { tour.stops.push_back(ReadStop(member, reading)); });
  ReadEach(fields.List("things", kMaxThings), reading, [&](const base::JsonValue& member) {
    if (auto thing = ReadThing(member, reading)) tour.things.push_back(*std::move(thing));
  });
  tour.assets = ReadAssets(&fields);
  fields.End();
  return tour;
}

Tour ParseTour(std::string_view text) {
  Reading reading{.strict = true};
  Tour tour = ReadMembers(text, &reading);
  CheckReferences(tour);
  return tour;
}

}  // namespace skyquilt::tour
