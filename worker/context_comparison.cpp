#include "worker/context_comparison.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/image/srgb.h"
#include "core/render/ray_engine.h"

namespace skyquilt::worker {
namespace {

constexpr int kPixels = 4096;
constexpr uint64_t kPixelStream = 4;
constexpr double kWorseFactor = 1.0232930;  // of the squared error: 0.1 dB
constexpr double kSigmas = 3.0;
constexpr double kStepScale = 0.5;  // as scenes are rendered
constexpr float kLeastError = 1e-10F;

// Squared error of every pixel, mean of its channels. Where a field lets light through, the mean colour of the photos shows.
std::vector<double> Errors(const render::FieldSet& fields, const std::vector<PixelRay>& pixels, const std::vector<render::Ray>& rays,
                           const brightness::Luminance& luminance, const std::array<float, 3>& behind, base::ThreadPool& threads) {
  const bool concealed = luminance.mode == brightness::LuminanceMode::kUnder;
  render::EngineOptions options = concealed ? render::EngineOptions::For(luminance) : render::EngineOptions();
  options.step_scale = kStepScale;
  std::vector<render::RayColor> seen(rays.size());
  render::RenderRays(fields, rays, seen, options, threads);
  std::vector<double> errors;
  for (size_t i = 0; i < rays.size(); ++i) {
    double sum = 0.0;
    for (size_t c = 0; c < 3; ++c) {
      const brightness::Exposure& exposure = pixels[i].exposure[c];
      const float through = 1.0F - seen[i].opacity;
      const float shown = concealed ? image::SrgbFromLinear(exposure.gain * (seen[i].concealed_light[c] + through * image::LinearFromSrgb(behind[c])))
                                    : brightness::Expose(seen[i].rgb_srgb[c] + through * behind[c], exposure).value;
      const double error = std::clamp(static_cast<double>(shown), 0.0, 1.0) - static_cast<double>(pixels[i].target_srgb[c]);
      sum += error * error;
    }
    errors.push_back(sum / 3.0);
  }
  return errors;
}

double PsnrOfMean(double mean) {
  return -10.0 * std::log10(std::max(static_cast<double>(kLeastError), mean));
}

}  // namespace

ContextComparison CompareWithContext(const RaySource& source, render::TrainedField& block, const LoadedContext& context, uint64_t seed,
                                     base::ThreadPool& threads) {
  base::Random random(seed, kPixelStream);
  std::vector<PixelRay> pixels;
  std::vector<render::Ray> rays;
  for (int i = 0; i < kPixels; ++i) {
    PixelRay pixel;
    if (!source.Draw(random, PhotoPyramid(), &pixel) || pixel.empty) continue;
    pixels.push_back(pixel);
    rays.push_back({.origin_enu = pixel.origin_enu, .direction_enu = pixel.direction_enu, .pixel_pitch = pixel.pixel_pitch});
  }
  ContextComparison comparison;
  if (pixels.empty()) return comparison;
  const std::array<float, 3> behind = source.MeanColor(seed);
  block.BuildNetworks();
  render::FieldSet both;
  both.blocks = {&block};
  both.context = &context.field;
  render::FieldSet alone;
  alone.context = &context.field;
  const std::vector<double> with_block = Errors(both, pixels, rays, context.luminance, behind, threads);
  const std::vector<double> with_context = Errors(alone, pixels, rays, context.luminance, behind, threads);
  const auto n = static_cast<double>(pixels.size());
  double block_sum = 0.0, context_sum = 0.0, squares = 0.0;
  for (size_t i = 0; i < pixels.size(); ++i) {
    const double difference = with_block[i] - with_context[i];
    block_sum += with_block[i];
    context_sum += with_context[i];
    squares += difference * difference;
  }
  const double difference = (block_sum - context_sum) / n;
  const double error = std::sqrt(std::max(0.0, squares / n - difference * difference) / n);
  comparison.block_psnr_db = PsnrOfMean(block_sum / n);
  comparison.context_psnr_db = PsnrOfMean(context_sum / n);
  comparison.block_is_worse = block_sum > kWorseFactor * context_sum && difference > kSigmas * error;
  return comparison;
}

}  // namespace skyquilt::worker
