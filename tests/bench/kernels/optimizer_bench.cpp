// Adam on the table of one level, with gradients in 1 to 100 % of it, and on the networks.
// Both kernels clear the gradient, so every iteration needs a new one. It is written between two iterations, and only the kernel is timed.
// (PauseTiming would cost as much as the shortest of these calls.)
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "core/kernel/kernels.h"
#include "tests/bench/kernels/bench_data.h"

namespace skyquilt {
namespace {

constexpr size_t kTableFloats = (size_t{1} << 19U) * 2;
constexpr size_t kLines = kTableFloats / kernel::kLineFloats;
// 32 -> 64 -> 16 and 32 -> 64 -> 64 -> 4.
constexpr size_t kNetworkFloats = 32 * 64 + 64 * 16 + 32 * 64 + 64 * 64 + 64 * 4;

kernel::AdamStep Step() {
  kernel::AdamStep step;
  step.correction1 = 0.65F;
  step.correction2 = 0.1F;
  return step;
}

// Seconds that `work` takes.
template <typename Work>
double Timed(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<size_t> ShuffledLines() {
  std::vector<size_t> lines(kLines);
  std::iota(lines.begin(), lines.end(), size_t{0});
  base::Random random(2);
  for (size_t left = kLines; left > 1; --left) std::swap(lines[left - 1], lines[random.Below(static_cast<uint32_t>(left))]);
  return lines;
}

void AdamTouched(benchmark::State& state) {
  std::vector<float> table = bench::Table(kTableFloats);
  std::vector<float> gradient = bench::Table(kTableFloats);
  std::vector<float> moment1 = bench::Table(kTableFloats);
  std::vector<float> moment2 = bench::Table(kTableFloats);
  std::vector<uint8_t> touched(kLines, 0);
  const std::vector<float> line_gradient = bench::RandomValues(kernel::kLineFloats, 1e-4F, 1e-3F);
  // Other cache lines each time, because the same few lines would stay in the cache.
  const std::vector<size_t> order = ShuffledLines();
  const size_t count = kLines * static_cast<size_t>(state.range(0)) / 100;
  size_t next = 0;
  for (auto _ : state) {
    for (size_t k = 0; k < count; ++k) {
      const size_t line = order[next];
      next = (next + 1) % kLines;
      std::copy(line_gradient.begin(), line_gradient.end(), gradient.data() + line * kernel::kLineFloats);
      touched[line] = 1;
    }
    state.SetIterationTime(Timed([&] {
      kernel::AdamTouched(Step(), static_cast<int64_t>(kLines), touched.data(), table.data(), gradient.data(), moment1.data(), moment2.data());
    }));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(count * kernel::kLineFloats));
}
BENCHMARK(AdamTouched)->ArgName("percent")->Arg(1)->Arg(10)->Arg(100)->Unit(benchmark::kMicrosecond)->UseManualTime();

void AdamDense(benchmark::State& state) {
  const auto n = static_cast<size_t>(state.range(0));
  std::vector<float> parameters = bench::RandomValues(n, -0.3F, 0.3F, 3);
  std::vector<float> gradient(n), moment1(n, 0.0F), moment2(n, 0.0F);
  const std::vector<float> source = bench::RandomValues(n, -1e-3F, 1e-3F, 4);
  for (auto _ : state) {
    std::copy(source.begin(), source.end(), gradient.begin());
    state.SetIterationTime(Timed(
        [&] { kernel::AdamDense(Step(), 1e-6F, static_cast<int64_t>(n), parameters.data(), gradient.data(), moment1.data(), moment2.data()); }));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(n));
}
BENCHMARK(AdamDense)->ArgName("n")->Arg(static_cast<int64_t>(kNetworkFloats))->Unit(benchmark::kMicrosecond)->UseManualTime();

}  // namespace
}  // namespace skyquilt
