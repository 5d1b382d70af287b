#include "evaluate/photos/apply_response.h"

#include <algorithm>
#include <cmath>

#include "core/camera/corner_radius.h"
#include "evaluate/photos/pixel_groups.h"

namespace skyquilt::evaluate::photos {
namespace {

constexpr int kFitSteps = 12;
constexpr float kSaturated = 254.5F / 255.0F, kBlack = 0.5F / 255.0F;

// Gauss-Newton on the mean squared error of one colour's display values over the left half.
float FitLogGain(const image::ImageF& render, const image::ImageF& photo, const image::Image8& scored, int channel) {
  float log_gain = 0.0F;
  for (int step = 0; step < kFitSteps; ++step) {
    const brightness::Exposure exposure = brightness::Exposure::FromLogGain(log_gain);
    double top = 0.0, bottom = 0.0;
    for (int y = 0; y < photo.height; ++y) {
      for (int x = 0; x < photo.width / 2; ++x) {
        if (*scored.At(x, y) == 0) continue;
        const float wanted = photo.At(x, y)[channel];
        // Saturated and black pixels do not determine the gain.
        if (wanted >= kSaturated || wanted <= kBlack) continue;
        const brightness::Exposed exposed = brightness::Expose(render.At(x, y)[channel], exposure);
        const auto slope = static_cast<double>(exposed.log_gain_slope);
        top += static_cast<double>(exposed.value - wanted) * slope;
        bottom += slope * slope;
      }
    }
    if (!(bottom > 0.0)) return 0.0F;
    const double change = std::clamp(top / bottom, -1.0, 1.0);
    log_gain = std::clamp(log_gain - static_cast<float>(change), -brightness::kMaxLogGain, brightness::kMaxLogGain);
    if (std::abs(change) < 1e-4) break;
  }
  return log_gain;
}

}  // namespace

void ApplyResponse(const camera::Camera& camera, const PhotoResponse& recording, std::span<render::RayColor> colors, base::ThreadPool& threads) {
  brightness::Response one = brightness::Response::Neutral(1, 1);
  one.log_gain.assign(recording.log_gain.begin(), recording.log_gain.end());
  one.vignetting.assign(recording.vignetting.begin(), recording.vignetting.end());
  const bool even = recording.vignetting == std::array<float, 3>{0.0F, 0.0F, 0.0F};
  if (even && recording.log_gain == std::array<float, 3>{0.0F, 0.0F, 0.0F}) return;
  const camera::CornerRadius radius(camera);
  const std::array<brightness::Exposure, 3> whole = one.ExposureOf(0);
  threads.ParallelFor(camera.height, [&](int64_t row, int) {
    for (int x = 0; x < camera.width; ++x) {
      const float radius2 = radius.Squared({x + 0.5, static_cast<double>(row) + 0.5});
      render::RayColor& color = colors[static_cast<size_t>(row) * static_cast<size_t>(camera.width) + static_cast<size_t>(x)];
      brightness::Expose(even ? whole : one.ExposureOf(0, radius2), color.rgb_srgb);
    }
  });
}

HalfScores ScoreHalves(const image::ImageF& render, const image::ImageF& photo, const image::Image8& scored) {
  HalfScores scores;
  std::array<brightness::Exposure, 3> fitted;
  for (int c = 0; c < 3; ++c) {
    const float log_gain = FitLogGain(render, photo, scored, c);
    scores.log_gain[static_cast<size_t>(c)] = log_gain;
    fitted[static_cast<size_t>(c)] = brightness::Exposure::FromLogGain(log_gain);
  }
  for (int y = 0; y < photo.height; ++y) {
    for (int x = photo.width / 2; x < photo.width; ++x) {
      if (*scored.At(x, y) == 0) continue;
      AddPixel(render.At(x, y), photo.At(x, y), &scores.right);
      float changed[3];
      for (size_t c = 0; c < 3; ++c) changed[c] = std::clamp(brightness::Expose(render.At(x, y)[c], fitted[c]).value, 0.0F, 1.0F);
      AddPixel(changed, photo.At(x, y), &scores.right_fitted);
    }
  }
  return scores;
}

}  // namespace skyquilt::evaluate::photos
