// Extreme brightness: the tone curve near 0 and 1, gains of ten stops, photos of one colour.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "bench/numerics/edge_survey.h"
#include "bench/numerics/groups.h"
#include "bench/numerics/hamlet_flight.h"
#include "core/base/random.h"
#include "core/brightness/exposure.h"
#include "core/brightness/tone_curve.h"

namespace skyquilt::bench {
namespace {

constexpr float kFarOutside = 1e30F;

// Phi(x) = 1/2 - sin(asin(1 - 2x) / 3) in long double, and its slope.
CaseResult ToneCurveInside() {
  Worst worst;
  for (int i = 0; i <= 100000; ++i) {
    const float x = std::clamp(static_cast<float>(i) * 1e-5F, brightness::kSafe, 1.0F - brightness::kSafe);
    const auto exact_x = static_cast<long double>(x);
    const long double angle = std::asin(1.0L - 2.0L * exact_x) / 3.0L;
    const long double slope = std::cos(angle) / (3.0L * std::sqrt(exact_x * (1.0L - exact_x)));
    const brightness::Toned toned = brightness::ToneCurve(x);
    worst.Take(std::abs(static_cast<double>(static_cast<long double>(toned.value) - (0.5L - std::sin(angle)))));
    worst.Take(std::abs(static_cast<double>(static_cast<long double>(toned.slope) / slope - 1.0L)));
  }
  return {.seen = "100001 places, value and slope", .worst = worst.value()};
}

// The tone curve near and beyond 0 and 1: finite, increasing, with bounded slope.
CaseResult ToneCurveOutside() {
  bool holds = true;
  Worst worst;
  float last = -kFarOutside;
  for (const float x :
       {-kFarOutside, -1.0F, -1e-3F, -1e-7F, 0.0F, 1e-12F, 1e-5F, 1e-3F, 0.5F, 0.999F, 0.99999F, 1.0F, 1.0000001F, 2.0F, kFarOutside}) {
    const brightness::Toned toned = brightness::ToneCurve(x);
    holds = holds && std::isfinite(toned.value) && std::isfinite(toned.slope) && toned.slope > 0.0F && (x == -kFarOutside || toned.value >= last);
    last = toned.value;
    worst.Take(static_cast<double>(toned.slope));
  }
  const brightness::Toned at_zero = brightness::ToneCurve(0.0F), at_end = brightness::ToneCurve(brightness::kSafe);
  holds = holds && at_zero.slope == at_end.slope;
  return {.seen = fmt::format("steepest {:.1f}, value at 0 {:.4f}", worst.value(), static_cast<double>(at_zero.value)),
          .worst = worst.value(),
          .holds = holds};
}

long double ExactSrgb(long double linear) {
  return linear <= 0.0031308L ? linear * 12.92L : 1.055L * std::pow(linear, 1.0L / 2.4L) - 0.055L;
}
long double ExactLinear(long double srgb) {
  return srgb <= 0.04045L ? srgb / 12.92L : std::pow((srgb + 0.055L) / 1.055L, 2.4L);
}

// A change of exposure of display values, its slope by central differences in long double.
CaseResult ExposureOf(double stops) {
  const auto log_gain = static_cast<float>(stops * std::log(2.0));
  const brightness::Exposure exposure = brightness::Exposure::FromLogGain(log_gain);
  const long double gain = std::exp(static_cast<long double>(log_gain));
  base::Random random(73);
  Worst worst;
  bool finite = true;
  const auto exact = [gain](long double srgb) { return ExactSrgb(gain * ExactLinear(srgb)); };
  for (int i = 0; i < 20000; ++i) {
    const float srgb = i % 2 == 0 ? 4.0F * random.Uniform() : 0.06F * random.Uniform();
    const brightness::Exposed seen = brightness::Expose(srgb, exposure);
    finite = finite && std::isfinite(seen.value) && std::isfinite(seen.slope) && std::isfinite(seen.log_gain_slope);
    const auto x = static_cast<long double>(srgb);
    const long double value = exact(x);
    worst.Take(std::abs(static_cast<double>((static_cast<long double>(seen.value) - value) / std::max(1.0L, value))));
    // The two pieces of the sRGB curve differ by 3e-8 in value where they meet, so differences across that point are skipped.
    constexpr long double kStep = 1e-6L;
    if (std::abs(x - 0.04045L) < 1e-4L || std::abs(value - 0.04045L) < 1e-4L * std::max(1.0L, gain)) continue;
    const long double slope = (exact(x + kStep) - exact(x - kStep)) / (2.0L * kStep);
    worst.Take(std::abs(static_cast<double>(static_cast<long double>(seen.slope) / slope - 1.0L)));
  }
  return {.seen = fmt::format("gain {:.6g}", static_cast<double>(exposure.gain)), .worst = worst.value(), .holds = finite};
}

NumericCase ExposureCase(double stops) {
  return {.name = fmt::format("Gain of {:+g} stops", stops),
          .expected = "value (relative to the larger of 1 and itself) and slope as in long double",
          .unit = "relative",
          .limit = 1e-4,
          .run = [stops] { return ExposureOf(stops); }};
}

struct EdgePhotos {
  std::string name;
  int width, height;
  double stops;  // photos are exposed by plus and minus this, in turn
  PixelFormula pixels;
};

uint8_t Recorded(float srgb, double stops) {
  const float value = brightness::Expose(srgb, brightness::Exposure::FromLogGain(static_cast<float>(stops * std::log(2.0)))).value;
  return static_cast<uint8_t>(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F)));
}

NumericCase PhotosCase(const EdgePhotos& photos, const NumericsOptions& options) {
  return {.name = photos.name,
          .expected = "context and block train, no step is dropped, all parameters and moments finite",
          .unit = "steps dropped",
          .limit = 0.0,
          .run = [photos, options] {
            const QuietStages quiet(options.silent);
            const EdgeSurvey survey(options.work_folder / "photos", photos.width, photos.height, photos.pixels);
            brightness::Response response = brightness::Response::Neutral(EdgeSurvey::kPhotos, 1);
            for (size_t i = 0; i < response.photos(); ++i) {
              response.exif_gain[i] = static_cast<float>(std::exp2(i % 2 == 0 ? photos.stops : -photos.stops));
            }
            base::ThreadPool threads(options.threads);
            const EdgeSurvey::Outcome outcome = survey.Train(response, options.quick ? 30 : 100, threads);
            if (!outcome.context.ok) return CaseResult{.seen = "context: " + outcome.context.reason, .holds = false};
            if (!outcome.block.ok) return CaseResult{.seen = "block: " + outcome.block.reason, .holds = false};
            return CaseResult{.seen = fmt::format("{} steps each, {}, training PSNR {:.1f} dB", outcome.block.steps,
                                                  outcome.finite ? "finite" : "not finite", outcome.block.final_psnr_db),
                              .worst = static_cast<double>(outcome.context.dropped_steps + outcome.block.dropped_steps),
                              .holds = outcome.finite};
          }};
}

}  // namespace

NumericGroup BrightnessGroup(const NumericsOptions& options) {
  NumericGroup group{
      .id = "brightness",
      .title = "Tone curve, gains and empty photos",
      .lead =
          "The inverse tone curve has an unbounded slope at 0 and 1; within a thousandth of them it is replaced by a straight line. Gains "
          "multiply linear light. Photos of one colour go through the worker's whole training: context, then block, with checkpoints."};
  group.cases = {
      {.name = "Tone curve", .expected = "value and slope as in long double", .limit = 1e-5, .run = ToneCurveInside},
      {.name = "Tone curve at and beyond 0 and 1",
       .expected = "finite and increasing, slope at most as large as at a thousandth inside (10.5)",
       .unit = "slope",
       .limit = 10.6,
       .run = ToneCurveOutside},
  };
  for (const double stops : {-10.0, -1.0, 0.0, 1.0, 10.0}) group.cases.push_back(ExposureCase(stops));
  const auto even = [](uint8_t value) { return [value](int, int, int) { return std::array<uint8_t, 3>{value, value, value}; }; };
  const auto pattern = [](int photo, int x, int y, double stops) {
    const float value = 0.5F + 0.25F * std::sin(0.4F * static_cast<float>(x)) * std::cos(0.3F * static_cast<float>(y));
    const double own = photo % 2 == 0 ? stops : -stops;
    return std::array<uint8_t, 3>{Recorded(value, own), Recorded(0.8F * value, own), Recorded(0.6F * value, own)};
  };
  const std::vector<EdgePhotos> photos = {
      {"All-black photos", 48, 36, 0.0, even(0)},
      {"All-white photos", 48, 36, 0.0, even(255)},
      {"Photos of a single pixel", 1, 1, 0.0, even(120)},
      {"Photos of one row", 48, 1, 0.0, even(120)},
      {"Photos exposed by +10 and -10 stops in turn", 48, 36, 10.0, [pattern](int photo, int x, int y) { return pattern(photo, x, y, 10.0); }},
      {"Photos exposed by +2 and -2 stops in turn", 48, 36, 2.0, [pattern](int photo, int x, int y) { return pattern(photo, x, y, 2.0); }},
  };
  for (const EdgePhotos& one : photos) group.cases.push_back(PhotosCase(one, options));
  return group;
}

}  // namespace skyquilt::bench
