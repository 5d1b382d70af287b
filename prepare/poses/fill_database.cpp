#include "prepare/poses/fill_database.h"

#include <algorithm>
#include <set>
#include <span>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/survey/colmap_database.h"
#include "prepare/poses/extract_features.h"
#include "prepare/poses/match_pairs.h"
#include "prepare/poses/seed_model.h"

namespace skyquilt::prepare::poses {
namespace {

constexpr const char* kOwnMatchesStep = "own_matches";
constexpr const char* kMatchesStep = "matches";
constexpr size_t kNamedPhotos = 5;

std::vector<input::PhotoFile> PhotosInDatabase(const ColmapJob& job, const std::vector<input::PhotoFile>& photos) {
  std::set<std::string> names;
  for (survey::DatabaseImage& image : survey::ColmapDatabase(job.Database()).ReadImages()) names.insert(std::move(image.name));
  std::vector<input::PhotoFile> found;
  std::vector<std::string> missing;
  for (const input::PhotoFile& photo : photos) {
    if (names.contains(photo.name)) {
      found.push_back(photo);
    } else {
      missing.push_back(photo.name);
    }
  }
  if (!missing.empty()) {
    base::LogWarning("COLMAP cannot read {} of {} photos, which are left out (its log {} says why): {}{}", missing.size(), photos.size(),
                     job.Log().string(), base::Join(std::span(missing).first(std::min(missing.size(), kNamedPhotos))),
                     missing.size() > kNamedPhotos ? ", ..." : "");
  }
  return found;
}

}  // namespace

void FillFeatures(const ColmapJob& job, const ColmapSettings& settings, const std::vector<input::PhotoFile>& photos, const PoseOptions& options,
                  const std::string& hash, RemoteTasks* ranks) {
  base::RequireWritableFolder(job.folder);
  RunStep(job, {"features", hash}, {kOwnMatchesStep, kMatchesStep, kSeededStep, kModelStep, kHeldFocalStep},
          [&] { ExtractFeatures(job, settings, photos, options, hash, ranks); });
  RemoveFeatureParts(job);
}

void FillDatabase(const ColmapJob& job, const ColmapSettings& settings, const std::vector<input::PhotoFile>& photos, const PoseOptions& options,
                  const DatabaseHashes& hashes, const PairChooser& choose, base::ThreadPool& threads, RemoteTasks* ranks) {
  FillFeatures(job, settings, photos, options, hashes.features, ranks);
  const MatchJob match_job{.folder = job.folder / "matches", .input = hashes.features};
  RunStep(job, {kOwnMatchesStep, hashes.matches}, {kMatchesStep, kSeededStep, kModelStep, kHeldFocalStep}, [&] {
    const std::vector<input::PhotoFile> found = PhotosInDatabase(job, photos);
    std::vector<std::string> names;
    names.reserve(found.size());
    for (const input::PhotoFile& photo : found) names.push_back(photo.name);
    FeatureStore features(job.Database(), names, kFeatureMemory_bytes);
    MatchPairs(match_job, features, choose(found, features), threads, ranks);
  });
  // Only now: a kill before the step is marked as done would have to match everything again.
  RemoveChunks(match_job);
  RunStep(job, {kMatchesStep, hashes.matches}, {kSeededStep, kModelStep, kHeldFocalStep}, [&] { VerifyMatches(job, settings, options); });
}

}  // namespace skyquilt::prepare::poses
