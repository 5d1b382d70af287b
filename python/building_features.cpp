#include "python/building_features.h"

#include <nlohmann/json.hpp>
#include <variant>

#include "buildings/files/building_files.h"
#include "buildings/files/building_table.h"
#include "buildings/files/file_frame.h"
#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "core/geo/utm.h"
#include "partition/block.h"

namespace skyquilt::python {
namespace {

using Json = nlohmann::ordered_json;

// What the coordinates of files depend on, without opening the scene.
scene::SceneInfo PlaceOf(const partition::BlockSet& blocks) {
  scene::SceneInfo info;
  info.origin = blocks.origin;
  info.georeferenced = blocks.georeferenced;
  info.accuracy = blocks.accuracy;
  info.height_reference = blocks.height_reference;
  info.min_enu = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  info.max_enu = -info.min_enu;
  for (const partition::Block& block : blocks.blocks) {
    if (block.empty) continue;
    info.min_enu = info.min_enu.cwiseMin(block.min_enu);
    info.max_enu = info.max_enu.cwiseMax(block.max_enu);
  }
  return info;
}

Json RingOf(const std::vector<Eigen::Vector2d>& ring, double z, const buildings::FileFrame& frame) {
  Json coordinates = Json::array();
  for (size_t i = 0; i <= ring.size() && !ring.empty(); ++i) {  // the first point again at the end
    const Eigen::Vector2d& enu = ring[i % ring.size()];
    const Eigen::Vector3d map = frame.PositionOf({enu.x(), enu.y(), z});
    if (!frame.map().georeferenced()) {
      coordinates.push_back({map.x(), map.y()});
      continue;
    }
    const geo::Geodetic place = geo::GeodeticFromUtm(map.head<2>(), map.z(), frame.map().zone());
    coordinates.push_back({place.longitude_deg, place.latitude_deg});
  }
  return coordinates;
}

Json ValueOf(const gis::FieldValue& value) {
  if (const auto* whole = std::get_if<int64_t>(&value)) return *whole;
  if (const auto* real = std::get_if<double>(&value)) return base::NumberOrNull(*real);
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  return nullptr;
}

}  // namespace

std::string BuildingFeatures(const coordinator::Project& project) {
  if (!std::filesystem::exists(project.BuildingsFile())) {
    throw base::InputError(project.BuildingsFile(), "no such file", "Measure the buildings with 'skyquilt buildings' or skyquilt.buildings()");
  }
  const buildings::BuildingSet set = buildings::LoadBuildings(project.BuildingsFile());
  const surface::MapFrame map(PlaceOf(partition::LoadBlocks(project.BlocksFile())));
  const buildings::FileFrame frame(set, map);
  const buildings::BuildingTable table = buildings::TableOf(set, frame);
  Json features = Json::array();
  for (size_t i = 0; i < set.buildings.size(); ++i) {
    const buildings::Building& building = set.buildings[i];
    Json rings = Json::array();
    if (building.footprint.outer.size() >= 3) rings.push_back(RingOf(building.footprint.outer, building.shape.ground_z, frame));
    for (const auto& hole : building.footprint.holes) rings.push_back(RingOf(hole, building.shape.ground_z, frame));
    Json properties = Json::object();
    for (size_t f = 0; f < table.fields.size(); ++f) properties[table.fields[f].name] = ValueOf(table.rows[i][f]);
    Json feature = {{"type", "Feature"}, {"id", building.id}};
    feature["geometry"] = rings.empty() ? Json(nullptr) : Json{{"type", "Polygon"}, {"coordinates", rings}};
    feature["properties"] = properties;
    features.push_back(feature);
  }
  return base::JsonText(Json{{"type", "FeatureCollection"},
                             {"skyquilt:georeferenced", map.georeferenced()},
                             {"skyquilt:crs", frame.CrsName()},
                             {"skyquilt:metric", frame.metric()},
                             {"features", features}});
}

}  // namespace skyquilt::python
