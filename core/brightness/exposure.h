// Brightness from camera settings. A photo's exposure is E = t * ISO / (100 * N^2) (linear light collected per unit of scene radiance);
// its gain is E over the survey's median E, so that gain * scene light = what the photo recorded.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::brightness {

struct BrightnessOptions {
  std::string correction = "exif";  // "exif" or "none"
  void Visit(config::OptionVisitor& v) {
    v.Field("correction", correction, "exif: divide out shutter, aperture and ISO of each photo in linear light; none: colours as photographed");
  }
};

// Absent aperture or ISO count as constant over the survey (N = 1, ISO 100); nothing without a positive, finite shutter time.
std::optional<double> ExifExposure(std::optional<double> time_s, std::optional<double> f_number, std::optional<double> iso);

struct PhotoGains {
  double reference_exposure = 0.0;  // median E of the tagged photos; 0 when fewer than half are tagged and all gains are 1
  std::vector<float> gain;          // per photo, > 0; 1 for photos without tags
};

// Gains relative to the median. Ratios are limited to +-10 stops: beyond, a tag is wrong.
PhotoGains GainsFromExif(const std::vector<std::optional<double>>& exposures);

// Largest display value a field must be able to show so that the darkest-exposed photo can still be white; within [1, 4].
double ColorRange(const std::vector<float>& gains);

// One colour channel of a rendering (display value at reference exposure) as the photo would have recorded it, and d out / d in.
struct Exposed {
  float value;
  float slope;
};
Exposed Expose(float srgb_reference, float gain);

}  // namespace skyquilt::brightness
