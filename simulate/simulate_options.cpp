#include "simulate/simulate_options.h"

#include "simulate/place_spec.h"

namespace skyquilt::simulate {

std::vector<config::Field<SimulateOptions>> SimulateOptions::Fields() {
  using config::Range;
  using O = SimulateOptions;
  return {
      {"place", &O::place, Range::OneOf(PlaceNames()), "what to build"},
      {"seed", &O::seed, Range::AtLeast(0), "same seed, same bytes"},
      {"image_width", &O::image_width, Range{32, 8192}.Or(0), "width of the photos in pixels; 0: the place's"},
      {"forward_overlap", &O::forward_overlap, Range{0, 0.95}.OrNegative(), "share of a photo seen by the next of its line; negative: the place's"},
      {"side_overlap", &O::side_overlap, Range{0, 0.95}.OrNegative(), "share of a photo seen by the next line; negative: the place's"},
      {"altitudes", &O::altitudes, Range{40, 2000},
       "flying heights above ground in metres, one for all blocks or one per block (rows from the south); empty: the place's"},
      {"oblique", &O::oblique, Range(), "fly the place's oblique lines too"},
      {"gps_noise_m", &O::gps_noise_m, Range{0, 1000}.OrNegative(),
       "standard deviation of the tagged position per horizontal axis, metres; negative: the place's"},
      {"exposure_drift_stops", &O::exposure_drift_stops, Range{0, 10}.OrNegative(),
       "slow change of exposure over the flight, +- stops; negative: the place's"},
      {"exposure_jumps_stops", &O::exposure_jumps_stops, Range{0, 10}.OrNegative(), "sudden changes of exposure, +- stops; negative: the place's"},
      {"exposure_offset_stops", &O::exposure_offset_stops, Range{-10, 10}, "exposure of every photo, stops above normal; the tags follow"},
      {"exposure_error_stops", &O::exposure_error_stops, Range{0, 3}, "standard deviation of brightness per photo that its tags do not tell, stops"},
      {"color_drift_stops", &O::color_drift_stops, Range{0, 3},
       "slow wander of the white balance that no tag tells: red up and blue down by at most this, stops"},
      {"vignetting", &O::vignetting, Range{0, 0.9}, "share of light that the lens loses in the corners"},
      {"exposure_tags", &O::exposure_tags, Range::OneOf({"all", "half", "none"}),
       "photos tagged with exposure time, aperture and ISO; half: every second one"},
      {"latitude_deg", &O::latitude_deg, Range{-90, 90}, "latitude of the survey's origin, degrees"},
      {"longitude_deg", &O::longitude_deg, Range{-180, 180}, "longitude of the survey's origin, degrees"},
      {"height_m", &O::height_m, Range{-500, 9000}, "ellipsoidal height of the origin, metres"},
      {"test_every", &O::test_every, Range{1, 1000000}, "every n-th photo in name order gets a true depth image"},
      {"moving_cars", &O::moving_cars, Range{0, 1000}.OrNegative(), "cars that move between photos; negative: the place's"},
      {"sun_azimuth_deg", &O::sun_azimuth_deg, Range{0, 360}.OrNegative(), "clockwise from north; negative: the place's"},
      {"sun_elevation_deg", &O::sun_elevation_deg, Range{5, 90}.OrNegative(), "above the horizon; negative: the place's"},
      {"light_intensity", &O::light_intensity, Range{1e-3, 1e3}, "scales sun and sky"},
      {"samples_per_pixel", &O::samples_per_pixel, Range::OneOf({1, 4, 16}), "rays per pixel"},
      {"soft_shadows", &O::soft_shadows, Range(), "spread the shadow rays over the sun's disc"},
      {"jpeg_quality", &O::jpeg_quality, Range{1, 100}, "quality of the JPEG files"},
  };
}

void SimulateOptions::Check() const {
  ResolvePlace(*this);
}

}  // namespace skyquilt::simulate
