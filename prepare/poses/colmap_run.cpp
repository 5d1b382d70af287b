#include "prepare/poses/colmap_run.h"

#include <algorithm>
#include <exception>
#include <optional>

#include "core/base/child_process.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "core/survey/colmap_database.h"
#include "core/survey/colmap_model.h"
#include "prepare/poses/choose_pairs.h"
#include "prepare/poses/colmap_commands.h"
#include "prepare/poses/extract_features.h"
#include "prepare/poses/fill_database.h"
#include "prepare/poses/focal_check.h"
#include "prepare/poses/join_parts.h"
#include "prepare/poses/loose_photos.h"
#include "prepare/poses/seed/verdict.h"
#include "prepare/poses/seed_model.h"
#include "prepare/poses/shot_poses.h"

namespace skyquilt::prepare::poses {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostNamed = 5;  // photos in a warning

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
std::string PairInputs(const std::vector<input::PhotoFile>& photos, const PairRules& rules) {
  std::string text = fmt::format("pairs {} {} {} {} {} {} {} {}\n", rules.all_below, rules.neighbors, rules.sectors, rules.sector_reach,
                                 rules.position_neighbors, rules.similar, rules.name_neighbors, rules.links);
  if (AnyRig(photos)) text += fmt::format("{} shots\n", rules.shot_neighbors);
  for (const input::PhotoFile& photo : photos) {
    const survey::PhotoTags& tags = photo.tags;
    text += tags.gps ? fmt::format("{:.9f} {:.9f}", tags.gps->latitude_deg, tags.gps->longitude_deg) : "-";
    text +=
        " " + TagText(tags.gimbal_pitch_deg) + " " + TagText(tags.gimbal_yaw_deg) + " " + TagText(tags.relative_altitude_m) + "\n" + RigInputs(photo);
  }
  return text;
}

StepHashes HashSteps(const Attempt& attempt, const std::vector<input::PhotoFile>& photos, const PoseOptions& options) {
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
  if (attempt.settings.hold_lens) text += "lenses held\n";
  if (attempt.settings.hold_focal) text += "focal lengths of the tags\n";
  hashes.model = base::HashHex(text);
  return hashes;
}

// Everything but the model.
void FillDatabaseOf(const Attempt& attempt, const StepHashes& hashes, const std::vector<input::PhotoFile>& photos, const PoseOptions& options,
                    base::ThreadPool& threads, RemoteTasks* ranks) {
  const ColmapJob& job = attempt.job;
  base::LogInfo("running COLMAP on {} photos; its log is {}", photos.size(), job.Log().string());
  if (!attempt.pairs) {
    FillFeatures(job, attempt.settings, photos, options, hashes.features, ranks);
    RunStep(job, {"matches", hashes.matches}, {kModelStep}, [&] { MatchByColmap(job, attempt.settings, photos, options); });
    return;
  }
  const auto choose = [&](const std::vector<input::PhotoFile>& found, FeatureStore& features) {
    return ChoosePairs(found, *attempt.pairs, static_cast<uint64_t>(options.seed), features, threads);
  };
  FillDatabase(job, attempt.settings, photos, options, {hashes.features, hashes.matches}, choose, threads, ranks);
}

std::optional<FarFocal> FarFocalOf(const ColmapJob& job, const FoundModel& model) {
  return FindFarFocal(survey::ReadColmapModel(model.folder), survey::ColmapDatabase(job.Database()).ReadCameras());
}

// Takes out the photos that the model has no reason to place. False when there are none.
bool RemoveLoose(Part& part) {
  const std::vector<std::string> removed = RemoveLoosePhotos(part.model, part.observations);
  if (removed.empty()) return false;
  const std::vector<std::string> named(removed.begin(), removed.begin() + static_cast<std::ptrdiff_t>(std::min(removed.size(), kMostNamed)));
  base::LogWarning("{} photos get no pose, because they have fewer than {} points in common with each of the others: {}{}", removed.size(),
                   kLeastTied, base::Join(named), removed.size() > kMostNamed ? ", ..." : "");
  return true;
}

// In a folder beside that of the mapper's models.
FoundModel Save(const ColmapJob& job, const std::string& suffix, const Part& part) {
  const fs::path folder = job.folder / (job.models + suffix);
  fs::remove_all(folder);
  survey::WriteColmapBinary(part.model, part.observations, folder);
  return {folder, part.model.images.size()};
}

// The largest of the mapper's models, or with the others that tags place beside it.
FoundModel MappedModel(const Attempt& attempt, const std::vector<input::PhotoFile>& photos, const PoseOptions& options) {
  const ColmapJob& job = attempt.job;
  const std::vector<FoundModel> models = FoundModels(job);
  std::vector<Part> parts;
  bool loose = false;
  for (const FoundModel& found : models) {
    if (!parts.empty() && found.n_photos < kLeastOfPart) break;
    parts.push_back({survey::ReadColmapModel(found.folder), survey::ReadColmapObservations(found.folder)});
    const bool removed = options.fast && RemoveLoose(parts.back());
    if (parts.size() == 1) loose = removed;
  }
  // More pairs may connect parts that show the same ground.
  if (const std::optional<Part> joined = JoinParts(parts, photos, attempt.settings.fast)) return Save(job, "_joined", *joined);
  if (models.size() > 1) {
    base::LogWarning(
        "COLMAP found {} models that do not connect; only the largest is used, with {} photos ({}). Photos between them would connect them",
        models.size(), parts.front().model.images.size(), models.front().folder.string());
  }
  return loose ? Save(job, "_tied", parts.front()) : models.front();
}

// The model, or one in which the photos of each shot of a rig have one pose. `hash`: of what the model depends on.
FoundModel PlacedByRigs(const Attempt& attempt, const FoundModel& found, const std::string& hash, const std::vector<input::PhotoFile>& photos,
                        base::ThreadPool& threads) {
  if (!AnyRig(photos)) return found;
  std::string text = hash + found.folder.string() + "\n";
  for (const input::PhotoFile& photo : photos) text += RigInputs(photo);
  const fs::path folder = attempt.job.folder / (attempt.job.models + "_rigs");
  RunStep(attempt.job, {kRigStep, base::HashHex(text)}, {}, [&] { PlaceByRigs(attempt.job, found.folder, photos, folder, threads); });
  return {folder, survey::CountColmapImages(folder)};
}

FoundModel FindModel(const Attempt& attempt, const StepHashes& hashes, const std::vector<input::PhotoFile>& photos, const PoseOptions& options,
                     base::ThreadPool& threads) {
  const ColmapJob& job = attempt.job;
  const ColmapStep mapper{attempt.settings.hold_focal ? kHeldFocalStep : kModelStep, hashes.model};
  // What the mapper has finished stays: the seeding had failed, or was not wanted.
  if (attempt.seed && !IsDone(job, mapper)) {
    RunStep(job, {kSeededStep, hashes.seeded}, {}, [&] { SeedModel(job, photos, threads); });
    if (const std::optional<FoundModel> seeded = SeededModelOf(job)) {
      const std::optional<FarFocal> far = FarFocalOf(job, *seeded);
      if (!far) return PlacedByRigs(attempt, *seeded, hashes.seeded, photos, threads);
      base::LogInfo("poses by tags and matches are left to COLMAP's mapper: they need {}", far->Text());
    }
  }
  RunStep(job, mapper, {}, [&] { MakeModels(job, attempt.settings, photos.size(), options); });
  return PlacedByRigs(attempt, MappedModel(attempt, photos, options), hashes.model, photos, threads);
}

// What an attempt gave.
struct Outcome {
  std::optional<FoundModel> model;
  std::optional<FarFocal> far;
  std::exception_ptr error;  // when there is no model
  std::string reason;        // why it is not enough; empty: it is

  // A model of a wrong shape is worth less than one of the right shape with more than half as many photos.
  double Worth() const {
    constexpr double kWrongShape = 0.5;
    return model ? static_cast<double>(model->n_photos) * (far ? kWrongShape : 1.0) : -1.0;
  }
};

Outcome Try(const Attempt& attempt, const std::vector<input::PhotoFile>& photos, const PoseOptions& options, base::ThreadPool& threads,
            RemoteTasks* ranks) {
  const StepHashes hashes = HashSteps(attempt, photos, options);
  FillDatabaseOf(attempt, hashes, photos, options, threads, ranks);
  Outcome outcome;
  try {
    outcome.model = FindModel(attempt, hashes, photos, options, threads);
  } catch (const NoModelError& error) {
    outcome.error = std::current_exception();
    outcome.reason = error.what();
    return outcome;
  }
  outcome.far = FarFocalOf(attempt.job, *outcome.model);
  if (outcome.far) {
    outcome.reason = "it found " + outcome.far->Text();
  } else if (static_cast<double>(outcome.model->n_photos) < kEnoughRegistered * static_cast<double>(photos.size())) {
    outcome.reason = fmt::format("it found the poses of {} of {} photos only", outcome.model->n_photos, photos.size());
  }
  return outcome;
}

void HoldFocal(Attempt& attempt) {
  attempt.settings.hold_focal = true;
  attempt.job.models = "sparse_held_focal";
}

// The best of several; when none has a model, throws what the last one threw.
fs::path ChooseModel(const std::vector<Outcome>& outcomes) {
  const Outcome& best = *std::max_element(outcomes.begin(), outcomes.end(), [](const Outcome& a, const Outcome& b) { return a.Worth() < b.Worth(); });
  if (!best.model) std::rethrow_exception(outcomes.back().error);
  if (best.far) {
    base::LogWarning(
        "the poses have {}: one of both is wrong. If it is the poses, heights are too; photos from another height or at an angle would show it. "
        "If the tags are wrong (cropped or enlarged photos), give a model with --model",
        best.far->Text());
  }
  return best.model->folder;
}

}  // namespace

fs::path RunColmap(const ColmapJob& job, const std::vector<input::PhotoFile>& photos, const PoseOptions& options, base::ThreadPool& threads,
                   RemoteTasks* ranks) {
  const fs::path program = base::FindProgram(options.colmap);
  if (program.empty()) {
    throw base::InputError(options.colmap, "there is no such program",
                           "Install COLMAP (Debian: apt install colmap), set prepare.colmap to its path, or give a model with --model");
  }
  const ColmapSettings settings{.program = program, .n_threads = threads.size(), .fast = options.fast, .hold_lens = AllExact(photos)};
  const Attempt first{job, settings, options.fast ? std::optional(PairRules{}) : std::nullopt, options.fast && options.seed_poses};
  std::vector<Outcome> outcomes = {Try(first, photos, options, threads, ranks)};
  if (!options.fast || outcomes.front().reason.empty()) return ChooseModel(outcomes);

  base::LogWarning("the fast way is not enough: {}. Once more with COLMAP's own settings and more pairs", outcomes.front().reason);
  Attempt second{job, settings, kMorePairs};
  second.job.folder = job.folder / "more_pairs";
  second.settings.fast = false;
  if (outcomes.front().far) HoldFocal(second);
  outcomes.push_back(Try(second, photos, options, threads, ranks));
  if (outcomes.back().far && !second.settings.hold_focal) {
    base::LogWarning("more pairs are not enough: {}. Once more with the focal length of the tags", outcomes.back().reason);
    HoldFocal(second);
    outcomes.push_back(Try(second, photos, options, threads, ranks));
  }
  const auto n_photos = [](const Outcome& outcome) { return outcome.model ? outcome.model->n_photos : 0; };
  if (!outcomes.back().model) base::LogWarning("more pairs give no model: {}", outcomes.back().reason);
  base::LogInfo("poses: {} photos in the fast way, {} with more pairs", n_photos(outcomes.front()), n_photos(outcomes.back()));
  return ChooseModel(outcomes);
}

}  // namespace skyquilt::prepare::poses
