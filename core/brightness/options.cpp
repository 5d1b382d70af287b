#include "core/brightness/options.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include "core/base/errors.h"
#include "core/base/text.h"

namespace skyquilt::brightness {
namespace {

std::vector<std::string> Rungs(const std::string& list) {
  std::vector<std::string> rungs;
  std::istringstream stream(list);
  for (std::string part; std::getline(stream, part, ',');) {
    const size_t first = part.find_first_not_of(' ');
    if (first != std::string::npos) rungs.push_back(part.substr(first, part.find_last_not_of(' ') - first + 1));
  }
  return rungs;
}

}  // namespace

std::vector<config::Field<BrightnessOptions>> BrightnessOptions::Fields() {
  using config::Range;
  using O = BrightnessOptions;
  return {
      {"correction", &O::correction, Range(),
       "none, or any of exif (shutter, aperture and ISO of each photo), gain (what they miss, learned per photo and colour), vignette (darker "
       "corners, learned per camera), luminance (concealing field of under- or over-exposed surveys), separated by commas"},
      {"luminance_mode", &O::luminance_mode, Range::OneOf({"auto", "under", "over"}),
       "which way the survey is badly exposed; auto: what the photos' brightness says, normally exposed surveys then do without"},
      {"target_brightness", &O::target_brightness, Range{0.1, 0.9}, "mean display value that the luminance field brings a survey to"},
      {"luminance_form", &O::luminance_form, Range::OneOf({"gain", "product"}),
       "gain: each sample's own factor; product: factors multiply along the ray (tidal-flat paper, eq. 13)"},
      {"luminance_neighbours", &O::luminance_neighbours, Range::OneOf({"patch", "batch"}),
       "what the convolution of width 7 runs over: patch (neighbouring pixels) or batch (unrelated pixels, as in published code)"},
  };
}

void BrightnessOptions::Check() const {
  config::CheckRanges("brightness", *this);
  const config::Range known = config::Range::OneOf({"none", "exif", "gain", "vignette", "luminance"});
  const std::vector<std::string> rungs = Rungs(correction);
  if (rungs.empty()) throw base::UsageError("brightness.correction is empty: give none, or any of exif, gain, vignette, luminance");
  for (const std::string& rung : rungs) {
    if (rung == "none" && rungs.size() > 1) {
      throw base::UsageError("brightness.correction = '" + correction + "' is not allowed: none cannot be combined with others");
    }
    if (!known.Contains(rung)) throw base::UsageError("brightness.correction = '" + rung + "' is not allowed: choose any of " + known.Text());
  }
}

bool BrightnessOptions::Has(const std::string& rung) const {
  for (const std::string& one : Rungs(correction)) {
    if (one == rung) return true;
  }
  return false;
}

}  // namespace skyquilt::brightness
