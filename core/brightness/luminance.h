// Photos of an under- or over-exposed survey are too dark or too bright to show as they are. The concealing field learns a second rendering with a
// given mean brightness beside the one that matches the photos (tidal-flat paper, after Aleth-NeRF, Cui et al. 2024).
// Every sample has one density, one colour and a factor Omega in (0, 1). The plain rendering uses the colours as they are; the concealed rendering
// dims the light of the samples by Omega and is therefore darker.
//   under-exposed: the concealed rendering matches the photos, the plain one is shown to people
//   over-exposed:  the plain rendering matches the photos, the concealed one is shown to people
#pragma once

#include <cstdint>
#include <string>

#include "core/brightness/brightness_options.h"
#include "core/checkpoint/archive.h"

namespace skyquilt::brightness {

enum class LuminanceMode { kNone, kUnder, kOver };

struct Luminance {
  LuminanceMode mode = LuminanceMode::kNone;
  bool product = false;         // true: the Omegas multiply along the ray (eq. 13); false: each Omega dims its own sample only
  bool toned = true;            // photos are compared after the inverse tone curve (tone_curve.h); false: as they are
  bool patches = true;          // true: the convolution runs over neighbouring pixels; false: over unrelated pixels
  double target = 0.4;          // mean display value of the rendering shown to people, 0..1
  double start_log_gain = 0.0;  // natural logarithm of the Omega that relates the photos' mean to the target, < 0

  bool On() const { return mode != LuminanceMode::kNone; }
};

// Statistics of a survey's photos from which badly exposed surveys are recognised.
struct BrightnessStatistics {
  double mean_srgb = 0.0;  // mean display value as recorded, 0..1
  double clipped = 0.0;    // share of pixels with a saturated colour channel
};

// Mode as set in the options. "auto": under when the mean is below 0.2; over when the mean is above 0.75 or more than a tenth of the pixels are
// clipped; otherwise none.
Luminance PlanLuminance(const BrightnessOptions& options, const BrightnessStatistics& statistics);

// Running means over training rays, which renderings need as well.
struct LuminanceState {
  double mean_shown = 0.0;     // display value of the rendering shown to people
  double mean_log_gain = 0.0;  // log Omega
};

// Stored as "luminance_..." attributes; files without them give LuminanceMode::kNone.
void PutLuminance(const Luminance& luminance, const LuminanceState& state, checkpoint::ArchiveWriter& writer);
void GetLuminance(const checkpoint::ArchiveReader& reader, Luminance* luminance, LuminanceState* state);

}  // namespace skyquilt::brightness
