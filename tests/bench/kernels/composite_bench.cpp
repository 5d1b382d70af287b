// The work of training along every ray: compositing and distortion loss, forward and backward.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/render/composite.h"
#include "tests/bench/kernels/bench_data.h"

namespace skyquilt {
namespace {

constexpr size_t kRays = 64;

// Samples of all rays one after another; three colour rows.
struct Rays {
  explicit Rays(const benchmark::State& state)
      : samples(static_cast<int>(state.range(0))),
        stride(kRays * static_cast<size_t>(samples)),
        // Low density, so that no sample is hidden and skipped.
        tau(bench::RandomValues(stride, 0.0F, 4.0F / static_cast<float>(samples), 1)),
        color(bench::RandomValues(3 * stride, 0.0F, 1.0F, 2)),
        mid(stride),
        width(stride, 1.0F / static_cast<float>(samples)),
        weights(stride),
        transmittance(kRays),
        weight_gradient(stride),
        tau_gradient(stride),
        color_gradient(3 * stride) {
    for (size_t i = 0; i < stride; ++i) mid[i] = static_cast<float>(i % static_cast<size_t>(samples)) * width[i];
    Forward();
  }

  size_t Begin(size_t ray) const { return ray * static_cast<size_t>(samples); }

  void Forward() {
    for (size_t ray = 0; ray < kRays; ++ray) {
      float rgb[3];
      transmittance[ray] =
          render::CompositeForward(samples, tau.data() + Begin(ray), color.data() + Begin(ray), stride, weights.data() + Begin(ray), rgb);
      benchmark::DoNotOptimize(rgb);
    }
    Keep(weights);
  }

  void Distortion() {
    std::fill(weight_gradient.begin(), weight_gradient.end(), 0.0F);
    for (size_t ray = 0; ray < kRays; ++ray) {
      const size_t begin = Begin(ray);
      float loss =
          render::DistortionLoss(samples, weights.data() + begin, mid.data() + begin, width.data() + begin, 0.01F, weight_gradient.data() + begin);
      benchmark::DoNotOptimize(loss);
    }
    Keep(weight_gradient);
  }

  void Backward() {
    const float rgb_gradient[3] = {0.1F, -0.2F, 0.3F};
    for (size_t ray = 0; ray < kRays; ++ray) {
      const size_t begin = Begin(ray);
      render::CompositeBackward(samples, color.data() + begin, stride, weights.data() + begin, transmittance[ray], rgb_gradient, 0.1F,
                                weight_gradient.data() + begin, tau_gradient.data() + begin, color_gradient.data() + begin, stride);
    }
    Keep(tau_gradient);
    Keep(color_gradient);
  }

  // Everything is inlined here, so the compiler would remove results that are not read.
  static void Keep(std::vector<float>& result) {
    float* data = result.data();
    benchmark::DoNotOptimize(data);
  }

  int samples;
  size_t stride;
  std::vector<float> tau, color, mid, width, weights, transmittance, weight_gradient, tau_gradient, color_gradient;
};

void Count(benchmark::State& state, const Rays& rays) {
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(rays.stride));
}

void CompositeForward(benchmark::State& state) {
  Rays rays(state);
  for (auto _ : state) rays.Forward();
  Count(state, rays);
}

void DistortionLoss(benchmark::State& state) {
  Rays rays(state);
  for (auto _ : state) rays.Distortion();
  Count(state, rays);
}

void CompositeBackward(benchmark::State& state) {
  Rays rays(state);
  for (auto _ : state) rays.Backward();
  Count(state, rays);
}

void CompositeAll(benchmark::State& state) {
  Rays rays(state);
  for (auto _ : state) {
    rays.Forward();
    rays.Distortion();
    rays.Backward();
  }
  Count(state, rays);
}

void SamplesPerRay(benchmark::internal::Benchmark* bench) {
  bench->ArgName("samples")->Arg(8)->Arg(32)->Arg(128)->Unit(benchmark::kMicrosecond);
}
BENCHMARK(CompositeForward)->Apply(SamplesPerRay);
BENCHMARK(DistortionLoss)->Apply(SamplesPerRay);
BENCHMARK(CompositeBackward)->Apply(SamplesPerRay);
BENCHMARK(CompositeAll)->Apply(SamplesPerRay);

}  // namespace
}  // namespace skyquilt
