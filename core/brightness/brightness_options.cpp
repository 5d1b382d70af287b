#include "core/brightness/brightness_options.h"

#include <sstream>

#include "core/base/errors.h"
#include "core/brightness/shading.h"

namespace skyquilt::brightness {
namespace {

std::vector<std::string> Listed(const std::string& list) {
  std::vector<std::string> names;
  std::istringstream stream(list);
  for (std::string part; std::getline(stream, part, ',');) {
    const size_t first = part.find_first_not_of(' ');
    if (first != std::string::npos) names.push_back(part.substr(first, part.find_last_not_of(' ') - first + 1));
  }
  return names;
}

}  // namespace

std::vector<config::Field<BrightnessOptions>> BrightnessOptions::Fields() {
  using config::Range;
  using O = BrightnessOptions;
  return {
      {"correction", &O::correction, Range(),
       "brightness corrections, separated by commas: exif (shutter time, aperture and ISO of each photo), gain (the remaining differences, learned "
       "per photo and colour), vignette (darker corners, learned per camera), shading (shadows of clouds, smooth over each photo, learned), "
       "luminance "
       "(concealing field for under- or over-exposed surveys); or none"},
      {"shading_grid", &O::shading_grid, Range(), "knots of the shading along a photo's width and height, each 2 to 32"},
      {"shading_sigma", &O::shading_sigma, Range{0.01, 3},
       "by how many stops light typically differs within a photo; shading is kept near 0 and smooth by it"},
      {"luminance_mode", &O::luminance_mode, Range::OneOf({"auto", "under", "over"}),
       "whether luminance treats the survey as under- or over-exposed; auto: decided from the photos' brightness, off for a normally exposed survey"},
      {"target_brightness", &O::target_brightness, Range{0.1, 0.9}, "mean display value of the rendering that luminance brightens or darkens"},
      {"luminance_form", &O::luminance_form, Range::OneOf({"gain", "product"}),
       "gain: the concealing factor of a sample dims this sample only; product: the factors multiply along the ray (tidal-flat paper, eq. 13)"},
      {"luminance_loss", &O::luminance_loss, Range::OneOf({"toned", "plain"}),
       "toned: the concealing field compares photos after a curve that spreads dark and bright values (tidal-flat paper, eq. 14); plain: display "
       "values as they are, for comparison"},
      {"luminance_neighbours", &O::luminance_neighbours, Range::OneOf({"patch", "batch"}),
       "pixels that the convolution of the concealing field runs over: patch (neighbouring pixels) or batch (unrelated pixels, as in published "
       "code)"},
  };
}

void BrightnessOptions::Check() const {
  config::CheckRanges("brightness", *this);
  if (!ShadingGrid::Parse(shading_grid)) {
    throw base::UsageError("brightness.shading_grid = '" + shading_grid +
                           "' is not allowed: give the knots along width and height, each 2 to 32, such as 8x6");
  }
  const config::Range known = config::Range::OneOf({"none", "exif", "gain", "vignette", "shading", "luminance"});
  const std::vector<std::string> names = Listed(correction);
  if (names.empty()) throw base::UsageError("brightness.correction is empty: give none, or any of exif, gain, vignette, shading, luminance");
  for (const std::string& name : names) {
    if (name == "none" && names.size() > 1) {
      throw base::UsageError("brightness.correction = '" + correction +
                             "' is not allowed: none cannot be combined with others. Remove none, or give it alone");
    }
    if (!known.Contains(name)) throw base::UsageError("brightness.correction = '" + name + "' is not allowed: choose any of " + known.Text());
  }
}

bool BrightnessOptions::Has(const std::string& name) const {
  for (const std::string& listed : Listed(correction)) {
    if (listed == name) return true;
  }
  return false;
}

}  // namespace skyquilt::brightness
