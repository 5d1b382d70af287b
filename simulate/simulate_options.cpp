#include "simulate/simulate_options.h"

#include "core/geo/enu_frame.h"
#include "simulate/flight.h"
#include "simulate/flights/flight_settings.h"
#include "simulate/place_spec.h"
#include "simulate/simulate.h"
#include "simulate/true_orthophoto.h"

namespace skyquilt::simulate {

std::vector<config::Field<SimulateOptions>> SimulateOptions::Fields() {
  using config::Range;
  using O = SimulateOptions;
  // Only tests and benches need them: tests/simulate/faults.toml shows them.
  constexpr config::Written kFault = config::Written::kWhenChanged;
  return {
      {"place", &O::place, Range::OneOf(PlaceNames()), "the invented place to survey"},
      {"flight", &O::flight, Range::OneOf(FlightNames()),
       "survey: from above, in lines; level flights: facade, along the longest house front; orbit, round a building; street, along a road; room, "
       "inside one room instead of the place"},
      {"photos", &O::photos, Range{3, 1000}.Or(0), "number of photos of a level flight; 0: facade 12, orbit 40, street 60, room 50"},
      {"tags", &O::tags, Range::OneOf({"auto", "all", "none"}),
       "tags of position, heights and gimbal angles; auto: all of a survey, none of a level flight, as a phone without GPS"},
      {"seed", &O::seed, Range::AtLeast(0), "random seed; the same seed gives the same files"},
      {"image_width", &O::image_width, Range{32, 8192}.Or(0), "width of the photos in pixels; 0: the place's width"},
      {"forward_overlap", &O::forward_overlap, Range{0, 0.95}.OrNegative(),
       "fraction of a photo that the next photo of the line sees too; negative: the place's value"},
      {"side_overlap", &O::side_overlap, Range{0, 0.95}.OrNegative(), "fraction of a photo that the next line sees too; negative: the place's value"},
      {"altitudes", &O::altitudes, Range{40, 2000},
       "flying heights above ground in metres, one for all blocks or one per block (rows from the south); empty: the place's values"},
      {"oblique", &O::oblique, Range(), "also take the place's oblique photos"},
      {"gps_noise_m", &O::gps_noise_m, Range{0, 1000}.OrNegative(),
       "standard deviation of the tagged position per horizontal axis, metres; negative: the place's value"},
      {"exposure_drift_stops", &O::exposure_drift_stops, Range{0, 10}.OrNegative(),
       "slow change of exposure over the flight, at most +- this many stops; negative: the place's value"},
      {"exposure_jumps_stops", &O::exposure_jumps_stops, Range{0, 10}.OrNegative(),
       "sudden changes of exposure, at most +- this many stops; negative: the place's value"},
      {"exposure_offset_stops", &O::exposure_offset_stops, Range{-10, 10}, "exposure of all photos, stops above normal; recorded in the tags"},
      {"exposure_error_stops", &O::exposure_error_stops, Range{0, 3},
       "standard deviation of each photo's brightness error in stops; not recorded in the tags"},
      {"color_drift_stops", &O::color_drift_stops, Range{0, 3},
       "slow drift of the white balance, red against blue, at most +- this many stops; not recorded in the tags"},
      {"vignetting", &O::vignetting, Range{0, 0.9}, "fraction of light that the lens loses in the corners"},
      {"exposure_tags", &O::exposure_tags, Range::OneOf({"all", "half", "none"}),
       "photos with exposure time, aperture and ISO in their tags; half: every second one"},
      {"latitude_deg", &O::latitude_deg, Range{-90, 90}, "latitude of the survey's origin, degrees"},
      {"longitude_deg", &O::longitude_deg, Range{-180, 180}, "longitude of the survey's origin, degrees"},
      {"height_m", &O::height_m, Range{-500, 9000}, "ellipsoidal height of the origin, metres"},
      {"test_every", &O::test_every, Range{1, 1000000}, "every n-th photo in name order gets a true depth image"},
      {"moving_cars", &O::moving_cars, Range{0, 1000}.OrNegative(), "number of cars that move between photos; negative: the place's value"},
      {"people", &O::people, Range{0, 1000}, "number of people who walk on the pavements, at another place in every photo"},
      {"lamps", &O::lamps, Range{0, 1000}, "number of street lamps, as far as there is room"},
      {"class_images", &O::class_images, Range::OneOf({"test", "all"}),
       "photos of which truth/classes/ says what each pixel shows; test: those with a true depth image; all: to train a network that finds what "
       "moves"},
      {"sun_azimuth_deg", &O::sun_azimuth_deg, Range{0, 360}.OrNegative(),
       "direction of the sun in degrees clockwise from north; negative: the place's value"},
      {"sun_elevation_deg", &O::sun_elevation_deg, Range{5, 90}.OrNegative(),
       "height of the sun in degrees above the horizon; negative: the place's value"},
      {"light_intensity", &O::light_intensity, Range{1e-3, 1e3}, "factor on the light of sun and sky"},
      {"cloud_shadows", &O::cloud_shadows, Range{0, 5},
       "shadows of clouds that drift over the ground take so many stops of the sun's light; the truth is written without them; 0: none"},
      {"cloud_size_m", &O::cloud_size_m, Range{10, 5000}, "about how far shadows of clouds are apart, metres"},
      {"cloud_penumbra_m", &O::cloud_penumbra_m, Range{1, 500}, "width of the edges of these shadows on the ground, metres; real ones have 20 to 60"},
      {"cloud_speed_ms", &O::cloud_speed_ms, Range{0, 50}, "speed of these shadows in metres per second, in a direction from the seed"},
      {"cloud_cover", &O::cloud_cover, Range{0.05, 0.95}, "share of the ground that lies in these shadows"},
      {"lights", &O::lights, Range::OneOf({"one", "sun", "intensity"}),
       "one: all photos in the same light; sun: every photo again with the sun at 5, 10 ... 85 degrees above the horizon, in the folders sun_05 to "
       "sun_85 of images/; intensity: every photo again in 1, 1.25 ... 3 times the light, in the folders light_1.00 to light_3.00. The flight is "
       "cut to a multiple of test_every photos, so that every light has the same held-out places"},
      {"lights_every", &O::lights_every, Range{1, 8}, "only the first of these lights and every n-th after it"},
      {"samples_per_pixel", &O::samples_per_pixel, Range::OneOf({1, 4, 16}), "rays per pixel"},
      {"soft_shadows", &O::soft_shadows, Range(), "spread the shadow rays over the sun's disc"},
      {"jpeg_quality", &O::jpeg_quality, Range{1, 100}, "quality of the JPEG files"},
      {"single_line", &O::single_line, Range(), "fly only one straight line, from south to north through the middle, looking straight down"},
      {"hillside_deg", &O::hillside_deg, Range{0, 45},
       "slope of the whole terrain in degrees, rising to the north-east; the flight keeps its height above take-off"},
      {"city_yaw_deg", &O::city_yaw_deg, Range{0, 360}.OrNegative(),
       "direction of the streets in degrees counter-clockwise from east; negative: random, from the seed"},
      {"district_turn_deg", &O::district_turn_deg, Range{0, 12}.OrNegative(),
       "turn of the buildings in one half of the city relative to the streets, degrees; negative: 8 to 12 to one side, from the seed"},
      {"building_shapes", &O::building_shapes, Range::OneOf({"plain", "varied"}),
       "plain: every building is a rectangle; varied: also wings, set-backs, rows of houses, courtyards, garages, overhangs of 0.1 to 0.8 m, and "
       "trees "
       "against walls"},
      {"tower_m", &O::tower_m, Range{20, 200}.Or(0),
       "height in metres of one tower in the middle of the place, which the flight must clear by 10 m; 0: none"},
      {"building_share", &O::building_share, Range{0, 1},
       "share of the cells between streets that keep their buildings; the others are woods; 0: a place without buildings"},
      {"tree_density", &O::tree_density, Range{0, 10}, "factor on the number of trees; 0: none"},
      {"bridge", &O::bridge, Range(),
       "a bridge, which is no building: deck and ramps of a street, 5 to 6 m above a crossing in the middle of the place"},
      {"trucks", &O::trucks, Range{0, 100},
       "number of trucks and containers parked in the streets, 8 m long and 3.5 m high, as far as there is room; they are no buildings"},
      {"marsh", &O::marsh, Range(), "tidalflat: plants of a salt marsh on the high sand, and trees; other places have none"},
      {"ortho_cell_m", &O::ortho_cell_m, Range{0.005, 10}.Or(0),
       "also write the true orthophoto, straight from above and without moving cars, with cells of this many metres; 0: none"},
      {"video_fps", &O::video_fps, Range{1, 60}.Or(0),
       "also film the flight of a survey, with so many frames per second, and write subtitles with place and heights as drones do; 0: no video"},
      {"panoramas", &O::panoramas, Range{0, 10000},
       "also write so many panoramas, level, from places evenly chosen along the flight, with the tags of 360-degree cameras; 0: none"},
      {"panorama_width", &O::panorama_width, Range{64, 16384}.MultipleOf(2), "width of the panoramas in pixels; their height is half of it"},
      {"edge_targets", &O::edge_targets, Range{0, 100},
       "number of slanted-edge targets on open ground, half black and half white, to measure the sharpness of maps and photos"},
      {"exact_frame", &O::exact_frame, Range(),
       "COLMAP model in the true frame in metres; false: turned, scaled and shifted at random, as structure from motion makes it"},
      {"pose_noise_deg", &O::pose_noise_deg, Range{0, 10},
       "root mean square error of the rotations in the COLMAP model, degrees; photos with true depth keep theirs, so that scores measure the scene",
       kFault},
      {"pose_noise_m", &O::pose_noise_m, Range{0, 100}, "the same of the camera centres, metres", kFault},
      {"tag_lag_s", &O::tag_lag_s, Range{-5, 10}, "tagged positions are those of this many seconds before the photo", kFault},
      {"tag_drift_m", &O::tag_drift_m, Range{-1000, 1000}, "tagged heights rise evenly by this many metres from the first to the last photo", kFault},
      {"tag_jump_m", &O::tag_jump_m, Range{0, 1000},
       "tagged positions of the last 40 % of the flight are off by this many metres in a random horizontal direction, and upwards by half of it",
       kFault},
      {"tag_outliers", &O::tag_outliers, Range{0, 0.9}, "share of the photos, chosen at random, whose tagged positions are wrong by tag_outlier_m",
       kFault},
      {"tag_outlier_m", &O::tag_outlier_m, Range{0, 10000}, "error of these positions in metres, each in a random direction in space", kFault},
      {"tag_bias_m", &O::tag_bias_m, Range{0, 100},
       "standard deviation per horizontal axis of an error that all tagged positions share, metres; vertically 1.5 times that", kFault},
      {"tag_height_offset_m", &O::tag_height_offset_m, Range{-1000, 1000}, "added to all tagged heights, as by another height datum, metres", kFault},
      {"tag_heights", &O::tag_heights, Range::OneOf({"true", "zero", "none"}), "tagged heights, above take-off too: as measured, 0, or not tagged",
       kFault},
      {"tags_swapped", &O::tags_swapped, Range(), "latitude and longitude in each other's place in the tags", kFault},
      {"tags_equal", &O::tags_equal, Range(), "every photo is tagged with the position of the first", kFault},
      {"gimbal_tags", &O::gimbal_tags, Range(), "tag the gimbal's angles", kFault},
      {"gimbal_common_error_deg", &O::gimbal_common_error_deg, Range{0, 10},
       "standard deviation per axis of a tilt that all tagged gimbal angles share, degrees", kFault},
      {"gimbal_random_error_deg", &O::gimbal_random_error_deg, Range{0, 10},
       "standard deviation per axis of each photo's own error of the tagged gimbal angles, degrees", kFault},
      {"speed_tags", &O::speed_tags, Range(), "tag the speed over ground", kFault},
      {"control_points", &O::control_points, Range{0, 1000},
       "number of ground control points: targets that show in the photos; their coordinates and marks are written to control/"},
      {"check_points", &O::check_points, Range{0, 1000}, "number of check points, targets like those of the control points"},
      {"control_mark_noise_px", &O::control_mark_noise_px, Range{0, 100}, "standard deviation of the marks per axis, pixels"},
      {"control_marks", &O::control_marks, Range{2, 1000}, "marks per point at most, each in another photo"},
      {"control_wrong_points", &O::control_wrong_points, Range{0, 1000}, "number of control points whose written coordinates are wrong", kFault},
      {"control_wrong_m", &O::control_wrong_m, Range{0, 10000}, "error of these in metres, each in a random direction in space", kFault},
      {"control_wrong_marks", &O::control_wrong_marks, Range{0, 1000}, "number of marks of other control points that are far from their target",
       kFault},
      {"control_crs", &O::control_crs, Range(),
       "coordinate system of the written points, such as EPSG:2263; empty: UTM of the place; heights are ellipsoidal"},
  };
}

void SimulateOptions::Check() const {
  const PlaceSpec resolved = ResolvePlace(*this);
  if (ortho_cell_m == 0.0) return;
  const geo::EnuFrame frame({latitude_deg, geo::WrapLongitudeDeg(longitude_deg), height_m});
  PlanTrueOrthophoto(resolved, PlanFlight(resolved, 0.0), 0.0, frame, ortho_cell_m);
}

}  // namespace skyquilt::simulate
