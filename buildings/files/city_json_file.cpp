// buildings.city.json: CityJSON 2.0 (https://www.cityjson.org/specs/2.0.1).
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "buildings/files/building_files.h"
#include "buildings/files/building_table.h"
#include "core/base/file.h"
#include "core/base/json_text.h"

namespace skyquilt::buildings {
namespace {

using Json = nlohmann::ordered_json;

// Finer than the least distance of two vertices, 1 mm, so that rounding merges none of a solid.
constexpr double kStep_m = 0.0001;
constexpr double kStepsPer_m = 10000.0;

// Vertices of the whole file, each once, as multiples of kStep_m from the frame's offset.
class VertexPool {
 public:
  explicit VertexPool(const Eigen::Vector3d& offset) : offset_(offset) {}

  size_t IndexOf(const Eigen::Vector3d& position) {
    std::array<int64_t, 3> steps;
    for (size_t axis = 0; axis < 3; ++axis) {
      const auto row = static_cast<Eigen::Index>(axis);
      steps[axis] = std::llround((position[row] - offset_[row]) * kStepsPer_m);
    }
    const auto [entry, is_new] = index_.emplace(steps, steps_.size());
    if (is_new) steps_.push_back(steps);
    return entry->second;
  }
  Json ToJson() const { return steps_.empty() ? Json::array() : Json(steps_); }
  Json TransformJson() const { return {{"scale", {kStep_m, kStep_m, kStep_m}}, {"translate", {offset_.x(), offset_.y(), offset_.z()}}}; }
  // [min x, min y, min z, max x, max y, max z]; nothing without vertices.
  std::optional<Json> ExtentJson() const {
    if (steps_.empty()) return std::nullopt;
    std::array<int64_t, 3> min = steps_.front(), max = min;
    for (const std::array<int64_t, 3>& steps : steps_) {
      for (size_t axis = 0; axis < 3; ++axis) {
        min[axis] = std::min(min[axis], steps[axis]);
        max[axis] = std::max(max[axis], steps[axis]);
      }
    }
    Json extent = Json::array();
    for (const std::array<int64_t, 3>& corner : {min, max}) {
      for (size_t axis = 0; axis < 3; ++axis) {
        extent.push_back(Rounded(static_cast<double>(corner[axis]) / kStepsPer_m + offset_[static_cast<Eigen::Index>(axis)], 4));
      }
    }
    return extent;
  }

 private:
  Eigen::Vector3d offset_;
  std::map<std::array<int64_t, 3>, size_t> index_;
  std::vector<std::array<int64_t, 3>> steps_;
};

const char* SurfaceType(FaceKind kind) {
  switch (kind) {
    case FaceKind::kGround:
      return "GroundSurface";
    case FaceKind::kRoof:
      return "RoofSurface";
    case FaceKind::kWall:
      break;
  }
  return "WallSurface";
}

Json SolidJson(const Solid& solid, const char* lod, const FileFrame& frame, VertexPool* pool) {
  const std::vector<Eigen::Vector3d> position = frame.PositionsOf(solid);
  const auto ring_json = [&](const std::vector<uint32_t>& ring) {
    Json indices = Json::array();
    for (const uint32_t vertex : ring) indices.push_back(pool->IndexOf(position[vertex]));
    return indices;
  };
  Json shell = Json::array(), kinds = Json::array(), surfaces = Json::array();
  std::map<FaceKind, size_t> surface_of;
  for (const Face& face : solid.face) {
    Json rings = Json::array({ring_json(face.outer)});
    for (const std::vector<uint32_t>& hole : face.holes) rings.push_back(ring_json(hole));
    shell.push_back(std::move(rings));
    const auto [entry, is_new] = surface_of.emplace(face.kind, surfaces.size());
    if (is_new) surfaces.push_back({{"type", SurfaceType(face.kind)}});
    kinds.push_back(entry->second);
  }
  return {{"type", "Solid"},
          {"lod", lod},
          {"boundaries", Json::array({std::move(shell)})},
          {"semantics", {{"surfaces", std::move(surfaces)}, {"values", Json::array({std::move(kinds)})}}}};
}

void AddKnown(const std::string& name, double value, Json* to) {
  if (std::isfinite(value)) (*to)[name] = value;
}

Json PartsJson(const Building& building, const FileFrame& frame) {
  const Shape& shape = building.shape;
  const std::string unit = frame.metric() ? "_m" : "";
  Json parts = Json::array();
  for (const Part& part : shape.parts) {
    const Eigen::Vector2d min = shape.MinOf(part, false), max = shape.MaxOf(part, false);
    const Eigen::Vector2d middle = shape.EnuFrom(0.5 * (min + max));
    Json corners = Json::array();
    for (const Eigen::Vector2d& corner : {min, Eigen::Vector2d(max.x(), min.y()), max, Eigen::Vector2d(min.x(), max.y())}) {
      const Eigen::Vector2d enu = shape.EnuFrom(corner);
      const Eigen::Vector3d position = frame.PositionOf({enu.x(), enu.y(), shape.ground_z});
      corners.push_back({position.x(), position.y()});
    }
    Json entry = {{"roof", NameOf(part.roof)}};
    AddKnown("eave" + unit, frame.HeightOf(middle, part.eave_z), &entry);
    AddKnown("ridge" + unit, frame.HeightOf(middle, part.ridge_z), &entry);
    entry["outline"] = std::move(corners);
    parts.push_back(std::move(entry));
  }
  return parts;
}

Json AttributesJson(const Building& building, const FileFrame& frame) {
  Json attributes;
  attributes["id"] = building.id;
  attributes["roof"] = NameOf(building.roof);
  // The names that CityJSON itself has for these.
  attributes["roofType"] = NameOf(building.roof);
  if (frame.metric()) AddKnown("measuredHeight", Rounded(building.measures.height_m.value, 4), &attributes);
  for (const NamedMeasure& column : MeasuresOf(building, frame)) {
    AddKnown(column.name, column.measure.value, &attributes);
    AddKnown(column.name + "_sigma", column.measure.sigma, &attributes);
  }
  AddKnown("wall_seen", Rounded(building.measures.wall_seen, 4), &attributes);
  AddKnown(frame.metric() ? "overhang_m" : "overhang", Rounded(frame.scale() * building.overhang_m, 4), &attributes);
  attributes["overhang_measured"] = building.overhang_measured;
  attributes["walls_from_points"] = building.walls_from_points;
  attributes["accepted"] = building.accepted;
  AddKnown("share_within", Rounded(building.share_within, 4), &attributes);
  AddKnown(frame.metric() ? "residual_m" : "residual", Rounded(frame.scale() * building.residual_m, 4), &attributes);
  attributes["roof_points"] = building.roof_points;
  attributes["wall_points"] = building.wall_points;
  attributes["lod22_valid"] = building.lod22_valid;
  if (building.given) attributes["outline_given"] = true;
  if (!building.given_id.empty()) attributes["outline_id"] = building.given_id;
  if (!building.note.empty()) attributes["note"] = building.note;
  attributes["parts"] = PartsJson(building, frame);
  return attributes;
}

}  // namespace

void WriteCityJson(const BuildingSet& set, const surface::MapFrame& map, const std::filesystem::path& file) {
  const FileFrame frame(set, map);
  VertexPool pool(map.offset());
  Json objects = Json::object();
  for (const Building& building : set.buildings) {
    Json geometry = Json::array();
    if (!building.lod12.Empty()) geometry.push_back(SolidJson(building.lod12, "1.2", frame, &pool));
    if (!building.lod22.Empty()) geometry.push_back(SolidJson(building.lod22, "2.2", frame, &pool));
    objects["building_" + std::to_string(building.id)] = {
        {"type", "Building"}, {"attributes", AttributesJson(building, frame)}, {"geometry", std::move(geometry)}};
  }
  Json metadata = {{"title", "Buildings measured by Skyquilt. Coordinates: " + frame.CrsName() + ". Heights above: " + frame.VerticalName()}};
  if (map.georeferenced()) metadata["referenceSystem"] = "https://www.opengis.net/def/crs/EPSG/0/" + std::to_string(map.zone().Epsg());
  if (std::optional<Json> extent = pool.ExtentJson()) metadata["geographicalExtent"] = *std::move(extent);
  Json document;
  document["type"] = "CityJSON";
  document["version"] = "2.0";
  document["transform"] = pool.TransformJson();
  document["metadata"] = std::move(metadata);
  document["CityObjects"] = std::move(objects);
  document["vertices"] = pool.ToJson();
  base::WriteFileAtomically(file, base::JsonText(document) + "\n");
}

}  // namespace skyquilt::buildings
