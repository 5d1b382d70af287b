// The concealing field of a badly exposed survey (tidal-flat paper, after Aleth-NeRF). One density, one colour, and a factor Omega in (0, 1) for
// every sample; two renderings come from them. The plain one has the field's own colours; in the concealed one the samples' light is held
// back by Omega. Under-exposed: the concealed rendering is what the photos recorded and the plain one shows the scene as it should look.
// Over-exposed: the other way round.
#pragma once

#include <cstdint>
#include <string>

#include "core/brightness/options.h"
#include "core/checkpoint/archive.h"

namespace skyquilt::brightness {

enum class LuminanceMode { kNone, kUnder, kOver };

struct Luminance {
  LuminanceMode mode = LuminanceMode::kNone;
  bool product = false;         // Omegas multiply along the ray (eq. 13) instead of each holding back its own sample's light
  bool patches = true;          // the convolution runs over neighbouring pixels instead of over unrelated ones
  double target = 0.4;          // mean display value of the shown rendering
  double start_log_gain = 0.0;  // natural logarithm of the Omega that brings the photos' mean to the target, < 0

  bool On() const { return mode != LuminanceMode::kNone; }
};

// What a survey's photos look like.
struct BrightnessStatistics {
  double mean_srgb = 0.0;  // display values as recorded
  double clipped = 0.0;    // share of pixels with a colour at the top of the scale
};

// Mode as the options ask; "auto" takes under below a mean of 0.2 and over where the mean is above 0.75 or a tenth of the pixels is clipped.
Luminance PlanLuminance(const BrightnessOptions& options, const BrightnessStatistics& statistics);

// What training keeps track of, and renderings need: a running mean of the shown display values and of log Omega.
struct LuminanceState {
  double mean_shown = 0.0;
  double mean_log_gain = 0.0;
};

// Under "luminance_..." attributes; files without them have LuminanceMode::kNone.
void PutLuminance(const Luminance& luminance, const LuminanceState& state, checkpoint::ArchiveWriter& writer);
void GetLuminance(const checkpoint::ArchiveReader& reader, Luminance* luminance, LuminanceState* state);

}  // namespace skyquilt::brightness
