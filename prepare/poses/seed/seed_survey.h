// From the input of the seeding to what the adjustment works on: photos by index, positions in ENU, sampled rays, directions to begin with.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "prepare/bundle/bundle_problem.h"
#include "prepare/bundle/feature_tracks.h"
#include "prepare/poses/seed/ground_check.h"
#include "prepare/poses/seed/seed_input.h"

namespace skyquilt::prepare::poses {

// Photos a and b by index, and their matches in the input, of which there is one copy: those of thousands of photos take gigabytes.
struct SeedPair {
  uint32_t a = 0, b = 0;
  std::span<const std::array<uint32_t, 2>> features;
};

// The input with indices in place of ids. Keeps a pointer to the input.
struct SeedSurvey {
  const SeedInput* input = nullptr;
  std::vector<bundle::BundlePhoto> photos;  // none placed; positions in ENU about the photo in the middle
  std::vector<bundle::BundleLens> lenses;
  std::vector<SeedPair> pairs;  // without those of a photo with itself or with fewer than kLeastPairMatches matches
  std::vector<PairRays> rays;   // at most kMaxRays of each pair
};

constexpr size_t kLeastPairMatches = 15;
constexpr size_t kMaxRays = 60;
constexpr double kMinTagged = 0.9;          // share of photos with a GPS tag
constexpr double kGuessedFocalSigma = 0.5;  // relative

// False with a reason when the survey cannot be seeded: too few GPS tags, a camera model that the adjustment does not know. Throws std::logic_error
// for unknown ids and features.
bool MakeSeedSurvey(const SeedInput& input, SeedSurvey* survey, std::string* reason);

// Poses to begin with.
struct SeedStart {
  bool by_gimbal = false;
  std::vector<SeedView> views;
  double height_m = 0.0;  // above ground
};

// Those that agree with the matches, the better first: by gimbal angles, by matches for cameras that look straight down. When none, `reason` says
// why.
std::vector<SeedStart> FindStarts(const SeedSurvey& survey, std::string* reason);

// The bundle with these poses, and the tracks of the matches that move like the others of their pair. Pairs that may be by chance have none where
// their photos show different ground.
bundle::BundleProblem MakeBundle(const SeedSurvey& survey, const SeedStart& start, base::ThreadPool& threads);

}  // namespace skyquilt::prepare::poses
