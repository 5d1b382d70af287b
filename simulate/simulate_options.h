// Options of `skyquilt simulate`, section [simulate] of the configuration. A negative number, an empty list, and 0 for image_width, keep the value of
// the place.
#pragma once

#include <string>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::simulate {

struct SimulateOptions {
  std::string place = "town";
  std::string flight = "survey";       // survey, facade, orbit, street or room
  int photos = 0;                      // of flights other than survey; 0: the flight's number
  std::string tags = "auto";           // of position and gimbal: all, none, or auto: all of a survey, none of other flights
  int seed = 1;                        // >= 0
  int image_width = 0;                 // pixels; 0: the place's width. The aspect ratio is always the place's
  double forward_overlap = -1.0;       // 0..0.95, share of a photo that the next photo of the line sees too
  double side_overlap = -1.0;          // 0..0.95, share of a photo that the next line sees too
  std::vector<double> altitudes;       // metres above ground: one for all blocks, or one per block, row by row from the south-west
  bool oblique = true;                 // fly the place's oblique lines too
  double gps_noise_m = -1.0;           // standard deviation per horizontal axis; vertically 1.5 times that
  double exposure_drift_stops = -1.0;  // slow change over the flight, at most +- this
  double exposure_jumps_stops = -1.0;  // sudden changes, at most +- this
  double exposure_offset_stops = 0.0;  // -10..10, of every photo; the tags record it
  double exposure_error_stops = 0.0;   // 0..3, standard deviation of each photo's brightness error, which the tags do not record
  double color_drift_stops = 0.0;      // 0..3, slow drift of the white balance, red against blue, which the tags do not record
  double vignetting = 0.0;             // 0..0.9, fraction of light lost in the farthest corner
  std::string exposure_tags = "all";   // all, none, or half: every second photo has no exposure time, aperture and ISO
  double latitude_deg = 47.3769;       // of the ENU origin
  double longitude_deg = 8.5417;
  double height_m = 408.0;            // ellipsoidal height of the ENU origin, about the mean ground
  int test_every = 8;                 // photos 0, n, 2n... in name order get a true depth image
  int moving_cars = -1;               // cars that move between photos
  int people = 0;                     // 0..1000, who walk on pavements
  int lamps = 0;                      // 0..1000, street lamps
  std::string class_images = "test";  // photos with an image of their surfaces' classes: test: those with true depth; all
  double sun_azimuth_deg = -1.0;      // clockwise from north, 0..360
  double sun_elevation_deg = -1.0;    // 5..90
  double light_intensity = 1.0;       // > 0, scales sun and sky
  std::string lights = "one";         // one, sun or intensity: all photos again under several lights, see lights.h
  int lights_every = 1;               // 1..8, only the first of these lights and every n-th after it
  // Drifting shadows of clouds; none by default. See cloud_shadows.h.
  double cloud_shadows = 0.0;             // 0..5 stops of the sun's light
  double cloud_size_m = 150.0;            // 10..5000
  double cloud_penumbra_m = 40.0;         // 1..500
  double cloud_speed_ms = 5.0;            // 0..50
  double cloud_cover = 0.4;               // 0.05..0.95
  int samples_per_pixel = 4;              // 1, 4 or 16
  bool soft_shadows = true;               // samples spread over the sun's disc
  int jpeg_quality = 95;                  // 1..100
  bool single_line = false;               // fly one straight nadir line only
  double hillside_deg = 0.0;              // 0..45, slope of the terrain, rising to the north-east
  double city_yaw_deg = -1.0;             // 0..360, of the streets, counter-clockwise from east; negative: random, from the seed
  double district_turn_deg = -1.0;        // 0..12, of the buildings in half of the city relative to the streets; negative: +-8 to 12, from the seed
  std::string building_shapes = "plain";  // plain: rectangles; varied: also wings, set-backs, rows and courtyards
  double tower_m = 0.0;                   // 0 or 20..200, height of a tower in the middle of the place
  double building_share = 1.0;            // 0..1, of the cells between streets that would have buildings; the others are woods
  double tree_density = 1.0;              // 0..10, factor on the number of trees
  bool bridge = false;                    // over a crossing in the middle of the place
  int trucks = 0;                         // 0..100, parked trucks and containers
  bool marsh = false;                     // tidalflat: plants on the high sand, and trees
  double ortho_cell_m = 0.0;              // 0 or 0.005..10, width of the cells of a true orthophoto; 0: none
  int video_fps = 0;                      // 0 or 1..60 frames per second of a video of the same flight; 0: none
  int panoramas = 0;                      // 0..10000 panoramas at places of the flight; 0: none
  int panorama_width = 2048;              // 64..16384 pixels, even
  int edge_targets = 0;                   // 0..100 slanted-edge targets on the ground, see edge_targets.h
  bool exact_frame = true;                // false: the COLMAP model is under a random similarity, as structure from motion makes it
  double pose_noise_deg = 0.0;            // 0..10, root mean square error of the model's rotations; not of photos with true depth (pose_noise.h)
  double pose_noise_m = 0.0;              // 0..100, the same of its camera centres
  // Errors of the tags; none by default. See tag_faults.h.
  double tag_lag_s = 0.0;                // -5..10, the tagged position is where the drone was this long before
  double tag_drift_m = 0.0;              // -1000..1000, rise of the tagged heights from the first to the last photo
  double tag_jump_m = 0.0;               // 0..1000, shift of the tags of the last 40 % of the flight
  double tag_outliers = 0.0;             // 0..0.9, share of the photos
  double tag_outlier_m = 50.0;           // 0..10000, how far they are off
  double tag_bias_m = 0.0;               // 0..100, standard deviation of an error that all tags share, per horizontal axis; vertically 1.5 times that
  double tag_height_offset_m = 0.0;      // -1000..1000, added to all tagged heights
  std::string tag_heights = "true";      // true, zero or none
  bool tags_swapped = false;             // latitude and longitude in each other's place
  bool tags_equal = false;               // every photo has the first one's position
  bool gimbal_tags = true;               // the photos have gimbal angles
  double gimbal_common_error_deg = 0.0;  // 0..10, standard deviation per axis of an error of the gimbal angles that all photos share
  double gimbal_random_error_deg = 0.0;  // 0..10, the same of each photo's own error
  bool speed_tags = false;               // the photos have their speed over ground
  // Ground control; none by default. See control_marks.h and control_writer.h.
  int control_points = 0;              // 0..1000 targets that are painted on the ground, surveyed, and marked in photos
  int check_points = 0;                // 0..1000 more of them, only to compare with
  double control_mark_noise_px = 0.5;  // 0..100, standard deviation of the marks per axis
  int control_marks = 5;               // 2..1000 per point at most
  int control_wrong_points = 0;        // 0..1000 control points with wrong coordinates
  double control_wrong_m = 5.0;        // 0..10000, how far they are off
  int control_wrong_marks = 0;         // 0..1000 marks of the others that are far from their target
  std::string control_crs;             // of the written coordinates, one line; empty: UTM of the place

  static std::vector<config::Field<SimulateOptions>> Fields();
  // Throws base::UsageError that names the option, its value and what is allowed, in general and for this place.
  void Check() const;
};

}  // namespace skyquilt::simulate
