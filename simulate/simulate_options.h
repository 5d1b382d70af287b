// Options of `skyquilt simulate`, [simulate] in the configuration. Negative numbers, 0 where said and empty lists mean "as the place has it".
#pragma once

#include <string>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::simulate {

struct SimulateOptions {
  std::string place = "town";
  int seed = 1;                        // >= 0
  int image_width = 0;                 // pixels; 0: the place's; the height keeps the place's aspect ratio
  double forward_overlap = -1.0;       // 0..0.95, share of a photo seen by the next one of its line
  double side_overlap = -1.0;          // 0..0.95, share seen by the next line
  std::vector<double> altitudes;       // metres above ground: one for all blocks, or one per block, row by row from the south-west
  bool oblique = true;                 // fly the place's oblique lines too
  double gps_noise_m = -1.0;           // standard deviation per horizontal axis; the vertical one is 1.5 times that
  double exposure_drift_stops = -1.0;  // slow change over the flight, +- this much
  double exposure_jumps_stops = -1.0;  // sudden changes, +- this much
  double exposure_offset_stops = 0.0;  // -10..10, of every photo; the shutter times in the tags follow
  double exposure_error_stops = 0.0;   // 0..3, standard deviation of brightness per photo that the tags do not know of
  double color_drift_stops = 0.0;      // 0..3, slow wander of the white balance, red against blue; not in the tags
  double vignetting = 0.0;             // 0..0.9, share of light lost in the farthest corner
  std::string exposure_tags = "all";   // all, none, or half: every second photo has no exposure time, aperture and ISO
  double latitude_deg = 47.3769;       // of the ENU origin
  double longitude_deg = 8.5417;
  double height_m = 408.0;          // ellipsoidal height of the ENU origin, about the mean ground
  int test_every = 8;               // photos 0, n, 2n... in name order get a true depth image
  int moving_cars = -1;             // cars that change place between photos
  double sun_azimuth_deg = -1.0;    // clockwise from north, 0..360
  double sun_elevation_deg = -1.0;  // 5..90
  double light_intensity = 1.0;     // > 0, scales sun and sky
  int samples_per_pixel = 4;        // 1, 4 or 16
  bool soft_shadows = true;         // samples spread over the sun's disc
  int jpeg_quality = 95;            // 1..100

  void Visit(config::OptionVisitor& v);
};

}  // namespace skyquilt::simulate
