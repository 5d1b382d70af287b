#include "coordinator/scheduler/plan_brightness.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/errors.h"

namespace skyquilt::coordinator {
namespace {

constexpr float kTagWeight = 0.02F;

// EXIF gains of added photos are relative to the earlier reference.
void KeepEarlier(const brightness::Response& earlier, const survey::Survey& survey, BrightnessPlan& plan) {
  const size_t n = earlier.photos();
  SKYQUILT_CHECK(n <= survey.photos.size() && earlier.vignetting.size() <= plan.response.vignetting.size(), "added photos come behind the others");
  const auto limit = std::exp(static_cast<double>(brightness::kMaxLogGain));
  if (earlier.reference_exposure > 0.0 && plan.response.reference_exposure > 0.0) {
    const double factor = plan.response.reference_exposure / earlier.reference_exposure;
    for (size_t i = n; i < survey.photos.size(); ++i) {
      if (plan.learn.tag_weight[i] == 0.0F) continue;  // without tags
      float& gain = plan.response.exif_gain[i];
      gain = static_cast<float>(std::clamp(static_cast<double>(gain) * factor, 1.0 / limit, limit));
    }
  } else if (plan.response.reference_exposure > 0.0) {
    // Earlier photos had no tags: nothing relates those of the added ones to them.
    for (size_t i = n; i < survey.photos.size(); ++i) {
      plan.response.exif_gain[i] = 1.0F;
      plan.learn.tag_weight[i] = 0.0F;
      plan.learn.learns_gain[i] = survey.photos[i].is_test ? 0 : 1;
    }
  }
  plan.response.reference_exposure = earlier.reference_exposure;
  std::copy(earlier.exif_gain.begin(), earlier.exif_gain.end(), plan.response.exif_gain.begin());
  std::copy(earlier.log_gain.begin(), earlier.log_gain.end(), plan.response.log_gain.begin());
  std::copy(earlier.vignetting.begin(), earlier.vignetting.end(), plan.response.vignetting.begin());
  std::fill_n(plan.learn.learns_gain.begin(), n, uint8_t{0});
  plan.learn.anchored = true;
  plan.learn.held_vignetting = earlier.vignetting.size() / 3;
}

}  // namespace

BrightnessPlan PlanBrightness(const survey::Survey& survey, const brightness::BrightnessOptions& options, const brightness::Response* earlier) {
  BrightnessPlan plan;
  const size_t n = survey.photos.size();
  plan.response = brightness::Response::Neutral(n, survey.cameras.size());
  plan.learn.learns_gain.assign(n, 0);
  plan.learn.vignetting = options.Vignette();
  std::vector<std::optional<double>> exposures;
  std::vector<bool> in_training;
  for (size_t i = 0; i < n; ++i) {
    const survey::Photo& photo = survey.photos[i];
    plan.response.camera[i] = photo.camera;
    plan.response.names.insert(plan.response.names.end(), photo.name.begin(), photo.name.end());
    plan.response.names.push_back('\n');
    exposures.push_back(brightness::ExifExposure(photo.exposure.time_s, photo.exposure.f_number, photo.exposure.iso));
    in_training.push_back(!photo.is_test);
  }
  std::vector<bool> known(n, false);
  if (options.Exif()) {
    brightness::PhotoGains gains = brightness::GainsFromExif(exposures, in_training);
    plan.response.reference_exposure = gains.reference_exposure;
    plan.response.exif_gain = std::move(gains.gain);
    known = std::move(gains.known);
  }
  if (options.Shading()) {
    const brightness::ShadingGrid grid = brightness::ShadingGrid::Parse(options.shading_grid).value();
    const auto sigma = static_cast<float>(options.shading_sigma * std::numbers::ln2);
    plan.response.AddShading(grid, sigma);
    plan.learn.shading = {grid, {}, sigma};
    for (const bool trains : in_training) plan.learn.shading.learns.push_back(trains ? 1 : 0);
  }
  // Only photos with usable tags are kept near their EXIF gain.
  plan.learn.tag_weight.assign(n, 0.0F);
  for (size_t i = 0; i < n; ++i) plan.learn.tag_weight[i] = known[i] ? kTagWeight : 0.0F;
  size_t untagged = 0, n_training = 0;
  for (size_t i = 0; i < n; ++i) {
    if (!in_training[i]) continue;
    ++n_training;
    if (options.Exif() && !known[i]) ++untagged;
    const bool learns = options.Gain() || (options.Exif() && !known[i]);
    plan.learn.learns_gain[i] = learns ? 1 : 0;
    plan.learn.anchored = plan.learn.anchored || !learns;
  }
  if (earlier != nullptr) KeepEarlier(*earlier, survey, plan);
  if (options.Exif() && n > 0) {
    const auto [darkest, brightest] = std::minmax_element(plan.response.exif_gain.begin(), plan.response.exif_gain.end());
    const double stops = std::log2(static_cast<double>(*brightest) / static_cast<double>(*darkest));
    if (untagged == n_training) {
      plan.remark = "no photo has an exposure time in its EXIF tags: brightness gains are learned from the photos";
    } else if (untagged > 0) {
      plan.remark =
          fmt::format("{} of {} training photos have no exposure time in their EXIF tags: their brightness gains are learned", untagged, n_training);
    } else if (stops >= 0.1) {
      plan.remark =
          fmt::format("exposures differ by {:.1f} stops according to the EXIF tags: all photos are corrected to the median exposure", stops);
    }
  }
  return plan;
}

brightness::BrightnessStatistics MeasureBrightness(const survey::Survey& survey, const image::PixelCache& pixels) {
  constexpr int kGrid = 64;  // pixels read along each side of a photo
  double srgb = 0.0, clipped = 0.0, n = 0.0;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    if (survey.photos[i].is_test) continue;
    const auto width = static_cast<size_t>(pixels.Width(i)), height = static_cast<size_t>(pixels.Height(i));
    for (size_t v = 0; v < kGrid; ++v) {
      for (size_t u = 0; u < kGrid; ++u) {
        uint8_t rgb[3];
        if (!pixels.Pixel(i, (2 * v + 1) * height / (2 * kGrid) * width + (2 * u + 1) * width / (2 * kGrid), rgb)) continue;
        for (const uint8_t value : rgb) srgb += value / (3.0 * 255.0);
        clipped += std::max({rgb[0], rgb[1], rgb[2]}) == 255 ? 1.0 : 0.0;
        n += 1.0;
      }
    }
  }
  if (n == 0.0) return {};
  return {srgb / n, clipped / n};
}

std::string LuminanceRemark(const brightness::Luminance& luminance, const brightness::BrightnessStatistics& statistics) {
  const std::string seen =
      fmt::format("the photos' mean brightness is {:.2f}, {:.0f} % of the pixels are clipped", statistics.mean_srgb, 100.0 * statistics.clipped);
  switch (luminance.mode) {
    case brightness::LuminanceMode::kUnder:
      return seen + fmt::format(": treated as under-exposed; results are shown with a mean brightness of {:.2f}", luminance.target);
    case brightness::LuminanceMode::kOver:
      return seen + fmt::format(": treated as over-exposed; results are shown with a mean brightness of {:.2f}", luminance.target);
    case brightness::LuminanceMode::kNone:
      break;
  }
  return seen + ": normally exposed, so no concealing field is trained (set brightness.luminance_mode to under or over to train one)";
}

}  // namespace skyquilt::coordinator
