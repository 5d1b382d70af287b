// Matching the features of two photos: all dot products of their descriptors and the two best of each, both ways. MAC: multiplications and additions
// of bytes, features^2 * 128 a pair; items: pairs of photos.
#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/random.h"
#include "core/kernel/descriptors.h"

namespace skyquilt {
namespace {

std::vector<uint8_t> Bytes(int64_t features, uint64_t seed) {
  base::Random random(seed);
  std::vector<uint8_t> bytes(static_cast<size_t>(features) * kernel::kDescriptorBytes);
  for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random.Below(91));  // of length 512, about
  return bytes;
}

void Find(benchmark::State& state, bool vnni) {
  const int64_t features = state.range(0);
  const kernel::PackedDescriptors a = kernel::PackDescriptors(Bytes(features, 1)), b = kernel::PackDescriptors(Bytes(features, 2));
  kernel::AllowVnni(vnni);
  state.SetLabel(kernel::UsesVnni() ? "VNNI" : "");
  for (auto _ : state) {
    kernel::BestDotsBothWays best = kernel::FindBestDots(a, b);
    benchmark::DoNotOptimize(best);
  }
  kernel::AllowVnni(true);
  const double per_pair = static_cast<double>(features) * static_cast<double>(features) * static_cast<double>(kernel::kDescriptorBytes);
  state.counters["MAC"] = benchmark::Counter(per_pair, benchmark::Counter::kIsIterationInvariantRate);
  state.SetItemsProcessed(state.iterations());
}

void FindBestDots(benchmark::State& state) {
  Find(state, true);
}
void FindBestDotsWithoutVnni(benchmark::State& state) {
  Find(state, false);
}

void PackDescriptors(benchmark::State& state) {
  const std::vector<uint8_t> bytes = Bytes(state.range(0), 1);
  for (auto _ : state) {
    kernel::PackedDescriptors packed = kernel::PackDescriptors(bytes);
    benchmark::DoNotOptimize(packed);
  }
  state.SetItemsProcessed(state.iterations() * state.range(0));
}

void Features(benchmark::internal::Benchmark* bench) {
  bench->ArgName("features")->Arg(512)->Arg(6085)->Unit(benchmark::kMillisecond);
}
BENCHMARK(FindBestDots)->Apply(Features);
BENCHMARK(FindBestDotsWithoutVnni)->Apply(Features);
BENCHMARK(PackDescriptors)->Apply(Features);

}  // namespace
}  // namespace skyquilt
