#include "prepare/poses/colmap_commands.h"

#include <algorithm>
#include <map>
#include <string>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/survey/colmap_database.h"
#include "core/survey/colmap_model.h"

namespace skyquilt::prepare::poses {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxNeighbors = 24;
constexpr size_t kBlockSize = 10;  // photos per side of a block of pairs; small blocks report progress more often
// Pairs that one call of COLMAP verifies: starting it takes about 0.2 s, and a kill loses the pairs of one call.
constexpr size_t kPairsPerCall = 400;
constexpr size_t kMinSpatialPhotos = 60;

using Arguments = std::vector<std::string>;

void Append(Arguments& to, const Arguments& more) {
  to.insert(to.end(), more.begin(), more.end());
}

Arguments MatchingArguments(const ColmapJob& job, const ColmapSettings& settings, const PoseOptions& options, bool use_gpu) {
  return {"--database_path",   job.Database().string(),      "--SiftMatching.use_gpu",
          use_gpu ? "1" : "0", "--SiftMatching.num_threads", std::to_string(settings.n_threads),
          "--random_seed",     std::to_string(options.seed)};
}

// Whether COLMAP can read the name in a list of pairs, where spaces separate.
bool IsPlain(const std::string& name) {
  return !name.starts_with('#') && std::none_of(name.begin(), name.end(), [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); });
}

}  // namespace

void MatchByColmap(const ColmapJob& job, const ColmapSettings& settings, const std::vector<input::PhotoFile>& photos, const PoseOptions& options) {
  // COLMAP knows the positions in EXIF tags only, not those of our position files.
  const size_t n_tagged = survey::ColmapDatabase(job.Database()).CountPlaced();
  const bool spatial = photos.size() >= kMinSpatialPhotos && 10 * n_tagged >= 9 * photos.size();
  ColmapCommand command{settings.program, spatial ? "spatial_matcher" : "exhaustive_matcher",
                        MatchingArguments(job, settings, options, options.use_gpu)};
  if (spatial) {
    // Neighbours are limited by number only: COLMAP's default limit of 100 m is too small for high flights.
    Append(command.arguments, {"--SpatialMatching.is_gps", "1", "--SpatialMatching.max_num_neighbors", std::to_string(kMaxNeighbors),
                               "--SpatialMatching.max_distance", "100000"});
  } else {
    Append(command.arguments, {"--ExhaustiveMatching.block_size", std::to_string(photos.size() < 100 ? kBlockSize : 50)});
    if (photos.size() > 300) {
      base::LogWarning(
          "most of {} photos without GPS in their EXIF tags: matching all {} pairs takes long; use photos with GPS tags, or give a model with "
          "--model",
          photos.size(), photos.size() * (photos.size() - 1) / 2);
    }
  }
  RunWithProgress(job, command, "match features", photos.size());
}

void VerifyMatches(const ColmapJob& job, const ColmapSettings& settings, const PoseOptions& options) {
  std::vector<survey::ImagePair> pairs;
  std::map<uint32_t, std::string> names;
  {
    // Closed before COLMAP opens it, since plain names end with the next opening.
    survey::ColmapDatabase database(job.Database());
    pairs = database.ReadMatchedPairs(kMinVerified);
    bool plain = true;
    for (const survey::DatabaseImage& image : database.ReadImages()) {
      names.emplace(image.id, image.name);
      plain = plain && IsPlain(image.name);
    }
    if (!plain) {
      database.UsePlainNames();
      for (auto& [id, name] : names) name = survey::ColmapDatabase::PlainName(id);
    }
  }
  if (pairs.empty()) {
    base::LogWarning("no pair of photos has {} matches", kMinVerified);
    return;
  }
  const fs::path list = job.folder / "pairs.txt";
  ColmapCommand command{settings.program, "matches_importer", MatchingArguments(job, settings, options, false)};
  Append(command.arguments, {"--match_list_path", list.string(), "--match_type", "pairs"});
  base::Progress progress("verify matches", static_cast<double>(pairs.size()), "pairs");
  for (size_t first = 0; first < pairs.size(); first += kPairsPerCall) {
    const size_t end = std::min(pairs.size(), first + kPairsPerCall);
    std::string lines;
    for (size_t i = first; i < end; ++i) lines += names[pairs[i].first] + " " + names[pairs[i].second] + "\n";
    base::WriteFileAtomically(list, lines);
    // COLMAP takes the matches from the database and skips pairs that it has verified before.
    RunColmapCommand(job, command, [](const std::string& /*line*/) {});
    progress.Update(static_cast<double>(end));
  }
  progress.Finish();
  survey::ColmapDatabase database(job.Database());
  const size_t n_verified = database.CountTwoViewGeometries(0);
  if (n_verified < pairs.size()) {
    throw base::InputError(job.Log(), fmt::format("COLMAP verified {} of {} pairs only", n_verified, pairs.size()),
                           "Read the log; to let COLMAP do the matching, set prepare.poses = \"colmap\" and add --restart");
  }
  base::LogInfo("{} of {} pairs with matches see the same things", database.CountTwoViewGeometries(kMinVerified), pairs.size());
}

void MakeModels(const ColmapJob& job, const ColmapSettings& settings, size_t n_photos, const PoseOptions& options) {
  fs::remove_all(job.Models());
  base::RequireWritableFolder(job.Models());
  ColmapCommand command{settings.program, "mapper", {}};
  command.arguments = {"--database_path", job.Database().string(),     "--image_path",         job.photo_root.string(),
                       "--output_path",   job.Models().string(),       "--Mapper.num_threads", std::to_string(settings.n_threads),
                       "--random_seed",   std::to_string(options.seed)};
  if (settings.fast) {
    const FastColmapFlags flags;
    Append(command.arguments,
           {"--Mapper.ba_global_function_tolerance", fmt::format("{:g}", flags.ba_global_function_tolerance), "--Mapper.ba_global_images_ratio",
            fmt::format("{:g}", flags.ba_global_images_ratio), "--Mapper.ba_global_points_ratio", fmt::format("{:g}", flags.ba_global_points_ratio),
            "--Mapper.ba_global_max_refinements", std::to_string(flags.ba_global_max_refinements)});
  }
  if (settings.hold_focal && !settings.hold_lens) Append(command.arguments, {"--Mapper.ba_refine_focal_length", "0"});
  if (settings.hold_lens) Append(command.arguments, {"--Mapper.ba_refine_focal_length", "0", "--Mapper.ba_refine_extra_params", "0"});
  RunWithProgress(job, command, "find poses", n_photos);
}

std::vector<FoundModel> FoundModels(const ColmapJob& job) {
  std::vector<FoundModel> models;
  for (const fs::directory_entry& entry : fs::directory_iterator(job.Models())) {
    if (!entry.is_directory() || !fs::exists(entry.path() / "images.bin")) continue;
    models.push_back({entry.path(), survey::CountColmapImages(entry.path())});
  }
  if (models.empty()) throw NoModelError(job.Log(), "COLMAP found no model", kNoModelFix);
  std::sort(models.begin(), models.end(),
            [](const FoundModel& a, const FoundModel& b) { return a.n_photos != b.n_photos ? a.n_photos > b.n_photos : a.folder < b.folder; });
  return models;
}

}  // namespace skyquilt::prepare::poses
