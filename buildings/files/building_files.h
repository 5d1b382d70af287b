// The files in which buildings leave the program. All are written under another name and renamed; the same buildings give the same bytes.
// Files for people have the coordinates of the maps. Without geo-reference those of the local frame times BuildingSet::scale, so that coordinates and
// measures are both metres; only buildings.json and buildings.glb, which lies on the surface's mesh.glb, keep the survey's own. Heights are those of
// the maps: the ground's by the geo-reference, the others as high above it as measured. yaw_deg is from true east at the survey's origin, as
// measured. All writers throw base::InputError (disk full, no permission); those of files for people std::logic_error when a coordinate is not
// finite.
#pragma once

#include <filesystem>
#include <vector>

#include "buildings/building.h"
#include "buildings/buildings_options.h"
#include "surface/map_frame.h"
#include "surface/written_file.h"

namespace skyquilt::buildings {

// buildings.json, our own: everything that is known, for reports, viewer and scores. Coordinates: survey ENU.
void SaveBuildings(const BuildingSet& set, const surface::MapFrame& frame, const std::filesystem::path& file);
// Throws base::InputError when it cannot be read, is damaged or of another version.
BuildingSet LoadBuildings(const std::filesystem::path& file);

// CityJSON 2.0: Building objects (parts as attributes), Solid geometries of lod "1.2" and "2.2" with Ground-, Wall- and RoofSurface, integer vertices
// with transform, referenceSystem (compound of horizontal EPSG code when geo-referenced); attributes: every measure and its _sigma, roof kind.
void WriteCityJson(const BuildingSet& set, const surface::MapFrame& frame, const std::filesystem::path& file);
// One row per building: id, longitude, latitude, easting, northing, ground_m, eave_m, ridge_m, height_m, length_m, width_m, yaw_deg, area_m2,
// volume_m3, roof_area_m2, pitch_deg, each of the measures followed by its _sigma (ground_m_sigma); then wall_seen, roof, accepted (1 or 0), note;
// with given outlines outline_id.
// The place is the middle of the footprint. Unknown: empty.
// Without a known scale the columns of lengths are named ground, eave, ... without unit, and longitude and latitude are empty.
void WriteCsv(const BuildingSet& set, const surface::MapFrame& frame, const std::filesystem::path& file);
// Layers "footprints" (polygons) and "solids" (MultiPolygonZ of lod22 faces), with the CSV's fields.
void WriteGeoPackage(const BuildingSet& set, const surface::MapFrame& frame, const std::filesystem::path& file);
// Binary glTF, y up, offset as surface/files: one node per building with its id and measures as extras, grey walls, red roofs. Extras of the asset
// say the CRS, the offset, and the metres per unit (null: unknown).
void WriteGlb(const BuildingSet& set, const surface::MapFrame& frame, const std::filesystem::path& file);
// DXF R12 (ASCII): the edges of every lod22 solid as LINE entities in map coordinates, a layer each for GROUND, WALLS, ROOFS and FOOTPRINTS
// (POLYLINE).
void WriteDxf(const BuildingSet& set, const surface::MapFrame& frame, const std::filesystem::path& file);

// All of the above as chosen in the options, into the folder: buildings.{json,city.json,csv,gpkg,glb,dxf}; files of earlier calls that are not chosen
// now are removed. Throws base::InputError.
std::vector<surface::WrittenFile> WriteBuildings(const BuildingSet& set, const surface::MapFrame& frame, const BuildingsOptions& options,
                                                 const std::filesystem::path& folder);

}  // namespace skyquilt::buildings
