#include "simulate/simulate_options.h"

#include "simulate/place_spec.h"

namespace skyquilt::simulate {

std::vector<config::Field<SimulateOptions>> SimulateOptions::Fields() {
  using config::Range;
  using O = SimulateOptions;
  return {
      {"place", &O::place, Range::OneOf(PlaceNames()), "the invented place to survey"},
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
      {"sun_azimuth_deg", &O::sun_azimuth_deg, Range{0, 360}.OrNegative(),
       "direction of the sun in degrees clockwise from north; negative: the place's value"},
      {"sun_elevation_deg", &O::sun_elevation_deg, Range{5, 90}.OrNegative(),
       "height of the sun in degrees above the horizon; negative: the place's value"},
      {"light_intensity", &O::light_intensity, Range{1e-3, 1e3}, "factor on the light of sun and sky"},
      {"samples_per_pixel", &O::samples_per_pixel, Range::OneOf({1, 4, 16}), "rays per pixel"},
      {"soft_shadows", &O::soft_shadows, Range(), "spread the shadow rays over the sun's disc"},
      {"jpeg_quality", &O::jpeg_quality, Range{1, 100}, "quality of the JPEG files"},
  };
}

void SimulateOptions::Check() const {
  ResolvePlace(*this);
}

}  // namespace skyquilt::simulate
