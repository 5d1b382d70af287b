#include "coordinator/planning/rates.h"

#include <algorithm>

namespace skyquilt::coordinator {
namespace {

// Brighton Beach renders 0.2 million rays a second where Seneca and the town train 2.1 to 2.5 million samples (docs/benchmarks.md); surfaces of the
// town are seen at 0.5.
constexpr double kRaysPerSample = 0.12;
// Gradients go into one level's table per thread, of 8 by default.
constexpr int kMostTrainingThreads = 8;
constexpr double kUsualSamples = 1.2e6;   // per thread
constexpr double kMostDifference = 10.0;  // of a machine from the usual one

}  // namespace

Rates Rates::Usual(int threads) {
  const double n = std::max(1, threads);
  Rates rates;
  rates.decoded_pixels = 35e6 * n;
  // Brighton Beach: 18 photos, 1600 pixels wide for the search, in 9.6 s; Seneca: 167 in 152 s, nearly all searched twice. Two threads.
  rates.feature_pixels = 1.2e6 * n;
  rates.matched_pairs = 20.0 * n;
  rates.scored_pixels = 0.25e6 * n;
  rates.painted_pixels = 1.5e6 * n;
  rates.fused_pixels = 0.5e6 * n;
  rates.texels = 0.2e6 * n;
  rates.samples = kUsualSamples * std::min(std::max(1, threads), kMostTrainingThreads);
  rates.rays = kRaysPerSample * kUsualSamples * n;
  return rates;
}

void Rates::TakeSamples(double samples_per_second) {
  const double speed = samples > 0.0 ? std::clamp(samples_per_second / samples, 1.0 / kMostDifference, kMostDifference) : 1.0;
  for (double* rate : {&rays, &scored_pixels, &painted_pixels, &fused_pixels, &texels}) *rate *= speed;
  samples = samples_per_second;
}

}  // namespace skyquilt::coordinator
