#include "core/brightness/exposure.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/image/srgb.h"

namespace skyquilt::brightness {
namespace {

constexpr float kSrgbOffset = 0.055F;
constexpr float kSrgbPower = 2.4F;
// Display values at and below this are in sRGB's linear toe.
constexpr float kToe = 0.04045F;

}  // namespace

std::optional<double> ExifExposure(std::optional<double> time_s, std::optional<double> f_number, std::optional<double> iso) {
  const auto usable = [](std::optional<double> v) { return v && std::isfinite(*v) && *v > 0.0; };
  if (!usable(time_s)) return std::nullopt;
  const double aperture = usable(f_number) ? *f_number : 1.0;
  const double sensitivity = usable(iso) ? *iso : 100.0;
  return *time_s * sensitivity / (100.0 * aperture * aperture);
}

PhotoGains GainsFromExif(const std::vector<std::optional<double>>& exposures, const std::vector<bool>& in_training) {
  SKYQUILT_CHECK(exposures.size() == in_training.size(), std::to_string(exposures.size()) + " and " + std::to_string(in_training.size()));
  PhotoGains result;
  result.gain.assign(exposures.size(), 1.0F);
  result.known.assign(exposures.size(), false);
  std::vector<double> trained;
  for (size_t i = 0; i < exposures.size(); ++i) {
    if (exposures[i] && in_training[i]) trained.push_back(*exposures[i]);
  }
  if (trained.empty()) return result;
  result.reference_exposure = base::UpperMedian(trained);
  const double limit = std::exp(static_cast<double>(kMaxLogGain));
  for (size_t i = 0; i < exposures.size(); ++i) {
    if (!exposures[i]) continue;
    result.known[i] = true;
    result.gain[i] = static_cast<float>(std::clamp(*exposures[i] / result.reference_exposure, 1.0 / limit, limit));
  }
  return result;
}

double ColorRange(const std::vector<float>& gains) {
  float darkest = 1.0F;
  for (const float gain : gains) darkest = std::min(darkest, gain);
  // A little headroom: a sigmoid never reaches its limit.
  return std::clamp(1.02 * static_cast<double>(image::SrgbFromLinear(1.0F / darkest)), 1.02, 4.0);
}

Exposure Exposure::FromLogGain(float log_gain) {
  if (log_gain == 0.0F) return {};
  return {log_gain, std::exp(log_gain), std::exp(log_gain / kSrgbPower)};
}

Exposed Expose(float srgb_reference, const Exposure& exposure) {
  const float safe = std::max(srgb_reference, 0.0F);
  const float lifted = exposure.root * (safe + kSrgbOffset);
  // When both values are above the toe, sRGB is a pure power law and the gain a factor on (display value + offset).
  if (safe > kToe && lifted > kToe + kSrgbOffset) return {lifted - kSrgbOffset, exposure.root, lifted / kSrgbPower};
  const float linear = exposure.gain * image::LinearFromSrgb(safe);
  const float encode_slope = image::SrgbSlope(linear);
  return {image::SrgbFromLinear(linear), encode_slope * exposure.gain * image::LinearSlope(safe), encode_slope * linear};
}

void Expose(const std::array<Exposure, 3>& exposure, float (&rgb_srgb)[3]) {
  for (size_t c = 0; c < 3; ++c) rgb_srgb[c] = Expose(rgb_srgb[c], exposure[c]).value;
}

}  // namespace skyquilt::brightness
