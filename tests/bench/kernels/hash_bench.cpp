// Lookup in one fine, hashed level, forward and backward, and its derivatives by position, at random positions, which use the caches as badly as a
// shuffled batch of rays.
#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/kernel/kernels.h"
#include "tests/bench/kernels/bench_data.h"

namespace skyquilt {
namespace {

// More positions than one call uses, so that calls read different parts of a large table.
constexpr size_t kPositions = size_t{1} << 18;
constexpr size_t kSamples = 4096;
constexpr size_t kStride = kernel::StrideFor(kSamples);

const float* Axis(size_t axis) {
  static const std::vector<float> axes[3] = {bench::RandomValues(kPositions, 0.0F, 1.0F, 1), bench::RandomValues(kPositions, 0.0F, 1.0F, 2),
                                             bench::RandomValues(kPositions, 0.0F, 1.0F, 3)};
  return axes[axis].data();
}

kernel::GridLevel Level(int64_t log2_entries) {
  kernel::GridLevel level;
  level.cells_per_unit = 2048.0F;
  for (int32_t& size : level.size) size = 2049;
  level.dense = false;
  level.entries = 1U << static_cast<uint32_t>(log2_entries);
  return level;
}

void HashForward(benchmark::State& state) {
  const auto features = static_cast<int>(state.range(0));
  const kernel::GridLevel level = Level(state.range(1));
  std::vector<float> table = bench::Table(size_t{level.entries} * static_cast<size_t>(features));
  bench::FillRandom(table, -1e-4F, 1e-4F, 4);
  std::vector<float> out(static_cast<size_t>(features) * kStride);
  const float* x = Axis(0);
  const float* y = Axis(1);
  const float* z = Axis(2);
  size_t begin = 0;
  for (auto _ : state) {
    kernel::HashForward(level, features, table.data(), {x + begin, y + begin, z + begin}, kSamples, out.data(), kStride);
    begin = (begin + kSamples) % kPositions;
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(kSamples));
}

void HashBackward(benchmark::State& state) {
  const auto features = static_cast<int>(state.range(0));
  const kernel::GridLevel level = Level(state.range(1));
  std::vector<float> table_gradient = bench::Table(size_t{level.entries} * static_cast<size_t>(features));
  std::vector<uint8_t> touched(table_gradient.size() / kernel::kLineFloats, 0);
  const std::vector<float> out_gradient = bench::RandomValues(static_cast<size_t>(features) * kStride, -1e-3F, 1e-3F, 5);
  const float* x = Axis(0);
  const float* y = Axis(1);
  const float* z = Axis(2);
  size_t begin = 0;
  for (auto _ : state) {
    kernel::HashBackward(level, features, {x + begin, y + begin, z + begin}, kSamples, out_gradient.data(), kStride, table_gradient.data(),
                         touched.data());
    begin = (begin + kSamples) % kPositions;
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(kSamples));
}

// Back to the positions (slope), forward along directions (tangent), and back from there to the table.
enum class Pass { kSlope, kTangent, kTangentBackward };

void HashDerivative(benchmark::State& state, Pass pass) {
  const auto features = static_cast<int>(state.range(0));
  const kernel::GridLevel level = Level(state.range(1));
  std::vector<float> table = bench::Table(size_t{level.entries} * static_cast<size_t>(features));
  bench::FillRandom(table, -1e-4F, 1e-4F, 4);
  std::vector<uint8_t> touched(table.size() / kernel::kLineFloats, 0);
  const std::vector<float> along = bench::RandomValues(3 * kStride, -1.0F, 1.0F, 6);
  std::vector<float> rows = bench::RandomValues(static_cast<size_t>(features) * kStride, -1e-3F, 1e-3F, 5), slope(3 * kStride);
  size_t begin = 0;
  for (auto _ : state) {
    const kernel::Positions at{Axis(0) + begin, Axis(1) + begin, Axis(2) + begin};
    if (pass == Pass::kSlope) kernel::HashSlope(level, features, table.data(), at, kSamples, rows.data(), kStride, slope.data(), kStride);
    if (pass == Pass::kTangent) kernel::HashTangent(level, features, table.data(), at, kSamples, along.data(), kStride, rows.data(), kStride);
    if (pass == Pass::kTangentBackward) {
      kernel::HashTangentBackward(level, features, at, kSamples, along.data(), kStride, rows.data(), kStride, table.data(), touched.data());
    }
    begin = (begin + kSamples) % kPositions;
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(kSamples));
}

// From a table that fits into the second-level cache to one that fits only into main memory.
void Sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"features", "log2_entries"})->ArgsProduct({{2, 4}, {14, 17, 19, 22}})->Unit(benchmark::kMicrosecond);
}
BENCHMARK(HashForward)->Apply(Sizes);
BENCHMARK(HashBackward)->Apply(Sizes);
BENCHMARK_CAPTURE(HashDerivative, slope, Pass::kSlope)->Apply(Sizes);
BENCHMARK_CAPTURE(HashDerivative, tangent, Pass::kTangent)->Apply(Sizes);
BENCHMARK_CAPTURE(HashDerivative, tangent_backward, Pass::kTangentBackward)->Apply(Sizes);

}  // namespace
}  // namespace skyquilt
