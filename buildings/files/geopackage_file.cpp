// buildings.gpkg: footprints for maps, solids for GIS that show heights.
#include <array>
#include <utility>

#include "buildings/files/building_files.h"
#include "buildings/files/building_table.h"
#include "core/gis/vector_layers.h"

namespace skyquilt::buildings {
namespace {

gis::LayerPolygon FootprintOf(const Building& building, const FileFrame& frame) {
  gis::LayerPolygon rings;
  const auto add = [&](const std::vector<Eigen::Vector2d>& ring) {
    std::vector<Eigen::Vector3d>& points = rings.emplace_back();
    for (const Eigen::Vector2d& point : ring) points.push_back(frame.PositionOf({point.x(), point.y(), building.shape.ground_z}));
  };
  add(building.footprint.outer);
  for (const std::vector<Eigen::Vector2d>& hole : building.footprint.holes) add(hole);
  return rings;
}

std::vector<gis::LayerPolygon> FacesOf(const Solid& solid, const FileFrame& frame) {
  const std::vector<Eigen::Vector3d> position = frame.PositionsOf(solid);
  std::vector<gis::LayerPolygon> faces;
  for (const Face& face : solid.face) {
    gis::LayerPolygon& rings = faces.emplace_back();
    const auto add = [&](const std::vector<uint32_t>& ring) {
      std::vector<Eigen::Vector3d>& points = rings.emplace_back();
      for (const uint32_t vertex : ring) points.push_back(position[vertex]);
    };
    add(face.outer);
    for (const std::vector<uint32_t>& hole : face.holes) add(hole);
  }
  return faces;
}

}  // namespace

void WriteGeoPackage(const BuildingSet& set, const surface::MapFrame& map, const std::filesystem::path& file) {
  const FileFrame frame(set, map);
  const BuildingTable table = TableOf(set, frame);
  std::array<gis::VectorLayer, 2> layers;
  const std::string heights = "Coordinates: " + frame.CrsName() + ". Heights above: " + frame.VerticalName();
  layers[0] = {.name = "footprints",
               .description = "Walls of the buildings. " + heights,
               .geometry = gis::LayerGeometry::kPolygon,
               .fields = table.fields,
               .features = {}};
  layers[1] = {.name = "solids",
               .description = "Buildings with their roofs, level of detail 2.2. " + heights,
               .geometry = gis::LayerGeometry::kMultiPolygonZ,
               .heights = map.heights().reference(),
               .fields = table.fields,
               .features = {}};
  for (size_t i = 0; i < set.buildings.size(); ++i) {
    const Building& building = set.buildings[i];
    gis::LayerFeature footprint{.polygons = {}, .values = table.rows[i]};
    if (!building.footprint.outer.empty()) footprint.polygons.push_back(FootprintOf(building, frame));
    layers[0].features.push_back(std::move(footprint));
    layers[1].features.push_back({.polygons = FacesOf(building.lod22, frame), .values = table.rows[i]});
  }
  gis::WriteVectorLayers(layers, map.georeferenced(), map.zone(), file);
}

}  // namespace skyquilt::buildings
