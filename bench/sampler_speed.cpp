#include "bench/sampler_speed.h"

#include <algorithm>
#include <chrono>

#include "core/base/cancel.h"
#include "core/base/order_statistics.h"
#include "core/base/random.h"
#include "core/render/march.h"
#include "worker/samplers/bin_sampler.h"

namespace skyquilt::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kGroups = 32, kRaysPerGroup = 64;

std::vector<worker::BinnedRay> RandomRays(const render::TrainedField& target, base::Random& random) {
  std::vector<worker::BinnedRay> rays;
  while (rays.size() < kRaysPerGroup) {
    worker::BinnedRay ray{{random.UniformDouble(), random.UniformDouble(), random.UniformDouble()},
                          Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()).normalized(),
                          {}};
    ray.interval = render::FieldInterval(target.map, ray.origin_enu, ray.direction_enu);
    if (!ray.interval.Empty()) rays.push_back(ray);
  }
  return rays;
}

// Rays per second of `work`, which does all groups once.
template <typename Work>
double Rate(double seconds, int rounds, Work&& work) {
  std::vector<double> rates;
  for (int round = 0; round < rounds; ++round) {
    const auto start = Clock::now();
    double rays = 0.0, elapsed = 0.0;
    do {
      base::ThrowIfCancelled();
      work();
      rays += kGroups * kRaysPerGroup;
      elapsed = std::chrono::duration<double>(Clock::now() - start).count();
    } while (elapsed < seconds);
    rates.push_back(rays / elapsed);
  }
  return base::Median(rates);
}

}  // namespace

std::vector<SamplerSpeed> MeasureSamplers(const render::TrainedField& target, double seconds, int rounds, base::ThreadPool& threads) {
  const field::HashField field(target.config);
  worker::PhaseTimes times(threads.size());
  base::Random random(5);
  std::vector<std::vector<worker::BinnedRay>> groups;
  for (int g = 0; g < kGroups; ++g) groups.push_back(RandomRays(target, random));
  std::vector<SamplerSpeed> speeds;
  for (const char* name : {"stratified", "proposal"}) {
    const worker::Sampler kind = worker::SamplerNamed(name);
    SamplerSpeed speed{.sampler = name, .samples = worker::SamplesPerPass(kind, {})};
    worker::BinSampler sampler(kind, speed.samples, true, target, field, 1, threads, times);
    sampler.InitializeParameters();
    speed.field_samples = sampler.LastBins();
    const auto place = [&] {
      sampler.Begin(0.5, kGroups);
      threads.ParallelFor(kGroups, [&](int64_t group, int thread) {
        base::Random of_group(static_cast<uint64_t>(group));
        sampler.Place(group, groups[static_cast<size_t>(group)], of_group, thread);
      });
    };
    speed.place_rays_per_second = Rate(seconds, rounds, place);
    if (!sampler.proposals().empty()) {
      // All matter in one bin, so that something is always missing.
      const auto bins = static_cast<size_t>(sampler.LastBins());
      std::vector<float> weights(bins * kGroups * kRaysPerGroup, 0.0F);
      for (size_t i = bins / 2; i < weights.size(); i += bins) weights[i] = 1.0F;
      speed.learn_rays_per_second = Rate(seconds, rounds, [&] { sampler.Learn(weights, 1e-4); });
    }
    speeds.push_back(std::move(speed));
  }
  return speeds;
}

}  // namespace skyquilt::bench
