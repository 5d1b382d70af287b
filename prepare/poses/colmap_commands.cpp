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

namespace skyquilt::prepare {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxNeighbors = 24;
constexpr size_t kBlockSize = 10;  // photos per side of a block of pairs; small blocks report progress more often
// Pairs that one call of COLMAP verifies: starting it takes about 0.2 s, and a kill loses the pairs of one call.
constexpr size_t kPairsPerCall = 400;
constexpr size_t kMinVerified = 15;  // COLMAP's SiftMatching.min_num_inliers

using Arguments = std::vector<std::string>;

void Append(Arguments& to, const Arguments& more) {
  to.insert(to.end(), more.begin(), more.end());
}

std::string CameraKey(const PhotoFile& photo) {
  const survey::PhotoTags& tags = photo.tags;
  return std::to_string(photo.width) + "x" + std::to_string(photo.height) + "|" + tags.make + "|" + tags.model + "|" +
         (tags.focal_length_mm ? std::to_string(*tags.focal_length_mm) : "");
}

std::map<std::string, std::vector<const PhotoFile*>> GroupByCamera(const std::vector<PhotoFile>& photos) {
  std::map<std::string, std::vector<const PhotoFile*>> groups;
  for (const PhotoFile& photo : photos) groups[CameraKey(photo)].push_back(&photo);
  return groups;
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

// Without what says which camera the photos get. `list`: number of the file with their names.
ColmapCommand FeatureCommand(const ColmapJob& job, const ColmapSettings& settings, const PoseOptions& options, const std::vector<std::string>& names,
                             size_t list) {
  const FastColmapFlags flags;
  const fs::path file = job.folder / ("photos_" + std::to_string(list) + ".txt");
  std::string lines;
  for (const std::string& name : names) lines += name + "\n";
  base::WriteFileAtomically(file, lines);
  ColmapCommand command{settings.program, "feature_extractor", {}};
  command.arguments = {"--database_path",
                       job.Database().string(),
                       "--image_path",
                       job.photo_root.string(),
                       "--image_list_path",
                       file.string(),
                       "--SiftExtraction.use_gpu",
                       options.use_gpu ? "1" : "0",
                       "--SiftExtraction.num_threads",
                       std::to_string(settings.n_threads),
                       "--SiftExtraction.max_image_size",
                       std::to_string(options.max_image_size),
                       "--SiftExtraction.max_num_features",
                       std::to_string(settings.fast ? std::min(options.max_features, flags.max_features) : options.max_features),
                       "--random_seed",
                       std::to_string(options.seed)};
  if (settings.fast) Append(command.arguments, {"--SiftExtraction.first_octave", std::to_string(flags.first_octave)});
  if (!job.masks.empty()) Append(command.arguments, {"--ImageReader.mask_path", job.masks.string()});
  return command;
}

// Searches the photos with few features once more, for features of lower contrast; they keep their cameras.
void ExtractMoreFeatures(const ColmapJob& job, const ColmapSettings& settings, const PoseOptions& options, size_t first_list) {
  const FastColmapFlags flags;
  std::map<uint32_t, std::vector<std::string>> names_by_camera;
  std::vector<uint32_t> poor;
  size_t n_photos = 0;
  {
    survey::ColmapDatabase database(job.Database());
    for (const survey::DatabaseImage& image : database.ReadImages()) {
      ++n_photos;
      if (database.CountDescriptors(image.id) >= flags.few_features) continue;
      poor.push_back(image.id);
      names_by_camera[image.camera_id].push_back(image.name);
    }
    database.RemoveFeatures(poor);
  }
  if (poor.empty()) return;
  spdlog::info("{} of {} photos have fewer than {} features: they are searched once more, for lower contrast", poor.size(), n_photos,
               flags.few_features);
  for (const auto& [camera_id, names] : names_by_camera) {
    ColmapCommand command = FeatureCommand(job, settings, options, names, first_list++);
    Append(command.arguments, {"--ImageReader.existing_camera_id", std::to_string(camera_id), "--SiftExtraction.peak_threshold",
                               fmt::format("{:g}", flags.low_peak_threshold)});
    RunWithProgress(job, command, "find more features", names.size());
  }
}

}  // namespace

void ExtractFeatures(const ColmapJob& job, const ColmapSettings& settings, const std::vector<PhotoFile>& photos, const PoseOptions& options) {
  // Start with a new database: in a half-filled one the remaining photos would get another camera.
  for (const char* suffix : {"", "-journal", "-wal", "-shm"}) fs::remove(job.Database().string() + suffix);
  const auto groups = GroupByCamera(photos);
  if (groups.size() > 1) spdlog::info("{} kinds of photos (by size, camera, focal length): each gets its own camera model", groups.size());
  size_t index = 0;
  for (const auto& [key, group] : groups) {
    std::vector<std::string> names;
    names.reserve(group.size());
    for (const PhotoFile* photo : group) names.push_back(photo->name);
    ColmapCommand command = FeatureCommand(job, settings, options, names, index);
    Append(command.arguments, {"--ImageReader.camera_model", options.camera_model, "--ImageReader.single_camera", "1"});
    RunWithProgress(job, command, "find features", group.size());
    ++index;
  }
  if (settings.fast) ExtractMoreFeatures(job, settings, options, index);
}

void MatchByColmap(const ColmapJob& job, const ColmapSettings& settings, const std::vector<PhotoFile>& photos, const PoseOptions& options) {
  const auto n_tagged =
      static_cast<size_t>(std::count_if(photos.begin(), photos.end(), [](const PhotoFile& photo) { return photo.tags.gps.has_value(); }));
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
      spdlog::warn("{} photos without GPS tags: matching all {} pairs takes long; use photos with GPS tags, or give a model with --model",
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
    spdlog::warn("no pair of photos has {} matches", kMinVerified);
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
  const std::vector<survey::DatabaseMatches> verified = database.ReadTwoViewMatches();
  if (verified.size() < pairs.size()) {
    throw base::InputError(job.Log(), fmt::format("COLMAP verified {} of {} pairs only", verified.size(), pairs.size()),
                           "Read the log; to let COLMAP do the matching, set prepare.poses = \"colmap\" and add --restart");
  }
  const auto n_good = std::count_if(verified.begin(), verified.end(), [](const auto& pair) { return pair.features.size() >= kMinVerified; });
  spdlog::info("{} of {} pairs with matches see the same things", n_good, pairs.size());
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
  RunWithProgress(job, command, "find poses", n_photos);
}

FoundModel LargestModel(const ColmapJob& job) {
  FoundModel best;
  size_t n_models = 0;
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::directory_iterator(job.Models())) {
    if (entry.is_directory() && fs::exists(entry.path() / "images.bin")) folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  for (const fs::path& folder : folders) {
    const size_t n_photos = survey::ReadColmapModel(folder).images.size();
    ++n_models;
    if (n_photos > best.n_photos) best = {folder, n_photos};
  }
  if (best.folder.empty())
    throw base::InputError(job.Log(), "COLMAP found no model",
                           "The photos may overlap too little or be blurred: read the log, add photos, or give a model with --model");
  if (n_models > 1)
    spdlog::warn("COLMAP found {} models that do not connect; only the largest is used, with {} photos ({}). Photos between them would connect them",
                 n_models, best.n_photos, best.folder.string());
  return best;
}

}  // namespace skyquilt::prepare
