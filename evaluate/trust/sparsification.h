// How well a measure of doubt puts pixels in the order of their errors: the area under the sparsification error curve (AUSE; Ilg et al. 2018,
// "Uncertainty estimates and multi-hypotheses networks for optical flow", section 4.1).
#pragma once

#include <span>
#include <vector>

#include "core/base/packed_bytes.h"

namespace skyquilt::evaluate::trust {

// Covered pixels of held-out photos: their error, and what may foretell it. All lists have the same length.
struct TrustPixels {
  std::vector<float> squared_error;  // mean over the colours, display values from 0 to 1
  std::vector<float> expected;       // error that trust expects
  std::vector<float> photos;         // training photos that show the place
  std::vector<float> gradient;       // of the rendering, display values per pixel
  std::vector<float> opacity;

  void Add(const TrustPixels& more);
  void Save(base::BytePacker* out) const;
  void Load(base::ByteUnpacker* in);
};

// Root mean square error of the pixels that are left after the most doubtful share is taken away, for 0, 1 to 99 hundredths, divided by that of all,
// minus the same for the true order; mean over the shares. 0: the true order; lower is better. Pixels of equal doubt are taken in their order in the
// list, so lists should not be sorted by error. NaN without pixels or without any error. doubt: higher is worse.
double Ause(std::span<const float> doubt, std::span<const float> squared_error);

// How trust does on pixels of photos that nothing was learned from. NaN: not measured.
struct TrustScores {
  size_t pixels = 0;
  double ause = 0.0, ause_photos = 0.0, ause_gradient = 0.0, ause_opacity = 0.0;  // by trust, by few photos, by gradient, by low opacity
  double least_over_most = 0.0;  // mean squared error of the tenth trusted least over that of the tenth trusted most
  double expected_rms = 0.0;     // root mean square of the errors expected, and of those that were found
  double found_rms = 0.0;
};
TrustScores ScoreTrust(const TrustPixels& pixels);

}  // namespace skyquilt::evaluate::trust
