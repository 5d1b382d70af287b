// Compositing along a ray in float, forward and backward, against sums in long double that follow the definition.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "bench/numerics/groups.h"
#include "core/base/random.h"
#include "core/render/composite.h"

namespace skyquilt::bench {
namespace {

struct CompositeRay {
  std::vector<float> tau, color;  // color: 3 rows of tau.size()
  float rgb_gradient[3] = {0.4F, -0.7F, 0.9F};
  float transmittance_gradient = 0.3F;
};

CompositeRay RayOf(const std::vector<double>& depths) {
  base::Random random(61);
  CompositeRay ray;
  for (const double depth : depths) ray.tau.push_back(static_cast<float>(depth));
  ray.color.resize(3 * depths.size());
  for (float& value : ray.color) value = random.Uniform();
  return ray;
}

struct CompositeErrors {
  Worst forward, backward;
  double transmittance = 0.0, opacity = 0.0;
  bool finite = true;
};

// T_i = exp(-sum of tau before i), w_i = T_i (1 - exp(-tau_i)); the gradient from its definition,
// dL/dtau_i = sum_j dL/dw_j dw_j/dtau_i + dL/dT dT/dtau_i, dw_j/dtau_i = T_i exp(-tau_i) for j = i, -w_j for j > i, 0 before.
CompositeErrors Compare(const CompositeRay& ray) {
  CompositeErrors errors;
  const size_t n = ray.tau.size();
  std::vector<float> weights(n), tau_gradient(n), color_gradient(3 * n);
  float rgb[3];
  const float transmittance = render::CompositeForward(static_cast<int>(n), ray.tau.data(), ray.color.data(), n, weights.data(), rgb);
  render::CompositeBackward(static_cast<int>(n), ray.color.data(), n, weights.data(), transmittance, ray.rgb_gradient, ray.transmittance_gradient,
                            static_cast<const float*>(nullptr), tau_gradient.data(), color_gradient.data(), n);
  std::vector<long double> exact(n);
  long double before = 0.0L, sums[3] = {0.0L, 0.0L, 0.0L};
  const auto take = [&errors](Worst& worst, float seen, long double expected) {
    errors.finite = errors.finite && std::isfinite(seen);
    worst.Take(std::abs(static_cast<double>(static_cast<long double>(seen) - expected)));
  };
  for (size_t i = 0; i < n; ++i) {
    const auto tau = static_cast<long double>(ray.tau[i]);
    exact[i] = std::exp(-before) * -std::expm1(-tau);
    before += tau;
    take(errors.forward, weights[i], exact[i]);
    for (size_t c = 0; c < 3; ++c) sums[c] += exact[i] * static_cast<long double>(ray.color[c * n + i]);
    errors.opacity += static_cast<double>(weights[i]);
  }
  const long double exact_transmittance = std::exp(-before);
  take(errors.forward, transmittance, exact_transmittance);
  for (size_t c = 0; c < 3; ++c) take(errors.forward, rgb[c], sums[c]);
  errors.transmittance = static_cast<double>(transmittance);
  before = 0.0L;
  for (size_t i = 0; i < n; ++i) {
    before += static_cast<long double>(ray.tau[i]);
    long double gradient = -static_cast<long double>(ray.transmittance_gradient) * exact_transmittance;
    for (size_t j = i; j < n; ++j) {
      long double g = 0.0L;
      for (size_t c = 0; c < 3; ++c) g += static_cast<long double>(ray.rgb_gradient[c]) * static_cast<long double>(ray.color[c * n + j]);
      gradient += g * (j == i ? std::exp(-before) : -exact[j]);
    }
    take(errors.backward, tau_gradient[i], gradient);
    for (size_t c = 0; c < 3; ++c) take(errors.backward, color_gradient[c * n + i], exact[i] * static_cast<long double>(ray.rgb_gradient[c]));
  }
  return errors;
}

NumericCase DepthsCase(const std::string& name, const std::vector<double>& depths, double opacity) {
  return {.name = name,
          .expected = fmt::format("finite, opacity {:.6g}; weights, colour and gradients to one rounding of T per interval", opacity),
          .limit = std::max(1e-6, static_cast<double>(depths.size()) * std::exp2(-24.0)),
          .run = [depths, opacity] {
            const CompositeErrors errors = Compare(RayOf(depths));
            Worst worst;
            worst.Take(errors.forward.value());
            worst.Take(errors.backward.value());
            worst.Take(std::abs(errors.opacity - opacity));
            return CaseResult{.seen = fmt::format("transmittance {:.3g}, forward {:.1g}, gradients {:.1g}", errors.transmittance,
                                                  errors.forward.value(), errors.backward.value()),
                              .worst = worst.value(),
                              .holds = errors.finite};
          }};
}

// Optical depths from 1e-8 to 1e4 in random order, some of them of intervals without length.
CaseResult RandomDepths(int rays) {
  base::Random random(67);
  Worst worst;
  bool finite = true;
  for (int k = 0; k < rays; ++k) {
    std::vector<double> depths(1 + random.Below(200));
    const double scale = random.Uniform(-8.0, 4.0);
    for (double& depth : depths) depth = random.Uniform() < 0.2F ? 0.0 : std::pow(10.0, std::min(4.0, scale + random.Normal()));
    const CompositeErrors errors = Compare(RayOf(depths));
    worst.Take(errors.forward.value());
    worst.Take(errors.backward.value());
    finite = finite && errors.finite;
  }
  return {.seen = fmt::format("{} rays of up to 200 samples", rays), .worst = worst.value(), .holds = finite};
}

CaseResult NoSamples() {
  float rgb[3] = {1.0F, 1.0F, 1.0F};
  const float transmittance = render::CompositeForward<float>(0, nullptr, nullptr, 0, nullptr, rgb);
  const bool black = rgb[0] == 0.0F && rgb[1] == 0.0F && rgb[2] == 0.0F;
  return {.seen = fmt::format("transmittance {}", transmittance), .worst = std::abs(1.0 - static_cast<double>(transmittance)), .holds = black};
}

constexpr size_t kDistortionSamples = 120;
constexpr double kDistortionStep = 0.02;  // width of an interval

// Running sums of w and w m are rounded once per interval, with an error of up to 2^-24 times the ray's length, and the slope is a difference of two
// of them. Errors of both signs add up as a random walk.
double DistortionLimit() {
  const auto n = static_cast<double>(kDistortionSamples);
  return std::sqrt(n) * std::exp2(-24.0) * n * kDistortionStep;
}

// sum_ij w_i w_j |m_i - m_j| + 1/3 sum_i w_i^2 d_i as a double sum, and its derivative.
CaseResult Distortion(int rays) {
  base::Random random(71);
  Worst worst;
  for (int k = 0; k < rays; ++k) {
    const size_t n = 1 + random.Below(kDistortionSamples);
    std::vector<float> weights(n), mid(n), width(n), gradient(n, 0.0F);
    float at = 0.0F;
    for (size_t i = 0; i < n; ++i) {
      weights[i] = random.Uniform() / static_cast<float>(n);
      width[i] = random.Uniform() < 0.1F ? 0.0F : static_cast<float>(kDistortionStep);
      mid[i] = at + 0.5F * width[i];
      at += width[i];
    }
    const float loss = render::DistortionLoss(static_cast<int>(n), weights.data(), mid.data(), width.data(), 1.0F, gradient.data());
    long double exact = 0.0L;
    for (size_t i = 0; i < n; ++i) {
      const auto w = static_cast<long double>(weights[i]);
      const auto d = static_cast<long double>(width[i]);
      exact += w * w * d / 3.0L;
      long double slope = 2.0L * w * d / 3.0L;
      for (size_t j = 0; j < n; ++j) {
        const long double apart = std::abs(static_cast<long double>(mid[i]) - static_cast<long double>(mid[j]));
        exact += w * static_cast<long double>(weights[j]) * apart;
        slope += 2.0L * static_cast<long double>(weights[j]) * apart;
      }
      worst.Take(std::abs(static_cast<double>(static_cast<long double>(gradient[i]) - slope)));
    }
    worst.Take(std::abs(static_cast<double>(static_cast<long double>(loss) - exact)));
  }
  return {.seen = fmt::format("{} rays, loss and gradient", rays), .worst = worst.value()};
}

}  // namespace

NumericGroup CompositeGroup(const NumericsOptions& options) {
  const int rays = options.quick ? 300 : 3000;
  const double tenth = 0.1;  // metres, of one interval
  NumericGroup group{
      .id = "compositing",
      .title = "Compositing",
      .lead =
          "Transmittance, weights, colour and all gradients of one ray in float, against the definition in long double. Optical depth is "
          "density times length; intervals here are 0.1 m."};
  group.cases = {
      DepthsCase("Density 0", std::vector<double>(64, 0.0), 0.0),
      DepthsCase("Density 10^6 per metre", std::vector<double>(64, 1e6 * tenth), 1.0),
      DepthsCase(
          "Density 10^6 behind 32 empty intervals",
          [&] {
            std::vector<double> depths(64, 0.0);
            std::fill(depths.begin() + 32, depths.end(), 1e6 * tenth);
            return depths;
          }(),
          1.0),
      DepthsCase("Optical depth 10^4 over 1000 intervals", std::vector<double>(1000, 10.0), 1.0),
      DepthsCase("Optical depth 10^4 in one interval", {1e4}, 1.0),
      DepthsCase("Infinite optical depth", {0.5, kEver, 0.5}, 1.0),
      DepthsCase("Intervals without length between dense ones", {0.0, 0.7, 0.0, 0.0, 0.7, 0.0}, -std::expm1(-2.0 * static_cast<double>(0.7F))),
      DepthsCase("Thin haze: 1000 intervals of 10^-6", std::vector<double>(1000, 1e-6), -std::expm1(-1000.0 * static_cast<double>(1e-6F))),
      DepthsCase("Denormal optical depths", std::vector<double>(64, 1e-42), 0.0),
      {.name = "A ray without samples", .expected = "transmittance 1, black", .limit = 0.0, .run = NoSamples},
      // 200 roundings of 2^-24, all of one sign, would be 1.2e-5 of T; signs differ.
      {.name = "Random depths from 10^-8 to 10^4",
       .expected = "finite, as in long double",
       .limit = 5e-6,
       .run = [rays] { return RandomDepths(rays); }},
      {.name = "Distortion loss",
       .expected = "loss and gradient as its double sum",
       .limit = DistortionLimit(),
       .run = [rays] { return Distortion(rays); }},
  };
  return group;
}

}  // namespace skyquilt::bench
