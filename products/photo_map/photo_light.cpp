#include "products/photo_map/photo_light.h"

#include <algorithm>
#include <cmath>

#include "core/base/order_statistics.h"

namespace skyquilt::products {
namespace {

constexpr int kLightRounds = 4;
constexpr size_t kFewestFalloffSamples = 200;
constexpr float kCornerRadius2 = 0.36F;  // samples beyond tell the falloff
constexpr double kMostFalloff = 1.6;     // |log| in the corner: more is no lens
constexpr double kWeakFalloff = 1e-3;    // of the diagonal: keeps the fit solvable
constexpr double kOutlierDeviations = 3.0;

// Sums of the normal equations of a r^2 + b r^4 = y.
struct FalloffSums {
  double rr = 0.0, rs = 0.0, ss = 0.0, ry = 0.0, sy = 0.0;
  size_t samples = 0, corners = 0;  // colours of samples, all and far from the middle
};

double FalloffAt(const std::array<float, 2>& falloff, float radius2) {
  return static_cast<double>(falloff[0] * radius2 + falloff[1] * radius2 * radius2);
}

// Adds the samples of one photo and colour about their means, so that the photo's gain does not matter.
void AddPhoto(const std::vector<const LightSample*>& samples, size_t k, double log_gain, const std::array<float, 2>& falloff, double limit,
              FalloffSums* sums) {
  std::vector<const LightSample*> kept;
  double mean_r = 0.0, mean_s = 0.0, mean_y = 0.0;
  for (const LightSample* sample : samples) {
    const auto y = static_cast<double>(sample->log_ratio[k]);
    if (!std::isfinite(y) || std::abs(y - log_gain - FalloffAt(falloff, sample->radius2)) > limit) continue;
    kept.push_back(sample);
    const auto r = static_cast<double>(sample->radius2);
    mean_r += r, mean_s += r * r, mean_y += y;
  }
  if (kept.empty()) return;
  const auto n = static_cast<double>(kept.size());
  mean_r /= n, mean_s /= n, mean_y /= n;
  for (const LightSample* sample : kept) {
    const double r2 = static_cast<double>(sample->radius2);
    const double r = r2 - mean_r, s = r2 * r2 - mean_s, y = static_cast<double>(sample->log_ratio[k]) - mean_y;
    sums->rr += r * r, sums->rs += r * s, sums->ss += s * s, sums->ry += r * y, sums->sy += s * y;
    ++sums->samples;
    if (sample->radius2 > kCornerRadius2) ++sums->corners;
  }
}

}  // namespace

PhotoLight PhotoLight::None(size_t photos, size_t cameras) {
  return {std::vector<std::array<float, 3>>(photos, {1.0F, 1.0F, 1.0F}), std::vector<std::array<float, 2>>(cameras, {0.0F, 0.0F})};
}

std::array<float, 3> PhotoLight::At(size_t photo, size_t camera, float radius2) const {
  const auto lens = static_cast<float>(std::exp(FalloffAt(falloff[camera], radius2)));
  return {gain[photo][0] * lens, gain[photo][1] * lens, gain[photo][2] * lens};
}

PhotoLight FitLight(std::span<const LightSample> samples, std::span<const int> camera_of_photo, size_t cameras) {
  const size_t photos = camera_of_photo.size();
  PhotoLight light = PhotoLight::None(photos, cameras);
  std::vector<std::vector<const LightSample*>> of_photo(photos);
  for (const LightSample& sample : samples) of_photo[static_cast<size_t>(sample.photo)].push_back(&sample);
  std::vector<std::array<double, 3>> log_gain(photos, {0.0, 0.0, 0.0});
  std::vector<char> known(photos, 0);
  for (int round = 0; round < kLightRounds; ++round) {
    std::array<std::vector<double>, 3> all;
    for (size_t i = 0; i < photos; ++i) {
      const auto& falloff = light.falloff[static_cast<size_t>(camera_of_photo[i])];
      for (size_t k = 0; k < 3; ++k) {
        std::vector<double> values;
        for (const LightSample* sample : of_photo[i]) {
          if (std::isfinite(sample->log_ratio[k])) values.push_back(static_cast<double>(sample->log_ratio[k]) - FalloffAt(falloff, sample->radius2));
        }
        if (values.empty()) continue;
        known[i] = 1;
        log_gain[i][k] = base::Median(values);
        all[k].push_back(log_gain[i][k]);
      }
    }
    for (size_t k = 0; k < 3; ++k) {
      const double middle = all[k].empty() ? 0.0 : base::Median(all[k]);
      for (size_t i = 0; i < photos; ++i) {
        if (known[i] == 0) log_gain[i][k] = middle;
      }
    }
    // The falloff explains what is left, in each colour equally.
    std::vector<double> deviations;
    const auto left_of = [&](const LightSample& sample, size_t k) {
      return static_cast<double>(sample.log_ratio[k]) - log_gain[static_cast<size_t>(sample.photo)][k];
    };
    for (const LightSample& sample : samples) {
      const auto& falloff = light.falloff[static_cast<size_t>(camera_of_photo[static_cast<size_t>(sample.photo)])];
      if (std::isfinite(sample.log_ratio[1])) deviations.push_back(std::abs(left_of(sample, 1) - FalloffAt(falloff, sample.radius2)));
    }
    if (deviations.empty()) break;
    const double limit = kOutlierDeviations * std::max(1.4826 * base::Median(deviations), 0.01);
    std::vector<FalloffSums> sums(cameras);
    for (size_t i = 0; i < photos; ++i) {
      const auto camera = static_cast<size_t>(camera_of_photo[i]);
      for (size_t k = 0; k < 3; ++k) AddPhoto(of_photo[i], k, log_gain[i][k], light.falloff[camera], limit, &sums[camera]);
    }
    for (size_t camera = 0; camera < cameras; ++camera) {
      FalloffSums& sum = sums[camera];
      if (sum.samples < kFewestFalloffSamples || sum.corners < kFewestFalloffSamples / 10) continue;
      const double rr = sum.rr * (1.0 + kWeakFalloff), ss = sum.ss * (1.0 + kWeakFalloff);
      const double determinant = rr * ss - sum.rs * sum.rs;
      if (!(determinant > 0.0)) continue;
      const double a = (sum.ry * ss - sum.sy * sum.rs) / determinant, b = (sum.sy * rr - sum.ry * sum.rs) / determinant;
      if (std::isfinite(a) && std::isfinite(b) && std::abs(a + b) < kMostFalloff) {
        light.falloff[camera] = {static_cast<float>(a), static_cast<float>(b)};
      }
    }
  }
  for (size_t i = 0; i < photos; ++i) {
    for (size_t k = 0; k < 3; ++k) light.gain[i][k] = static_cast<float>(std::exp(log_gain[i][k]));
  }
  return light;
}

}  // namespace skyquilt::products
