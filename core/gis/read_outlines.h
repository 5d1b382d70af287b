// Known outlines, for instance of buildings from a cadastre or a map, in the coordinates of the maps.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "core/geo/utm.h"

namespace skyquilt::gis {

struct Outline {
  // Closed rings without their first point repeated: the outer one first, counter-clockwise, then holes, clockwise. Easting and northing. No ring
  // crosses itself or another.
  std::vector<std::vector<Eigen::Vector2d>> rings;
  std::string id;  // UTF-8; empty where the file has none
};

// Every polygon of all layers of a GeoJSON, GeoPackage or Shapefile, in their order; multipolygons are split. The identity is the value of the first
// of the fields "id", "fid", "osm_id" and "name" (in any case) that is not empty, else the feature's number where the format stores one.
// Coordinates are transformed as by Boundary::Read; heights are dropped. Polygons that cross themselves are split where they cross; those without an
// area are left out. Throws base::InputError: unreadable, no polygon with an area, no CRS, or a place that cannot be transformed.
std::vector<Outline> ReadOutlines(const std::filesystem::path& file, bool georeferenced, const geo::UtmZone& zone);

}  // namespace skyquilt::gis
