// Options of section [buildings] of the configuration: how buildings are found and measured.
#pragma once

#include <string>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::buildings {

// Smaller boxes on a roof, such as lift houses and chimneys, are no parts of the building.
constexpr double kMinPart_m2 = 15.0;
// Buildings nearer than this to each other may share one direction: those of a street, whose walls run alike, but not those of another quarter.
constexpr double kShareYaw_m = 60.0;

struct BuildingsOptions {
  bool enabled = true;            // made by 'skyquilt run'
  double min_area_m2 = 10.0;      // smallest outline
  double min_height_m = 2.0;      // lowest roof above the ground
  double max_green = 0.1;         // excess green (2g - r - b) / (r + g + b) above which planar pieces are vegetation
  double overhang_m = 0.0;        // of pitched roofs where neither the building nor its neighbours show walls
  std::string footprints;         // file with known outlines; empty: they are found
  std::vector<double> scale_bar;  // x, y, z of A, x, y, z of B, and their distance in metres; empty: none
  double facade_gsd = 1.0;        // pixels of facade pictures, in ground sampling distances
  bool cityjson = true, geopackage = true, csv = true, glb = true, dxf = true;  // files
  bool classify_cloud = true;                                                   // write classes into the cloud of the surface

  static std::vector<config::Field<BuildingsOptions>> Fields();
  static std::vector<config::FixedOption> Fixed();
  // Throws base::UsageError that names the option, its value and the rule it breaks.
  void Check() const;
};

// Metres per unit of length by the seven numbers of a scale bar.
double ScaleOf(const std::vector<double>& scale_bar);

}  // namespace skyquilt::buildings
