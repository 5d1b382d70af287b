// Variants that are trained with several seeds.
#include <fmt/core.h>

#include "bench/study/study.h"

namespace skyquilt::bench {

Variant Study::WithSeed(Variant variant, int seed) const {
  variant.overrides.push_back({"run.seed", std::to_string(seed)});
  // A study that goes on with more seeds finds the training of the first.
  if (seed == options_.settings.run.seed) return variant;
  variant.name += fmt::format("_s{}", seed);
  variant.label += fmt::format(", seed {}", seed);
  return variant;
}

VariantResult Study::Run(const Variant& variant) {
  return RunMerged(variant, {}).front();
}

std::vector<VariantResult> Study::RunMerged(const Variant& variant, const std::vector<Variant>& merged) {
  if (seeds_.empty()) return RunOnce(variant, merged);
  std::vector<std::vector<VariantResult>> trainings(1 + merged.size());
  for (const int seed : seeds_) {
    std::vector<Variant> own;
    own.reserve(merged.size());
    for (const Variant& other : merged) own.push_back(WithSeed(other, seed));
    std::vector<VariantResult> results = RunOnce(WithSeed(variant, seed), own);
    for (size_t k = 0; k < results.size(); ++k) trainings[k].push_back(std::move(results[k]));
  }
  std::vector<VariantResult> medians = {MedianResult(variant.name, variant.label, std::move(trainings.front()))};
  for (size_t k = 0; k < merged.size(); ++k) medians.push_back(MedianResult(merged[k].name, merged[k].label, std::move(trainings[k + 1])));
  return medians;
}

}  // namespace skyquilt::bench
