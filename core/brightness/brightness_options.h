// [brightness] in the configuration: which differences in brightness between photos are corrected, and how. Without correction the field bakes them
// into its colours or explains them with floaters.
#pragma once

#include <string>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::brightness {

struct BrightnessOptions {
  std::string correction = "exif,gain,vignette";  // list of exif, gain, vignette, shading, luminance, separated by commas; or none
  std::string shading_grid = "8x6";               // knots along width and height of a photo, each 2 to 32 (shading.h)
  double shading_sigma = 0.5;                     // stops, > 0: how much light differs within a photo
  // The rest is for the concealing field (luminance.h), which `correction` turns on by "luminance".
  std::string luminance_mode = "auto";         // under, over, or auto: decided from the photos
  double target_brightness = 0.4;              // mean display value of the rendering shown to people
  std::string luminance_form = "gain";         // gain: Omega dims its own sample only; product: the Omegas multiply along the ray
  std::string luminance_loss = "toned";        // toned: photos are compared after the inverse tone curve (tone_curve.h); plain: as they are
  std::string luminance_neighbours = "patch";  // pixels that the convolution runs over: patch (neighbouring) or batch (unrelated)

  static std::vector<config::Field<BrightnessOptions>> Fields();
  // Throws base::UsageError that names the option and its allowed values.
  void Check() const;

  // Whether `correction` lists ...
  bool Exif() const { return Has("exif"); }
  bool Gain() const { return Has("gain"); }
  bool Vignette() const { return Has("vignette"); }
  bool Shading() const { return Has("shading"); }
  bool Luminance() const { return Has("luminance"); }

 private:
  bool Has(const std::string& name) const;
};

}  // namespace skyquilt::brightness
