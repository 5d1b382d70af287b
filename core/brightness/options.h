// [brightness] in the configuration: what is done about exposure differences between photos.
#pragma once

#include <string>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::brightness {

struct BrightnessOptions {
  std::string correction = "exif,gain,vignette";
  std::string luminance_mode = "auto";
  double target_brightness = 0.4;
  std::string luminance_form = "gain";
  std::string luminance_neighbours = "patch";

  static std::vector<config::Field<BrightnessOptions>> Fields();
  // Throws base::UsageError naming the option and what it may be.
  void Check() const;

  bool Exif() const { return Has("exif"); }
  bool Gain() const { return Has("gain"); }
  bool Vignette() const { return Has("vignette"); }
  bool Luminance() const { return Has("luminance"); }

 private:
  bool Has(const std::string& rung) const;
};

}  // namespace skyquilt::brightness
