// The small passes between the networks, on one chunk of samples, and the check of gradients.
#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "core/kernel/kernels.h"
#include "tests/bench/kernels/bench_data.h"

namespace skyquilt {
namespace {

constexpr int64_t kSamples = 512;
constexpr size_t kStride = kernel::StrideFor(kSamples);

void ExpShifted(benchmark::State& state) {
  const int64_t n = state.range(0);
  const std::vector<float> x = bench::RandomValues(static_cast<size_t>(n), -5.0F, 10.0F);
  std::vector<float> out(x.size());
  for (auto _ : state) kernel::ExpShifted(x.data(), n, -5.0F, 15.0F, out.data());
  state.SetItemsProcessed(state.iterations() * n);
}
BENCHMARK(ExpShifted)->ArgName("n")->Arg(kSamples);

void Sigmoid(benchmark::State& state) {
  const int64_t n = state.range(0);
  const std::vector<float> x = bench::RandomValues(static_cast<size_t>(n), -5.0F, 5.0F);
  std::vector<float> out(x.size());
  for (auto _ : state) kernel::Sigmoid(x.data(), n, 1.0F, out.data());
  state.SetItemsProcessed(state.iterations() * n);
}
BENCHMARK(Sigmoid)->ArgName("n")->Arg(kSamples);

// Half of the samples are kept, in random order, so that branch prediction cannot help.
void Compact(benchmark::State& state) {
  const auto rows = static_cast<int>(state.range(0));
  std::vector<float> keep(static_cast<size_t>(kSamples), 0.0F);
  for (size_t s = 0; s < keep.size() / 2; ++s) keep[s] = 1.0F;
  base::Random random(2);
  for (size_t left = keep.size(); left > 1; --left) std::swap(keep[left - 1], keep[random.Below(static_cast<uint32_t>(left))]);
  const std::vector<float> in = bench::RandomValues(static_cast<size_t>(rows) * kStride, -1.0F, 1.0F, 3);
  std::vector<float> out(in.size());
  for (auto _ : state) {
    int64_t kept = kernel::Compact(keep.data(), kSamples, rows, in.data(), kStride, out.data(), kStride);
    benchmark::DoNotOptimize(kept);
  }
  state.SetItemsProcessed(state.iterations() * kSamples);
}
// Positions; features; values of the density network that the backward pass needs.
BENCHMARK(Compact)->ArgName("rows")->Arg(1)->Arg(32)->Arg(80);

void AllFinite(benchmark::State& state) {
  const int64_t n = state.range(0);
  const std::vector<float> values = bench::RandomValues(static_cast<size_t>(n), -1.0F, 1.0F);
  for (auto _ : state) {
    bool finite = kernel::AllFinite(values.data(), n);
    benchmark::DoNotOptimize(finite);
  }
  state.SetItemsProcessed(state.iterations() * n);
  state.SetBytesProcessed(state.iterations() * n * static_cast<int64_t>(sizeof(float)));
}
BENCHMARK(AllFinite)->ArgName("n")->Arg(kSamples)->Arg(int64_t{1} << 20);

}  // namespace
}  // namespace skyquilt
