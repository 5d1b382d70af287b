#include "prepare/poses/colmap_run.h"

#include <optional>

#include "core/base/child_process.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "prepare/poses/choose_pairs.h"
#include "prepare/poses/colmap_commands.h"
#include "prepare/poses/extract_features.h"
#include "prepare/poses/feature_store.h"
#include "prepare/poses/match_pairs.h"
#include "prepare/poses/seed_model.h"

namespace skyquilt::prepare {
namespace {

namespace fs = std::filesystem;

// One way from photos to a model.
struct Attempt {
  ColmapJob job;
  ColmapSettings settings;
  std::optional<PairRules> pairs;  // of our own matching; none: COLMAP matches
  bool seed = false;               // by tags and matches before the mapper is asked
};

// Hashes of what the results of the steps depend on: when one changes, that step and the later ones must be repeated.
struct StepHashes {
  std::string features, matches, model, seeded;
};

// Tags that pairs depend on; positions may come from another file than the photo.
std::string PairInputs(const std::vector<PhotoFile>& photos, const PairRules& rules) {
  std::string text = fmt::format("pairs {} {} {} {} {} {} {} {}\n", rules.all_below, rules.neighbors, rules.sectors, rules.sector_reach,
                                 rules.position_neighbors, rules.similar, rules.name_neighbors, rules.links);
  const auto number = [](const std::optional<double>& value) { return value ? fmt::format("{:.9g}", *value) : std::string("-"); };
  for (const PhotoFile& photo : photos) {
    const survey::PhotoTags& tags = photo.tags;
    text += tags.gps ? fmt::format("{:.9f} {:.9f}", tags.gps->latitude_deg, tags.gps->longitude_deg) : "-";
    text += " " + number(tags.gimbal_pitch_deg) + " " + number(tags.gimbal_yaw_deg) + " " + number(tags.relative_altitude_m) + "\n";
  }
  return text;
}

StepHashes HashSteps(const Attempt& attempt, const std::vector<PhotoFile>& photos, const PoseOptions& options) {
  std::string text = FeatureInputs(attempt.job, attempt.settings, photos, options);
  StepHashes hashes;
  const FastColmapFlags flags;
  hashes.features = base::HashHex(text);
  if (attempt.pairs) text += PairInputs(photos, *attempt.pairs);
  hashes.matches = base::HashHex(text);
  hashes.seeded = base::HashHex(text + SeedInputs(photos));
  if (attempt.settings.fast) {
    text += fmt::format("fast {} {} {} {}\n", flags.ba_global_function_tolerance, flags.ba_global_images_ratio, flags.ba_global_points_ratio,
                        flags.ba_global_max_refinements);
  }
  hashes.model = base::HashHex(text);
  return hashes;
}

void MatchOurselves(const Attempt& attempt, const MatchJob& match_job, const std::vector<PhotoFile>& photos, const PoseOptions& options,
                    base::ThreadPool& threads, RemoteTasks* ranks) {
  std::vector<std::string> names;
  names.reserve(photos.size());
  for (const PhotoFile& photo : photos) names.push_back(photo.name);
  FeatureStore features(attempt.job.Database(), names, kFeatureMemory_bytes);
  const PhotoPairs pairs = ChoosePairs(photos, *attempt.pairs, static_cast<uint64_t>(options.seed), features, threads);
  MatchPairs(match_job, features, pairs, threads, ranks);
}

// Everything but the model.
void FillDatabase(const Attempt& attempt, const StepHashes& hashes, const std::vector<PhotoFile>& photos, const PoseOptions& options,
                  base::ThreadPool& threads, RemoteTasks* ranks) {
  const ColmapJob& job = attempt.job;
  base::RequireWritableFolder(job.folder);
  spdlog::info("running COLMAP on {} photos; its log is {}", photos.size(), job.Log().string());
  RunStep(job, {"features", hashes.features}, {"own_matches", "matches", kSeededStep, kModelStep},
          [&] { ExtractFeatures(job, attempt.settings, photos, options, hashes.features, ranks); });
  RemoveFeatureParts(job);
  if (!attempt.pairs) {
    RunStep(job, {"matches", hashes.matches}, {kModelStep}, [&] { MatchByColmap(job, attempt.settings, photos, options); });
    return;
  }
  const MatchJob match_job{.folder = job.folder / "matches", .input = hashes.features};
  RunStep(job, {"own_matches", hashes.matches}, {"matches", kSeededStep, kModelStep},
          [&] { MatchOurselves(attempt, match_job, photos, options, threads, ranks); });
  // Only now: a kill before the step is marked as done would have to match everything again.
  RemoveChunks(match_job);
  RunStep(job, {"matches", hashes.matches}, {kSeededStep, kModelStep}, [&] { VerifyMatches(job, attempt.settings, options); });
}

FoundModel FindModel(const Attempt& attempt, const StepHashes& hashes, const std::vector<PhotoFile>& photos, const PoseOptions& options,
                     base::ThreadPool& threads) {
  const ColmapJob& job = attempt.job;
  const ColmapStep mapper{kModelStep, hashes.model};
  // What the mapper has finished stays: the seeding had failed, or was not wanted.
  if (attempt.seed && !IsDone(job, mapper)) {
    RunStep(job, {kSeededStep, hashes.seeded}, {}, [&] { SeedModel(job, photos, threads); });
    if (const std::optional<FoundModel> seeded = SeededModelOf(job)) return *seeded;
  }
  RunStep(job, mapper, {}, [&] { MakeModels(job, attempt.settings, photos.size(), options); });
  return LargestModel(job);
}

}  // namespace

fs::path RunColmap(const ColmapJob& job, const std::vector<PhotoFile>& photos, const PoseOptions& options, base::ThreadPool& threads,
                   RemoteTasks* ranks) {
  const fs::path program = base::FindProgram(options.colmap);
  if (program.empty()) {
    throw base::InputError(options.colmap, "there is no such program",
                           "Install COLMAP (Debian: apt install colmap), set prepare.colmap to its path, or give a model with --model");
  }
  const ColmapSettings settings{.program = program, .n_threads = threads.size(), .fast = options.fast};
  const Attempt first{job, settings, options.fast ? std::optional(PairRules{}) : std::nullopt, options.fast && options.seed_poses};
  const StepHashes hashes = HashSteps(first, photos, options);
  FillDatabase(first, hashes, photos, options, threads, ranks);
  if (!options.fast) return FindModel(first, hashes, photos, options, threads).folder;

  std::optional<FoundModel> found;
  std::string reason;
  try {
    found = FindModel(first, hashes, photos, options, threads);
    if (static_cast<double>(found->n_photos) >= kEnoughRegistered * static_cast<double>(photos.size())) return found->folder;
    reason = fmt::format("it found the poses of {} of {} photos only", found->n_photos, photos.size());
  } catch (const base::InputError& error) {
    reason = error.what();
  }
  spdlog::warn("the fast way is not enough: {}. Once more with COLMAP's own settings and more pairs", reason);
  Attempt second{job, settings, kMorePairs};
  second.job.folder = job.folder / "more_pairs";
  second.settings.fast = false;
  const StepHashes second_hashes = HashSteps(second, photos, options);
  FillDatabase(second, second_hashes, photos, options, threads, ranks);
  FoundModel again;
  try {
    again = FindModel(second, second_hashes, photos, options, threads);
  } catch (const base::InputError& error) {
    if (!found) throw;
    spdlog::warn("more pairs give no model: {}", error.what());
    return found->folder;
  }
  spdlog::info("poses: {} photos in the fast way, {} with more pairs", found ? found->n_photos : 0, again.n_photos);
  return found && found->n_photos >= again.n_photos ? found->folder : again.folder;
}

}  // namespace skyquilt::prepare
