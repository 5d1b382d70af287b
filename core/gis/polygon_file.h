// Reads polygons from vector files, in map coordinates. Includes GDAL's headers, so only the .cpp files of this folder may include it.
#pragma once

#include <ogrsf_frmts.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/gis/gdal_support.h"

namespace skyquilt::gis::internal {

// Which files are read, and how messages speak of them.
struct PolygonFormats {
  std::vector<const char*> drivers;  // GDAL's short names: "GeoJSON", "GPKG", "ESRI Shapefile"
  std::string names;                 // "GeoJSON or GeoPackage"
  std::string fix;                   // "Give a GeoJSON file with ..."
};

// Adds the straight-edged polygons of a geometry of any type to those already there.
void AddPolygons(const OGRGeometry& geometry, OGRMultiPolygon* polygons);

struct FoundPolygons {
  OGRFeatureUniquePtr feature;
  OGRMultiPolygon polygons;  // in map coordinates, not empty
  bool numbered = false;     // the feature's FID is stored in the file rather than counted
};

// Calls `take` for each feature with polygons, layer by layer. Their corners are transformed from the layer's CRS to the zone of the survey, edges
// stay straight; without geo-reference they are taken as they are. Throws base::InputError: missing, unreadable or damaged, no CRS, a coordinate that
// is not finite, or a place that cannot be transformed. GDAL must be kept quiet by the caller.
void ForEachPolygons(const std::filesystem::path& file, const PolygonFormats& formats, bool georeferenced, const geo::UtmZone& zone,
                     const std::function<void(const FoundPolygons&)>& take);

}  // namespace skyquilt::gis::internal
