#include "prepare/poses/choose_pairs.h"

#include <algorithm>
#include <optional>

#include "core/base/log.h"
#include "prepare/poses/retrieval.h"
#include "prepare/poses/rig_pairs.h"

namespace skyquilt::prepare::poses {
namespace {

// Looks count less than places: pairs by place come first.
constexpr double kCostOfLooks = 1e15;

}  // namespace

PhotoPairs ChoosePairs(const std::vector<input::PhotoFile>& photos, const PairRules& rules, uint64_t seed, FeatureStore& features,
                       base::ThreadPool& threads) {
  const size_t n = photos.size();
  if (n < rules.all_below) {
    base::LogInfo("pairs: all {} of {} photos", n * (n - std::min<size_t>(n, 1)) / 2, n);
    return AllPairs(n);
  }
  const PhotoPairs of_rigs = PairsOfRigs(photos, rules.shot_neighbors);
  if (RigsTellAllPairs(photos)) {
    base::LogInfo("pairs: {} of {} possible ones of {} photos, by the places of their shots and where they look", of_rigs.size(), n * (n - 1) / 2, n);
    return of_rigs;
  }
  const std::vector<std::optional<PhotoPlace>> places = FindPlaces(photos);
  std::vector<uint32_t> without;
  for (uint32_t photo = 0; photo < n; ++photo) {
    if (!places[photo]) without.push_back(photo);
  }
  PhotoPairs pairs = PairsInSpace(places, rules);
  pairs.insert(pairs.end(), of_rigs.begin(), of_rigs.end());
  SortPairs(pairs);
  const size_t n_in_space = pairs.size();

  std::optional<PhotoIndex> index;
  if (!without.empty()) {
    base::LogInfo("{} of {} photos have no usable GPS tag: they are matched with the photos that look most like them", without.size(), n);
    RetrievalOptions options;
    options.seed = seed;
    index.emplace(
        n, [&](size_t photo) { return features.LargestFirst(static_cast<uint32_t>(photo)); }, options, threads);
    std::vector<std::vector<uint32_t>> similar(without.size());
    threads.ParallelFor(static_cast<int64_t>(without.size()), [&](int64_t task, int /*thread*/) {
      const auto i = static_cast<size_t>(task);
      similar[i] = index->MostSimilar(without[i], rules.similar);
    });
    for (size_t i = 0; i < without.size(); ++i) {
      for (const uint32_t other : similar[i]) pairs.push_back(MakePair(without[i], other));
    }
    const PhotoPairs by_name = NamePairs(without, n, rules.name_neighbors);
    pairs.insert(pairs.end(), by_name.begin(), by_name.end());
    SortPairs(pairs);
  }

  const size_t n_chosen = pairs.size(), n_groups = CountGroups(n, pairs);
  ConnectGroups(
      n, rules.links,
      [&](uint32_t photo) {
        std::vector<double> costs = PlaceCosts(places, photo);
        if (places[photo] || !index) return costs;
        const std::vector<float> similarities = index->Similarities(photo);
        for (size_t other = 0; other < n; ++other) costs[other] = kCostOfLooks * (2.0 - static_cast<double>(similarities[other]));
        return costs;
      },
      pairs);
  base::LogInfo("pairs: {} of {} possible ones of {} photos; {} by place, {} by looks or name, {} between {} groups", pairs.size(), n * (n - 1) / 2,
                n, n_in_space, n_chosen - n_in_space, pairs.size() - n_chosen, n_groups);
  return pairs;
}

}  // namespace skyquilt::prepare::poses
