#include "core/brightness/exposure.h"

#include <algorithm>
#include <cmath>

#include "core/image/srgb.h"

namespace skyquilt::brightness {

std::optional<double> ExifExposure(std::optional<double> time_s, std::optional<double> f_number, std::optional<double> iso) {
  const auto usable = [](std::optional<double> v) { return v && std::isfinite(*v) && *v > 0.0; };
  if (!usable(time_s)) return std::nullopt;
  const double aperture = usable(f_number) ? *f_number : 1.0;
  const double sensitivity = usable(iso) ? *iso : 100.0;
  return *time_s * sensitivity / (100.0 * aperture * aperture);
}

PhotoGains GainsFromExif(const std::vector<std::optional<double>>& exposures) {
  PhotoGains result;
  result.gain.assign(exposures.size(), 1.0F);
  std::vector<double> known;
  for (const auto& exposure : exposures) {
    if (exposure) known.push_back(*exposure);
  }
  if (known.empty() || known.size() * 2 < exposures.size()) return result;
  std::nth_element(known.begin(), known.begin() + static_cast<ptrdiff_t>(known.size() / 2), known.end());
  result.reference_exposure = known[known.size() / 2];
  for (size_t i = 0; i < exposures.size(); ++i) {
    if (exposures[i]) result.gain[i] = static_cast<float>(std::clamp(*exposures[i] / result.reference_exposure, 1.0 / 1024.0, 1024.0));
  }
  return result;
}

double ColorRange(const std::vector<float>& gains) {
  float darkest = 1.0F;
  for (const float gain : gains) darkest = std::min(darkest, gain);
  // A little headroom: a sigmoid never reaches its limit.
  return std::clamp(1.02 * static_cast<double>(image::SrgbFromLinear(1.0F / darkest)), 1.02, 4.0);
}

Exposed Expose(float srgb_reference, float gain) {
  if (gain == 1.0F) return {srgb_reference, 1.0F};
  const float safe = std::max(srgb_reference, 0.0F);
  const float linear = gain * image::LinearFromSrgb(safe);
  return {image::SrgbFromLinear(linear), image::SrgbSlope(linear) * gain * image::LinearSlope(safe)};
}

}  // namespace skyquilt::brightness
