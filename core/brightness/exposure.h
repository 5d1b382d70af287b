// The same place is brighter in a photo with a longer exposure. To compare renderings with photos, this header computes a photo's gain from its
// camera settings and applies a gain to display values.
// Exposure: E = t * ISO / (100 * N^2), t shutter time in seconds, N f-number: linear light collected per unit of scene radiance.
// Gain: E over the median E of the survey's training photos, so that recorded linear light = gain * scene light.
#pragma once

#include <array>
#include <optional>
#include <vector>

namespace skyquilt::brightness {

// E of a photo. A missing f-number or ISO is taken as constant over the survey (N = 1, ISO 100). Empty without a positive, finite shutter time.
std::optional<double> ExifExposure(std::optional<double> time_s, std::optional<double> f_number, std::optional<double> iso);

// Natural logarithm of the largest accepted gain: ten stops. Tags that ask for more are wrong.
constexpr float kMaxLogGain = 6.9314718F;

struct PhotoGains {
  double reference_exposure = 0.0;  // median E of the tagged training photos; 0 when none is tagged, and all gains are 1
  std::vector<float> gain;          // per photo, > 0; 1 for photos without tags
  std::vector<bool> known;          // per photo: whether its gain comes from its tags
};

// Gains relative to the median exposure of the training photos, limited to +-kMaxLogGain. Both arguments have one entry per photo; an empty exposure
// means no tags. Without a tagged training photo no gain is known: held-out photos alone must not decide the brightness of the scene.
PhotoGains GainsFromExif(const std::vector<std::optional<double>>& exposures, const std::vector<bool>& in_training);

// Largest display value a field's colours must reach so that the photo with the smallest gain can still record white; within [1.02, 4].
double ColorRange(const std::vector<float>& gains);

// A change of exposure: multiplies linear light by `gain`. Computed once and applied to many colours.
struct Exposure {
  float log_gain = 0.0F;
  float gain = 1.0F;
  float root = 1.0F;  // gain^(1 / 2.4): factor on (display value + 0.055) above sRGB's linear toe
  static Exposure FromLogGain(float log_gain);
};

// One colour channel of a rendering as a photo with this exposure would have recorded it, with derivatives.
struct Exposed {
  float value;           // display value
  float slope;           // d value / d srgb_reference
  float log_gain_slope;  // d value / d log_gain
};
// srgb_reference: display value at reference exposure; negative values count as black. Finite for any finite input.
Exposed Expose(float srgb_reference, const Exposure& exposure);
// The values of red, green and blue, in place.
void Expose(const std::array<Exposure, 3>& exposure, float (&rgb_srgb)[3]);

}  // namespace skyquilt::brightness
