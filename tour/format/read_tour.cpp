#include "tour/format/read_tour.h"

#include <array>
#include <cmath>
#include <utility>

#include "tour/format/asset_name.h"
#include "tour/format/read_parts.h"

namespace skyquilt::tour {
namespace {

using Json = nlohmann::json;

constexpr size_t kMaxLabelCharacters = 200;
constexpr size_t kMaxKindCharacters = 40;
constexpr size_t kMaxMeasurements = 100;
constexpr double kMaxPauseS = 600.0;
constexpr std::array kLayers = {"surface", "exact",    "buildings", "blocks",       "cameras",
                                "points",  "contours", "errorMap",  "measurements", "controlPoints"};

std::string At(const std::string& list, size_t i) {
  return list + "[" + std::to_string(i) + "]";
}

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

// Calls read(member, path) for all members of a list.
template <typename Read>
void ReadEach(const Json* list, const std::string& path, Reading* reading, const Read& read) {
  for (size_t i = 0; list != nullptr && i < list->size(); ++i) {
    Attempt(At(path, i), reading, [&] { read((*list)[i], At(path, i)); });
  }
}

Path ReadPath(Fields* owner) {
  Path path;
  const Json* json = owner->Find("path");
  if (json == nullptr && owner->reading().other_version) return path;
  if (json == nullptr) owner->Refuse("path", "is missing");
  Fields fields(*json, owner->Path("path"), &owner->reading());
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
  const Json* json = owner->FindUnlessNull("link");
  if (json == nullptr) return {};
  Fields fields(*json, owner->Path("link"), &owner->reading());
  Link link{.label = fields.Line("label", kMaxLabelCharacters), .url = fields.Line("url", kMaxUrlCharacters)};
  if (!IsUrl(link.url)) fields.Refuse("url", "must be an address that begins with https:// or http://, without spaces");
  fields.End();
  return link;
}

Pose ReadPose(Fields* owner) {
  const Json* json = owner->Find("pose");
  if (json == nullptr) owner->Refuse("pose", "is missing");
  Fields fields(*json, owner->Path("pose"), &owner->reading());
  Pose pose;
  pose.eye_enu = fields.Position("eye_enu");
  const Json* rotation = fields.List("rotation", 4);
  std::array<double, 4> wxyz = {};
  bool good = rotation != nullptr && rotation->size() == wxyz.size();
  for (size_t i = 0; good && i < wxyz.size(); ++i) {
    good = (*rotation)[i].is_number();
    if (good) wxyz[i] = (*rotation)[i].get<double>();
  }
  pose.cam_from_enu = Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  if (!good || !(std::abs(pose.cam_from_enu.norm() - 1.0) <= 1e-6)) fields.Refuse("rotation", "must be a quaternion w, x, y, z of norm 1");
  pose.fovy_deg = fields.Number("fovy_deg", 10.0, 120.0);
  fields.End();
  return pose;
}

std::optional<std::map<std::string, bool>> ReadLayers(Fields* owner) {
  const Json* json = owner->FindUnlessNull("layers");
  if (json == nullptr) return {};
  Fields fields(*json, owner->Path("layers"), &owner->reading());
  std::map<std::string, bool> layers;
  for (const char* layer : kLayers) {
    if (json->contains(layer)) layers[layer] = fields.Flag(layer);
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
  const Json* json = owner->FindUnlessNull("next");
  if (json == nullptr) return {};
  Fields fields(*json, owner->Path("next"), &owner->reading());
  Next next;
  next.to = fields.OptionalId("to");
  next.path = ReadPath(&fields);
  fields.End();
  return next;
}

Stop ReadStop(const Json& json, const std::string& path, Reading* reading) {
  Fields fields(json, path, reading);
  const auto attempt = [&](const char* key, const auto& read) { Attempt(fields.Path(key), reading, read); };
  Stop stop;
  stop.id = fields.Id("id");
  stop.pose = ReadPose(&fields);
  attempt("title", [&] { stop.title = fields.Line("title", kMaxTitleCharacters); });
  if (stop.title.empty()) stop.title = stop.id;
  attempt("text", [&] { stop.text = fields.Text("text", kMaxTextCharacters); });
  attempt("picture", [&] {
    if (fields.FindUnlessNull("picture") != nullptr) stop.picture = ReadAsset(&fields, "picture", false);
  });
  attempt("link", [&] { stop.link = ReadLink(&fields); });
  attempt("exposure_stops", [&] {
    if (fields.FindUnlessNull("exposure_stops") != nullptr) stop.exposure_stops = fields.Number("exposure_stops", -10.0, 10.0);
  });
  attempt("layers", [&] { stop.layers = ReadLayers(&fields); });
  attempt("measurements", [&] { stop.measurements = fields.Lines("measurements", kMaxMeasurements); });
  attempt("pause_s", [&] { stop.pause_s = fields.NumberOrZero("pause_s", kMaxPauseS); });
  attempt("next", [&] { stop.next = ReadNext(&fields); });
  ReadEach(fields.List("branches", kMaxBranches), fields.Path("branches"), reading, [&](const Json& member, const std::string& where) {
    Fields branch(member, where, reading);
    stop.branches.push_back({.to = branch.Id("to"), .label = branch.Line("label", kMaxLabelCharacters), .path = ReadPath(&branch)});
    branch.End();
  });
  fields.End();
  return stop;
}

// Nothing for a kind that is not known, unless reading strictly.
std::optional<Thing> ReadThing(const Json& json, const std::string& path, Reading* reading) {
  Fields fields(json, path, reading);
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
    reading->missing.push_back(path + " \"" + thing.id + "\" is of the unknown kind \"" + kind + "\" and is left out.");
    return {};
  }
  thing.at = fields.Position("at");
  if (fields.FindUnlessNull("stops") != nullptr) thing.stops = fields.Ids("stops", kMaxStops);
  fields.End();
  return thing;
}

std::map<std::string, AssetEntry> ReadAssets(Fields* owner) {
  std::map<std::string, AssetEntry> assets;
  const Json* json = owner->Find("assets");
  if (json == nullptr) return assets;
  if (!json->is_object()) owner->Refuse("assets", "must be an object");
  for (const auto& [name, value] : json->items()) {
    Attempt(owner->Path("assets"), &owner->reading(), [&, &key = name, &described = value] {
      if (!ParseAssetName(key)) owner->Refuse("assets", "may only have names of 64 digits 0-9 a-f with .glb, .png or .jpg");
      Fields fields(described, owner->Path("assets") + "." + key, &owner->reading());
      AssetEntry entry;
      entry.name = fields.Line("name", kMaxLabelCharacters);
      const Json* bytes = fields.Find("bytes");
      if (bytes == nullptr || !bytes->is_number_unsigned() || bytes->get<uint64_t>() == 0) fields.Refuse("bytes", "must be a whole number above 0");
      entry.bytes = bytes->get<uint64_t>();
      fields.End();
      assets[key] = std::move(entry);
    });
  }
  return assets;
}

void ReadVersion(Fields* fields, Reading* reading) {
  const Json* version = fields->Find("version");
  if (version == nullptr) fields->Refuse("version", "is missing");
  if (!version->is_number_unsigned() || version->get<uint64_t>() == 0) fields->Refuse("version", "must be a whole number above 0");
  if (version->get<uint64_t>() == kTourVersion) return;
  const std::string number = std::to_string(version->get<uint64_t>());
  if (reading->strict) fields->Refuse("version", "must be " + std::to_string(kTourVersion) + ", and is " + number);
  reading->other_version = true;
  reading->missing.push_back("This tour has version " + number + " of the format. Version " + std::to_string(kTourVersion) +
                             " is known here: what is not understood is left out.");
}

}  // namespace

Tour ReadMembers(std::string_view text, Reading* reading) {
  if (text.size() > kMaxTourBytes) throw base::Refused("it is longer than 1 MiB: shorten its texts or delete stops");
  const Json json = base::ParseDocument(text);
  Fields fields(json, "", reading);
  ReadVersion(&fields, reading);
  Tour tour;
  Attempt("title", reading, [&] { tour.title = fields.LineOrEmpty("title", kMaxTitleCharacters); });
  Attempt("start", reading, [&] { tour.start = fields.OptionalId("start"); });
  if (fields.Find("stops") == nullptr) fields.Refuse("stops", "is missing");
  ReadEach(fields.List("stops", kMaxStops), "stops", reading,
           [&](const Json& member, const std::string& path) { tour.stops.push_back(ReadStop(member, path, reading)); });
  ReadEach(fields.List("things", kMaxThings), "things", reading, [&](const Json& member, const std::string& path) {
    if (auto thing = ReadThing(member, path, reading)) tour.things.push_back(*std::move(thing));
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
