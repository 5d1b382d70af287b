#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "buildings/files/buildings_format.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"

namespace skyquilt::buildings {
namespace {

constexpr const char* kRunAgain = "Run 'skyquilt buildings' with --restart";
constexpr int64_t kLargestInt = std::numeric_limits<int>::max();
constexpr int64_t kLargestCount = std::numeric_limits<int64_t>::max();

// What a reader throws; the caller knows the file.
class DamagedJson : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A value of a JSON file with its place in it, so that messages can name what is wrong: "buildings[3].shape.u is no list".
// Refers to the document, which must outlive it.
class JsonReader {
 public:
  JsonReader(const nlohmann::json& value, std::string place) : value_(value), place_(std::move(place)) {}

  [[noreturn]] void Refuse(const std::string& finding) const { throw DamagedJson((place_.empty() ? "the file" : place_) + " " + finding); }

  JsonReader At(const std::string& key) const {
    const std::string place = place_.empty() ? key : place_ + "." + key;
    const auto found = value_.is_object() ? value_.find(key) : value_.end();
    if (!value_.is_object() || found == value_.end()) throw DamagedJson(place + " is missing");
    return {*found, place};
  }
  std::vector<JsonReader> Items() const {
    if (!value_.is_array()) Refuse("is no list");
    std::vector<JsonReader> items;
    items.reserve(value_.size());
    for (size_t i = 0; i < value_.size(); ++i) items.emplace_back(value_[i], place_ + "[" + std::to_string(i) + "]");
    return items;
  }
  std::vector<JsonReader> Items(size_t count) const {
    std::vector<JsonReader> items = Items();
    if (items.size() != count) Refuse("has " + std::to_string(items.size()) + " values instead of " + std::to_string(count));
    return items;
  }

  // nlohmann's parser refuses numbers beyond the range of double, so every number is finite.
  double Number() const {
    if (!value_.is_number()) Refuse("is no number");
    return value_.get<double>();
  }
  double NumberOrNan() const { return value_.is_null() ? std::numeric_limits<double>::quiet_NaN() : Number(); }
  int64_t Whole(int64_t min, int64_t max) const {
    if (!value_.is_number_integer()) Refuse("is no whole number");
    if (value_.is_number_unsigned() && value_.get<uint64_t>() > static_cast<uint64_t>(std::numeric_limits<int64_t>::max())) Refuse("is out of range");
    const auto whole = value_.get<int64_t>();
    if (whole < min || whole > max) Refuse("is out of range");
    return whole;
  }
  bool Flag() const {
    if (!value_.is_boolean()) Refuse("is neither true nor false");
    return value_.get<bool>();
  }
  std::string Text() const {
    if (!value_.is_string()) Refuse("is no text");
    return value_.get<std::string>();
  }

 private:
  const nlohmann::json& value_;
  std::string place_;
};

RoofKind ReadRoof(const JsonReader& reader) {
  try {
    return RoofNamed(reader.Text());
  } catch (const base::UsageError&) {
    reader.Refuse("is no kind of roof");
  }
}

std::vector<double> ReadNumbers(const JsonReader& reader) {
  std::vector<double> numbers;
  for (const JsonReader& item : reader.Items()) numbers.push_back(item.Number());
  return numbers;
}

Eigen::Vector2d ReadPoint(const JsonReader& reader) {
  const std::vector<JsonReader> items = reader.Items(2);
  return {items[0].Number(), items[1].Number()};
}

std::vector<Eigen::Vector2d> ReadRing(const JsonReader& reader) {
  std::vector<Eigen::Vector2d> ring;
  for (const JsonReader& item : reader.Items()) ring.push_back(ReadPoint(item));
  return ring;
}

Polygon ReadPolygon(const JsonReader& reader) {
  Polygon polygon;
  polygon.outer = ReadRing(reader.At("outer"));
  for (const JsonReader& hole : reader.At("holes").Items()) polygon.holes.push_back(ReadRing(hole));
  return polygon;
}

// Numbers of lines and parts are checked, so that the shape can be used without asking.
Shape ReadShape(const JsonReader& reader) {
  Shape shape;
  shape.origin = ReadPoint(reader.At("origin"));
  shape.yaw_rad = reader.At("yaw_rad").Number();
  shape.u = ReadNumbers(reader.At("u"));
  shape.v = ReadNumbers(reader.At("v"));
  shape.ground_z = reader.At("ground_z").Number();
  const std::vector<JsonReader> items = reader.At("parts").Items();
  const auto line_of = [](const JsonReader& line, const std::vector<double>& lines) {
    return static_cast<int>(line.Whole(0, static_cast<int64_t>(lines.size()) - 1));
  };
  for (const JsonReader& item : items) {
    Part& part = shape.parts.emplace_back();
    part.u0 = line_of(item.At("u0"), shape.u);
    part.u1 = line_of(item.At("u1"), shape.u);
    part.v0 = line_of(item.At("v0"), shape.v);
    part.v1 = line_of(item.At("v1"), shape.v);
    if (part.u0 >= part.u1 || part.v0 >= part.v1) item.Refuse("has no walls around it");
    part.roof = ReadRoof(item.At("roof"));
    part.along_u = item.At("along_u").Flag();
    part.eave_z = item.At("eave_z").Number();
    part.ridge_z = item.At("ridge_z").Number();
    part.joins = static_cast<int>(item.At("joins").Whole(-1, static_cast<int64_t>(items.size()) - 1));
  }
  return shape;
}

Measures ReadMeasures(const JsonReader& reader) {
  Measures measures;
  for (const auto& [name, member] : kMeasureNames) {
    const std::vector<JsonReader> items = reader.At(name).Items(2);
    measures.*member = {.value = items[0].NumberOrNan(), .sigma = items[1].NumberOrNan()};
  }
  measures.wall_seen = reader.At("wall_seen").NumberOrNan();
  return measures;
}

FaceKind ReadFaceKind(const JsonReader& reader) {
  const std::string name = reader.Text();
  for (const FaceKind kind : kFaceKinds) {
    if (name == FaceKindName(kind)) return kind;
  }
  reader.Refuse("is no kind of face");
}

std::vector<uint32_t> ReadIndices(const JsonReader& reader, size_t vertices) {
  std::vector<uint32_t> ring;
  for (const JsonReader& item : reader.Items()) ring.push_back(static_cast<uint32_t>(item.Whole(0, static_cast<int64_t>(vertices) - 1)));
  if (ring.size() < 3) reader.Refuse("has fewer than three corners");
  return ring;
}

Solid ReadSolid(const JsonReader& reader) {
  Solid solid;
  for (const JsonReader& item : reader.At("vertex").Items()) {
    const std::vector<JsonReader> x = item.Items(3);
    solid.vertex.emplace_back(x[0].Number(), x[1].Number(), x[2].Number());
  }
  for (const JsonReader& item : reader.At("face").Items()) {
    Face& face = solid.face.emplace_back();
    face.kind = ReadFaceKind(item.At("kind"));
    face.outer = ReadIndices(item.At("outer"), solid.vertex.size());
    for (const JsonReader& hole : item.At("holes").Items()) face.holes.push_back(ReadIndices(hole, solid.vertex.size()));
  }
  return solid;
}

Building ReadBuilding(const JsonReader& reader) {
  Building building;
  building.id = static_cast<int>(reader.At("id").Whole(1, kLargestInt));
  building.roof = ReadRoof(reader.At("roof"));
  building.accepted = reader.At("accepted").Flag();
  building.note = reader.At("note").Text();
  building.overhang_m = reader.At("overhang_m").NumberOrNan();
  building.overhang_measured = reader.At("overhang_measured").Flag();
  building.share_within = reader.At("share_within").NumberOrNan();
  building.residual_m = reader.At("residual_m").NumberOrNan();
  building.roof_points = reader.At("roof_points").Whole(0, kLargestCount);
  building.wall_points = reader.At("wall_points").Whole(0, kLargestCount);
  building.walls_from_points = reader.At("walls_from_points").Flag();
  building.given = reader.At("given").Flag();
  building.given_id = reader.At("given_id").Text();
  building.lod22_valid = reader.At("lod22_valid").Flag();
  building.shape = ReadShape(reader.At("shape"));
  building.footprint = ReadPolygon(reader.At("footprint"));
  for (const JsonReader& item : reader.At("roofprint").Items()) building.roofprint.push_back(ReadPolygon(item));
  building.measures = ReadMeasures(reader.At("measures"));
  building.lod12 = ReadSolid(reader.At("lod12"));
  building.lod22 = ReadSolid(reader.At("lod22"));
  return building;
}

BuildingSet ReadSet(const JsonReader& reader) {
  BuildingSet set;
  set.metric = reader.At("metric").Flag();
  set.scale = reader.At("scale").Number();
  if (!(set.scale > 0.0)) reader.At("scale").Refuse("is not positive");
  set.scale_source = reader.At("scale_source").Text();
  set.gsd_m = reader.At("gsd_m").NumberOrNan();
  reader.At("crs").Text();
  reader.At("vertical").Text();
  std::set<int> ids;
  for (const JsonReader& item : reader.At("buildings").Items()) {
    set.buildings.push_back(ReadBuilding(item));
    if (!ids.insert(set.buildings.back().id).second) item.Refuse("has the id of another building");
  }
  return set;
}

}  // namespace

BuildingSet LoadBuildings(const std::filesystem::path& file) {
  const std::string content = base::ReadFile(file);
  nlohmann::json document;
  try {
    document = base::ParseJson(content);
  } catch (const nlohmann::json::exception& error) {
    throw base::InputError(file, std::string("is damaged (") + error.what() + ")", kRunAgain);
  }
  const JsonReader reader(document, "");
  try {
    if (reader.At("format").Text() != kBuildingsFormat) throw base::InputError(file, "is no list of buildings", kRunAgain);
    const int64_t version = reader.At("version").Whole(0, kLargestCount);
    if (version != kBuildingsVersion) {
      throw base::InputError(file, "is of version " + std::to_string(version) + "; this program reads version " + std::to_string(kBuildingsVersion),
                             std::string(kRunAgain));
    }
    return ReadSet(reader);
  } catch (const DamagedJson& error) {
    throw base::InputError(file, std::string("is damaged: ") + error.what(), kRunAgain);
  }
}

}  // namespace skyquilt::buildings
