#include <nlohmann/json.hpp>
#include <utility>

#include "buildings/files/buildings_format.h"
#include "buildings/files/file_frame.h"
#include "core/base/file.h"
#include "core/base/json_text.h"

namespace skyquilt::buildings {
namespace {

using Json = nlohmann::ordered_json;

Json ListJson(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(base::NumberOrNull(value));
  return list;
}

Json PointJson(const Eigen::Vector2d& point) {
  return Json::array({base::NumberOrNull(point.x()), base::NumberOrNull(point.y())});
}

Json OutlineJson(const Polygon& polygon) {
  const auto ring_json = [](const std::vector<Eigen::Vector2d>& ring) {
    Json points = Json::array();
    for (const Eigen::Vector2d& point : ring) points.push_back(PointJson(point));
    return points;
  };
  Json holes = Json::array();
  for (const std::vector<Eigen::Vector2d>& hole : polygon.holes) holes.push_back(ring_json(hole));
  return {{"outer", ring_json(polygon.outer)}, {"holes", std::move(holes)}};
}

Json ShapeJson(const Shape& shape) {
  Json parts = Json::array();
  for (const Part& part : shape.parts) {
    parts.push_back({{"u0", part.u0},
                     {"u1", part.u1},
                     {"v0", part.v0},
                     {"v1", part.v1},
                     {"roof", NameOf(part.roof)},
                     {"along_u", part.along_u},
                     {"eave_z", base::NumberOrNull(part.eave_z)},
                     {"ridge_z", base::NumberOrNull(part.ridge_z)},
                     {"joins", part.joins}});
  }
  return {{"origin", PointJson(shape.origin)},
          {"yaw_rad", base::NumberOrNull(shape.yaw_rad)},
          {"u", ListJson(shape.u)},
          {"v", ListJson(shape.v)},
          {"ground_z", base::NumberOrNull(shape.ground_z)},
          {"parts", std::move(parts)}};
}

Json MeasuresJson(const Measures& measures) {
  Json json;
  for (const auto& [name, member] : kMeasureNames) {
    const Measure& measure = measures.*member;
    json[name] = Json::array({base::NumberOrNull(measure.value), base::NumberOrNull(measure.sigma)});
  }
  json["wall_seen"] = base::NumberOrNull(measures.wall_seen);
  return json;
}

Json FacesJson(const Solid& solid) {
  Json vertices = Json::array(), faces = Json::array();
  for (const Eigen::Vector3d& vertex : solid.vertex) {
    vertices.push_back(Json::array({base::NumberOrNull(vertex.x()), base::NumberOrNull(vertex.y()), base::NumberOrNull(vertex.z())}));
  }
  for (const Face& face : solid.face) {
    Json holes = Json::array();
    for (const std::vector<uint32_t>& hole : face.holes) holes.push_back(Json(hole));
    faces.push_back({{"kind", FaceKindName(face.kind)}, {"outer", face.outer}, {"holes", std::move(holes)}});
  }
  return {{"vertex", std::move(vertices)}, {"face", std::move(faces)}};
}

Json BuildingJson(const Building& building) {
  Json roofprint = Json::array();
  for (const Polygon& polygon : building.roofprint) roofprint.push_back(OutlineJson(polygon));
  Json json;
  json["id"] = building.id;
  json["roof"] = NameOf(building.roof);
  json["accepted"] = building.accepted;
  json["note"] = building.note;
  json["overhang_m"] = base::NumberOrNull(building.overhang_m);
  json["overhang_measured"] = building.overhang_measured;
  json["share_within"] = base::NumberOrNull(building.share_within);
  json["residual_m"] = base::NumberOrNull(building.residual_m);
  json["roof_points"] = building.roof_points;
  json["wall_points"] = building.wall_points;
  json["walls_from_points"] = building.walls_from_points;
  json["given"] = building.given;
  json["given_id"] = building.given_id;
  json["lod22_valid"] = building.lod22_valid;
  json["shape"] = ShapeJson(building.shape);
  json["footprint"] = OutlineJson(building.footprint);
  json["roofprint"] = std::move(roofprint);
  json["measures"] = MeasuresJson(building.measures);
  json["lod12"] = FacesJson(building.lod12);
  json["lod22"] = FacesJson(building.lod22);
  return json;
}

}  // namespace

void SaveBuildings(const BuildingSet& set, const surface::MapFrame& frame, const std::filesystem::path& file) {
  const FileFrame names(set, frame);
  Json json;
  json["format"] = kBuildingsFormat;
  json["version"] = kBuildingsVersion;
  json["metric"] = set.metric;
  json["scale"] = base::NumberOrNull(set.scale);
  json["scale_source"] = set.scale_source;
  json["gsd_m"] = base::NumberOrNull(set.gsd_m);
  json["crs"] = names.CrsName();
  json["vertical"] = names.VerticalName();
  json["buildings"] = Json::array();
  for (const Building& building : set.buildings) json["buildings"].push_back(BuildingJson(building));
  base::WriteFileAtomically(file, base::JsonText(json) + "\n");
}

}  // namespace skyquilt::buildings
