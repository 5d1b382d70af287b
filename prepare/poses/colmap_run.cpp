#include "prepare/poses/colmap_run.h"

#include <optional>

#include "core/base/child_process.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "prepare/poses/choose_pairs.h"
#include "prepare/poses/colmap_commands.h"
#include "prepare/poses/extract_features.h"
#include "prepare/poses/fill_database.h"
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
  for (const PhotoFile& photo : photos) {
    const survey::PhotoTags& tags = photo.tags;
    text += tags.gps ? fmt::format("{:.9f} {:.9f}", tags.gps->latitude_deg, tags.gps->longitude_deg) : "-";
    text += " " + TagText(tags.gimbal_pitch_deg) + " " + TagText(tags.gimbal_yaw_deg) + " " + TagText(tags.relative_altitude_m) + "\n";
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

// Everything but the model.
void FillDatabaseOf(const Attempt& attempt, const StepHashes& hashes, const std::vector<PhotoFile>& photos, const PoseOptions& options,
                    base::ThreadPool& threads, RemoteTasks* ranks) {
  const ColmapJob& job = attempt.job;
  spdlog::info("running COLMAP on {} photos; its log is {}", photos.size(), job.Log().string());
  if (!attempt.pairs) {
    FillFeatures(job, attempt.settings, photos, options, hashes.features, ranks);
    RunStep(job, {"matches", hashes.matches}, {kModelStep}, [&] { MatchByColmap(job, attempt.settings, photos, options); });
    return;
  }
  const auto choose = [&](const std::vector<PhotoFile>& found, FeatureStore& features) {
    return ChoosePairs(found, *attempt.pairs, static_cast<uint64_t>(options.seed), features, threads);
  };
  FillDatabase(job, attempt.settings, photos, options, {hashes.features, hashes.matches}, choose, threads, ranks);
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
  FillDatabaseOf(first, hashes, photos, options, threads, ranks);
  if (!options.fast) return FindModel(first, hashes, photos, options, threads).folder;

  std::optional<FoundModel> found;
  std::string reason;
  try {
    found = FindModel(first, hashes, photos, options, threads);
    if (static_cast<double>(found->n_photos) >= kEnoughRegistered * static_cast<double>(photos.size())) return found->folder;
    reason = fmt::format("it found the poses of {} of {} photos only", found->n_photos, photos.size());
  } catch (const NoModelError& error) {
    reason = error.what();
  }
  spdlog::warn("the fast way is not enough: {}. Once more with COLMAP's own settings and more pairs", reason);
  Attempt second{job, settings, kMorePairs};
  second.job.folder = job.folder / "more_pairs";
  second.settings.fast = false;
  const StepHashes second_hashes = HashSteps(second, photos, options);
  FillDatabaseOf(second, second_hashes, photos, options, threads, ranks);
  FoundModel again;
  try {
    again = FindModel(second, second_hashes, photos, options, threads);
  } catch (const NoModelError& error) {
    if (!found) throw;
    spdlog::warn("more pairs give no model: {}", error.what());
    return found->folder;
  }
  spdlog::info("poses: {} photos in the fast way, {} with more pairs", found ? found->n_photos : 0, again.n_photos);
  return found && found->n_photos >= again.n_photos ? found->folder : again.folder;
}

}  // namespace skyquilt::prepare
