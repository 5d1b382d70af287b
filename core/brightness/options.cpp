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

void RequireOneOf(const std::string& key, const std::string& given, const std::vector<std::string>& choices) {
  if (std::find(choices.begin(), choices.end(), given) != choices.end()) return;
  throw base::UsageError("brightness." + key + " = '" + given + "' cannot be: choose one of " + base::Join(choices));
}

}  // namespace

void BrightnessOptions::Visit(config::OptionVisitor& v) {
  v.Field("correction", correction,
          "none, or any of exif (shutter, aperture and ISO of each photo), gain (what they miss, learned per photo and colour), vignette (darker "
          "corners, learned per camera), luminance (concealing field of under- or over-exposed surveys), separated by commas");
  v.Field("luminance_mode", luminance_mode, "under, over, or auto: what the photos' brightness says; normally exposed surveys then do without");
  v.Field("target_brightness", target_brightness, "mean display value that the luminance field brings a survey to, 0.1..0.9");
  v.Field("luminance_form", luminance_form, "gain: each sample's own factor; product: factors multiply along the ray (tidal-flat paper, eq. 13)");
  v.Field("luminance_neighbours", luminance_neighbours,
          "what the convolution of width 7 runs over: patch (neighbouring pixels) or batch (unrelated pixels, as in published code)");
}

void BrightnessOptions::Check() const {
  const std::vector<std::string> rungs = Rungs(correction);
  if (rungs.empty()) throw base::UsageError("brightness.correction is empty: give none, or any of exif, gain, vignette, luminance");
  for (const std::string& rung : rungs) {
    if (rung == "none" && rungs.size() > 1) throw base::UsageError("brightness.correction = '" + correction + "' cannot be: none stands alone");
    RequireOneOf("correction", rung, {"none", "exif", "gain", "vignette", "luminance"});
  }
  RequireOneOf("luminance_mode", luminance_mode, {"auto", "under", "over"});
  RequireOneOf("luminance_form", luminance_form, {"gain", "product"});
  RequireOneOf("luminance_neighbours", luminance_neighbours, {"patch", "batch"});
  if (!(target_brightness >= 0.1 && target_brightness <= 0.9)) {
    throw base::UsageError("brightness.target_brightness = " + std::to_string(target_brightness) + " cannot be: give a number from 0.1 to 0.9");
  }
}

bool BrightnessOptions::Has(const std::string& rung) const {
  for (const std::string& one : Rungs(correction)) {
    if (one == rung) return true;
  }
  return false;
}

}  // namespace skyquilt::brightness
