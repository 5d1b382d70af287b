// Layers of networks of width 64 on one chunk of samples: forward, backward through the ReLU of the layer before, and gradient of the weights.
#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/kernel/kernels.h"
#include "tests/bench/kernels/bench_data.h"

namespace skyquilt {
namespace {

constexpr int64_t kSamples = 512;
constexpr size_t kStride = kernel::StrideFor(kSamples);

struct Layer {
  explicit Layer(const benchmark::State& state)
      : inputs(static_cast<int>(state.range(0))),
        outputs(static_cast<int>(state.range(1))),
        weights(bench::RandomValues(static_cast<size_t>(inputs) * static_cast<size_t>(outputs), -0.3F, 0.3F, 1)),
        in(bench::RandomValues(static_cast<size_t>(inputs) * kStride, -1.0F, 1.0F, 2)),
        out(bench::RandomValues(static_cast<size_t>(outputs) * kStride, -1.0F, 1.0F, 3)) {}

  int inputs, outputs;
  std::vector<float> weights, in, out;
};

void CountFlops(benchmark::State& state, const Layer& layer) {
  const double per_call = 2.0 * layer.inputs * layer.outputs * static_cast<double>(kSamples);
  state.counters["FLOP"] = benchmark::Counter(per_call, benchmark::Counter::kIsIterationInvariantRate);
  state.SetItemsProcessed(state.iterations() * kSamples);
}

void Dense(benchmark::State& state) {
  Layer layer(state);
  for (auto _ : state) {
    kernel::Dense(layer.weights.data(), layer.outputs, layer.inputs, layer.in.data(), kStride, kSamples, true, layer.out.data(), kStride);
  }
  CountFlops(state, layer);
}

void DenseGated(benchmark::State& state) {
  Layer layer(state);
  std::vector<float> in_gradient(layer.in.size());
  for (auto _ : state) {
    kernel::DenseGated(layer.weights.data(), layer.inputs, layer.outputs, layer.out.data(), kStride, kSamples, layer.in.data(), kStride,
                       in_gradient.data(), kStride);
  }
  CountFlops(state, layer);
}

void DenseWeightGradient(benchmark::State& state) {
  Layer layer(state);
  for (auto _ : state) {
    kernel::DenseWeightGradient(layer.out.data(), kStride, layer.outputs, layer.in.data(), kStride, layer.inputs, kSamples, layer.weights.data());
  }
  CountFlops(state, layer);
}

void Layers(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"in", "out"})->Args({32, 64})->Args({64, 64})->Args({64, 16})->Args({64, 4})->Unit(benchmark::kMicrosecond);
}
BENCHMARK(Dense)->Apply(Layers);
BENCHMARK(DenseGated)->Apply(Layers);
BENCHMARK(DenseWeightGradient)->Apply(Layers);

}  // namespace
}  // namespace skyquilt
