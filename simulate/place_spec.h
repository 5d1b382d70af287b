// Settings of the simulated places (hamlet, town, smallcity, tidalflat, solar_farm, and the room of flight "room"). ResolvePlace applies the user's
// options to them once; everything else reads the result.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/camera/camera.h"
#include "simulate/cloud_shadows.h"
#include "simulate/simulate_options.h"
#include "simulate/tag_faults.h"

namespace skyquilt::simulate {

enum class Landscape { kCity, kTidalFlat, kSolarFarm, kRoom };
// How the photos are taken: from above in lines, or level (simulate/flights/).
enum class FlightKind { kSurvey, kFacade, kOrbit, kStreet, kRoom };
enum class ExposureTags { kAll, kNone, kHalf };  // kHalf: every second photo has none, beginning with the second

struct CityPlan {
  Eigen::Vector2d min =
      Eigen::Vector2d::Zero();  // built-up rectangle, ENU metres; fields beyond. Cells between streets belong to it as a whole or not
  Eigen::Vector2d max = Eigen::Vector2d::Zero();
  double yaw_deg = 0.0;                             // of the streets, counter-clockwise from east
  double district_turn_deg = 0.0;                   // of the buildings in one half of the city relative to the streets
  double pitch_m = 66.0;                            // between street centre lines
  Eigen::Vector2d phase = Eigen::Vector2d::Zero();  // one crossing of streets, along the axes of the city
  double tower_share = 0.1;                         // of the cells between streets
  double flats_share = 0.2;
  double park_share = 0.1;
  double lot_use = 0.95;        // share of house lots with a house
  double trees = 1.0;           // density relative to the town
  int tree_detail = 2;          // subdivisions of each crown
  bool varied = false;          // buildings of many shapes instead of rectangles
  double tower_m = 0.0;         // height of a tower in the middle of the city; 0: none
  double building_share = 1.0;  // of the cells that would have buildings
  double tree_density = 1.0;    // factor on the number of trees, `trees` included
  bool bridge = false;          // over the crossing nearest to the middle
  int lamps = 0;                // at kerbs
  int trucks = 0;               // with containers, parked in streets in this rectangle, ENU metres; lamps stand there, too
  Eigen::Vector2d trucks_min = Eigen::Vector2d::Zero(), trucks_max = Eigen::Vector2d::Zero();
};

struct PlaceSpec {
  std::string name;
  Landscape landscape = Landscape::kCity;
  FlightKind flight = FlightKind::kSurvey;
  int level_photos = 0;  // number of photos of a flight that is no survey
  uint32_t seed = 1;
  Eigen::Vector2d area_min = Eigen::Vector2d::Zero();  // the surveyed area, ENU metres
  Eigen::Vector2d area_max = Eigen::Vector2d::Zero();
  double surround_m = 150.0;  // ground modelled beyond the area on every side
  double terrain_step_m = 2.0;
  double terrain_amplitude_m = 1.5;
  double hillside_deg = 0.0;  // slope of a plane under the terrain, through z = 0 in the middle of the area, rising to the north-east
  CityPlan city;
  int rows = 2;  // of blocks
  int columns = 2;
  std::vector<double> altitudes_agl_m;  // rows * columns, row-major from the south-west
  double forward_overlap = 0.8;
  double side_overlap = 0.7;
  double flight_inset_m = 0.0;  // flight lines end this far inside the area
  double speed_mps = 8.0;
  int oblique_lines = 0;  // 0, 2 or 4: passes along the edges looking inwards, 30 degrees off nadir
  double oblique_overlap = 0.65;
  bool single_line = false;  // one nadir line through the middle of the area, from south to north, at the mean altitude, and no oblique lines
  camera::Camera camera;
  double gps_noise_m = 0.5;
  TagFaults tag_faults;
  double exposure_drift_stops = 0.2;
  double exposure_jumps_stops = 0.0;
  double exposure_offset_stops = 0.0;
  double exposure_error_stops = 0.0;
  double color_drift_stops = 0.0;
  double vignetting = 0.0;
  ExposureTags exposure_tags = ExposureTags::kAll;
  int moving_cars = 3;
  int people = 0;
  double sun_azimuth_deg = 140.0;
  double sun_elevation_deg = 48.0;
  double ambient_voxel_m = 3.0;
  CloudShadowSpec cloud_shadows;
  bool marsh = false;       // plants and trees on a tidal flat
  double sky_clouds = 0.0;  // 0..1, contrast of the clouds; photos see them mirrored by wet surfaces
};

// The settings of options.place, changed by the other options. Throws base::UsageError that names the option, its value and what is allowed.
PlaceSpec ResolvePlace(const SimulateOptions& options);

}  // namespace skyquilt::simulate
