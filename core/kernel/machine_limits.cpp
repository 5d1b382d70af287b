#include "core/kernel/machine_limits.h"

#include <algorithm>
#include <chrono>
#include <vector>

#include "core/base/random.h"
#include "core/base/system.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernel/machine_limits.cpp"
#include <hwy/foreach_target.h>  // re-includes this file once per instruction set
// clang-format off
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace skyquilt::kernel::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kChains = 12;  // independent sums; more than latency times throughput of any processor's multiply-add

// Returns the number of operations in `rounds` rounds. The result is added to *sink so that the compiler keeps the loop.
double FmaRoundsImpl(int64_t rounds, float* sink) {
  const hn::ScalableTag<float> d;
  const auto factor = hn::Set(d, 0.999999F);
  const auto addend = hn::Set(d, 1e-7F);
  hn::Vec<decltype(d)> chain[kChains];
  for (int c = 0; c < kChains; ++c) chain[c] = hn::Set(d, static_cast<float>(1 + c));
  for (int64_t i = 0; i < rounds; ++i) {
    for (int c = 0; c < kChains; ++c) chain[c] = hn::MulAdd(chain[c], factor, addend);
  }
  for (int c = 1; c < kChains; ++c) chain[0] = hn::Add(chain[0], chain[c]);
  *sink += hn::GetLane(hn::SumOfLanes(d, chain[0]));
  return 2.0 * kChains * static_cast<double>(hn::Lanes(d)) * static_cast<double>(rounds);
}

template <int kFeatures>
void GatherRounds(const float* table, const uint32_t* index, size_t n, float* sink) {
  const hn::CappedTag<float, kFeatures> d;
  constexpr size_t kLanes = hn::MaxLanes(hn::CappedTag<float, kFeatures>());
  hn::Vec<decltype(d)> sum[4] = {hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (size_t i = 0; i < n; i += 4) {
    for (size_t k = 0; k < 4; ++k) {
      const float* entry = table + static_cast<size_t>(index[i + k]) * kFeatures;
      for (size_t f = 0; f < kFeatures; f += kLanes) sum[k] = hn::Add(sum[k], hn::LoadU(d, entry + f));
    }
  }
  *sink += hn::GetLane(hn::SumOfLanes(d, hn::Add(hn::Add(sum[0], sum[1]), hn::Add(sum[2], sum[3]))));
}

template <int kFeatures>
void ScatterRounds(float* table, const uint32_t* index, size_t n) {
  const hn::CappedTag<float, kFeatures> d;
  constexpr size_t kLanes = hn::MaxLanes(hn::CappedTag<float, kFeatures>());
  const auto addend = hn::Set(d, 1.0F);
  for (size_t i = 0; i < n; ++i) {
    float* entry = table + static_cast<size_t>(index[i]) * kFeatures;
    for (size_t f = 0; f < kFeatures; f += kLanes) hn::StoreU(hn::Add(hn::LoadU(d, entry + f), addend), d, entry + f);
  }
}

void GatherImpl(int features, const float* table, const uint32_t* index, size_t n, float* sink) {
  features == 4 ? GatherRounds<4>(table, index, n, sink) : GatherRounds<2>(table, index, n, sink);
}

void ScatterImpl(int features, float* table, const uint32_t* index, size_t n) {
  features == 4 ? ScatterRounds<4>(table, index, n) : ScatterRounds<2>(table, index, n);
}

}  // namespace
}  // namespace skyquilt::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace skyquilt::kernel {

HWY_EXPORT(FmaRoundsImpl);
HWY_EXPORT(GatherImpl);
HWY_EXPORT(ScatterImpl);

namespace {

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Calls work() until the time is up; seconds per call, the first call not counted.
template <typename Work>
double SecondsPerCall(double seconds, Work&& work) {
  work();
  const double start = Now();
  double now = start;
  int64_t calls = 0;
  do {
    work();
    ++calls;
    now = Now();
  } while (now - start < seconds);
  return (now - start) / static_cast<double>(calls);
}

volatile float kept_result;  // written so that the compiler does not remove the loops

}  // namespace

double MeasureFlops(double seconds) {
  constexpr int64_t kRounds = 200'000;
  float sink = 0.0F;
  double operations = 0.0;
  const double per_call = SecondsPerCall(seconds, [&] { operations = HWY_DYNAMIC_DISPATCH(FmaRoundsImpl)(kRounds, &sink); });
  kept_result = sink;
  return operations / per_call;
}

AccessTimes MeasureAccess(uint32_t entries, int features, double seconds) {
  constexpr size_t kIndices = size_t{1} << 16U;
  std::vector<float> table;
  table.reserve(static_cast<size_t>(entries) * static_cast<size_t>(features));
  base::AdviseHugePages(table.data(), table.capacity() * sizeof(float));
  table.assign(static_cast<size_t>(entries) * static_cast<size_t>(features), 0.0F);
  // Several lists of indices, so that a list's entries are no longer all in the first-level cache when it is used again.
  const size_t lists = std::clamp<size_t>(entries / kIndices, 1, 64);
  std::vector<uint32_t> index(kIndices * lists);
  base::Random random(entries);
  for (uint32_t& i : index) i = random.Below(entries);
  float sink = 0.0F;
  size_t next = 0;
  const auto list = [&] { return index.data() + kIndices * (next++ % lists); };
  AccessTimes times;
  times.gather_s = SecondsPerCall(0.5 * seconds,
                                  [&] {
                                    HWY_DYNAMIC_DISPATCH(GatherImpl)
                                    (features, table.data(), list(), kIndices, &sink);
                                  }) /
                   kIndices;
  times.scatter_s = SecondsPerCall(0.5 * seconds, [&] { HWY_DYNAMIC_DISPATCH(ScatterImpl)(features, table.data(), list(), kIndices); }) / kIndices;
  kept_result = sink;
  return times;
}

}  // namespace skyquilt::kernel
#endif  // HWY_ONCE
