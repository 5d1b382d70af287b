// Polygons with fields, as a GeoPackage that every GIS reads.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "core/geo/height_reference.h"
#include "core/geo/utm.h"

namespace skyquilt::gis {

enum class LayerGeometry {
  kPolygon,        // one polygon per feature; heights are not written
  kMultiPolygonZ,  // any number of polygons in space
};
enum class FieldType { kInteger, kReal, kText };

struct LayerField {
  std::string name;
  FieldType type = FieldType::kReal;
};
// Of the field's type, or std::monostate where it is unknown (NULL).
using FieldValue = std::variant<std::monostate, int64_t, double, std::string>;

// Rings without their first point repeated at the end, the outer ring first. Map coordinates: easting, northing, height.
using LayerPolygon = std::vector<std::vector<Eigen::Vector3d>>;

struct LayerFeature {
  std::vector<LayerPolygon> polygons;  // none: a feature without a place
  std::vector<FieldValue> values;      // one per field of its layer
};

struct VectorLayer {
  std::string name;         // distinct in the file
  std::string description;  // for people
  LayerGeometry geometry = LayerGeometry::kPolygon;
  geo::HeightReference heights = geo::HeightReference::kUnknown;  // of kMultiPolygonZ: what heights are above becomes part of the CRS
  std::vector<LayerField> fields;                                 // distinct names; none may be "fid" or "geom", which GeoPackage uses itself
  std::vector<LayerFeature> features;
};

// Writes all layers, in their order and with their features in order. CRS: the zone's, with the heights of the layer
// where they are known; none without geo-reference. Real numbers that are not finite
// become NULL. Written under another name and renamed; the same layers give the same bytes, so the file's time stamp is fixed. Throws
// base::InputError when it cannot be written, base::Interrupted, and std::logic_error when features do not fit their layer or a ring has fewer than
// three points or a coordinate that is not finite.
void WriteVectorLayers(std::span<const VectorLayer> layers, bool georeferenced, const geo::UtmZone& zone, const std::filesystem::path& gpkg);

}  // namespace skyquilt::gis
