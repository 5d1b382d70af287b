#include "buildings/buildings_options.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::buildings {
namespace {

// Metres per unit of a scene. Other values come from mistyped points.
constexpr double kLeastScale = 1e-4, kMostScale = 1e4;

}  // namespace

double ScaleOf(const std::vector<double>& scale_bar) {
  return scale_bar[6] / std::hypot(scale_bar[3] - scale_bar[0], scale_bar[4] - scale_bar[1], scale_bar[5] - scale_bar[2]);
}

std::vector<config::Field<BuildingsOptions>> BuildingsOptions::Fields() {
  using config::Range;
  using O = BuildingsOptions;
  return {
      {"enabled", &O::enabled, Range(), "find and measure buildings in 'skyquilt run'; 'skyquilt buildings' does it in any case"},
      {"min_area_m2", &O::min_area_m2, Range{1, 1e6}, "smallest outline of a building seen from above, square metres"},
      {"min_height_m", &O::min_height_m, Range{0.5, 100}, "lowest roof above the ground, metres"},
      {"max_green", &O::max_green, Range{-1, 2},
       "excess green, (2g - r - b) / (r + g + b), above which what stands on the ground is taken for vegetation; 2: colours do not count"},
      {"overhang_m", &O::overhang_m, Range{0, 5},
       "how far pitched roofs reach over the walls, metres; used where neither the building nor its neighbours show walls"},
      {"footprints", &O::footprints, Range(), "file with known outlines (GeoPackage, GeoJSON, Shapefile); empty: buildings are found"},
      {"scale_bar", &O::scale_bar, Range{-1e9, 1e9},
       "a distance measured on site, which gives all lengths their scale: x, y, z of one point, x, y, z of the other, their distance in metres; "
       "empty: none"},
      {"facade_gsd", &O::facade_gsd, Range{0.1, 1000}, "pixels of the pictures of facades, in ground sampling distances"},
      {"cityjson", &O::cityjson, Range(), "write CityJSON 2.0"},
      {"geopackage", &O::geopackage, Range(), "write a GeoPackage with footprints and solids"},
      {"csv", &O::csv, Range(), "write a table of all measures"},
      {"glb", &O::glb, Range(), "write a glTF 2.0 model"},
      {"dxf", &O::dxf, Range(), "write the edges as DXF"},
      {"classify_cloud", &O::classify_cloud, Range(), "write classes (roof, wall, edge, ground, vegetation) into the surface's point cloud"},
  };
}

std::vector<config::FixedOption> BuildingsOptions::Fixed() {
  return {{"min_part_m2", kMinPart_m2}, {"share_yaw_m", kShareYaw_m}};
}

void BuildingsOptions::Check() const {
  config::CheckRanges("buildings", *this);
  if (scale_bar.empty()) return;
  if (scale_bar.size() != 7) {
    throw base::UsageError("buildings.scale_bar has " + std::to_string(scale_bar.size()) +
                           " numbers: it must be empty or have 7, x, y, z of two points and their distance in metres");
  }
  if (!(scale_bar[6] > 0.0)) {
    throw base::UsageError("buildings.scale_bar[6] = " + std::to_string(scale_bar[6]) + " is not allowed: the distance must be above 0");
  }
  if (std::equal(scale_bar.begin(), scale_bar.begin() + 3, scale_bar.begin() + 3)) {
    throw base::UsageError("buildings.scale_bar: the two points are the same; give two points of the scene and their distance");
  }
  if (const double factor = ScaleOf(scale_bar); !(factor >= kLeastScale && factor <= kMostScale)) {
    throw base::UsageError("buildings.scale_bar: a distance of " + std::to_string(scale_bar[6]) + " m for these two points makes lengths " +
                           std::to_string(factor) + " times as long; give two points that lie well apart, as the viewer shows them");
  }
}

}  // namespace skyquilt::buildings
