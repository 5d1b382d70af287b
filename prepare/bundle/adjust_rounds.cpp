#include "prepare/bundle/adjust_rounds.h"

#include <cstdint>
#include <iterator>
#include <vector>

#include "core/base/progress.h"
#include "prepare/bundle/adjust_bundle.h"
#include "prepare/bundle/feature_tracks.h"
#include "prepare/bundle/triangulate.h"

namespace skyquilt::prepare::bundle {
namespace {

constexpr size_t kPerPhoto = 640;  // observations, as in the seeding
constexpr int kIterations = 30;

struct Round {
  double threshold, tolerance;
};
constexpr Round kRounds[] = {{10.0, 1e-4}, {6.0, 1e-5}, {kFinalThreshold, 1e-6}};

}  // namespace

bool AdjustInRounds(BundleProblem& bundle, const std::string& label, base::ThreadPool& threads) {
  base::Progress progress(label, static_cast<double>(std::size(kRounds)) * kIterations, "iterations");
  for (const Round& round : kRounds) {
    TriangulateAll(bundle, round.threshold, threads);
    const std::vector<uint32_t> chosen = ChooseTracks(bundle, bundle.has_point, bundle.agrees, kPerPhoto);
    const BundleStage stage{.loss = 1.0, .max_iterations = kIterations, .tolerance = round.tolerance};
    if (!AdjustBundle(bundle, chosen, stage, [&] { progress.Advance(); })) return false;
  }
  progress.Finish();
  TriangulateAll(bundle, kFinalThreshold, threads);
  return true;
}

}  // namespace skyquilt::prepare::bundle
