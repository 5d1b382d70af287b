// Brightness from camera settings, and what a change of exposure does to a display value. A photo's exposure is E = t * ISO / (100 * N^2)
// (linear light collected per unit of scene radiance); its gain is E over the survey's median E, so that gain * scene light = what the
// photo recorded.
#pragma once

#include <optional>
#include <vector>

namespace skyquilt::brightness {

// Absent aperture or ISO count as constant over the survey (N = 1, ISO 100); nothing without a positive, finite shutter time.
std::optional<double> ExifExposure(std::optional<double> time_s, std::optional<double> f_number, std::optional<double> iso);

// Natural logarithm of the largest change of exposure that is believed: ten stops. Beyond, a tag is wrong.
constexpr float kMaxLogGain = 6.9314718F;

struct PhotoGains {
  double reference_exposure = 0.0;  // median E of the tagged photos; 0 when none is tagged, and all gains are 1
  std::vector<float> gain;          // per photo, > 0; 1 for photos without tags
  std::vector<bool> known;          // per photo: from its tags
};

// Gains relative to the median, limited to kMaxLogGain.
PhotoGains GainsFromExif(const std::vector<std::optional<double>>& exposures);

// Largest display value a field must be able to show so that the darkest-exposed photo can still be white; within [1, 4].
double ColorRange(const std::vector<float>& gains);

// A change of exposure: linear light times `gain`. Made once for many colours.
struct Exposure {
  float log_gain = 0.0F;
  float gain = 1.0F;
  float root = 1.0F;  // gain^(1 / 2.4): what the gain does to display values above sRGB's linear toe
  static Exposure FromLogGain(float log_gain);
};

// One colour channel of a rendering (display value at reference exposure) as the photo would have recorded it, its derivative by that
// display value, and by log_gain. Finite for any finite input; negative display values count as black.
struct Exposed {
  float value;
  float slope;
  float log_gain_slope;
};
Exposed Expose(float srgb_reference, const Exposure& exposure);

}  // namespace skyquilt::brightness
