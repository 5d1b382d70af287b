#include "prepare/poses/extract_features.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/survey/colmap_merge.h"
#include "prepare/poses/focal_check.h"
#include "prepare/poses/shot_poses.h"

namespace skyquilt::prepare::poses {
namespace {

namespace fs = std::filesystem;

constexpr size_t kFewestPerThread = 4, kMostPerThread = 32;

fs::path PartsFolder(const ColmapJob& job) {
  return job.folder / "features";
}

std::string CameraKey(const input::PhotoFile& photo) {
  const survey::PhotoTags& tags = photo.tags;
  return std::to_string(photo.width) + "x" + std::to_string(photo.height) + "|" + tags.make + "|" + tags.model + "|" +
         (tags.focal_length_mm ? std::to_string(*tags.focal_length_mm) : "") + (photo.rig ? "|" + LensOfRig(*photo.rig) : "");
}

// Views that were computed have no distortion, and COLMAP reads no focal length in their tags that is better than a whole millimetre.
void SetExactLenses(const std::vector<input::PhotoFile>& photos, survey::ColmapDatabase& database) {
  std::map<std::string, double> focal_of_name;
  for (const input::PhotoFile& photo : photos) {
    if (photo.rig && photo.rig->exact_focal_px) focal_of_name.emplace(photo.name, *photo.rig->exact_focal_px);
  }
  std::map<uint32_t, double> focal_of_camera;
  for (const survey::DatabaseImage& image : database.ReadImages()) {
    if (const auto focal = focal_of_name.find(image.name); focal != focal_of_name.end()) focal_of_camera.emplace(image.camera_id, focal->second);
  }
  for (const auto& [id, focal_px] : focal_of_camera) database.SetFocal(id, focal_px, true);
}

// Names of photos that are such views.
std::set<std::string> ExactNames(const std::vector<input::PhotoFile>& photos) {
  std::set<std::string> names;
  for (const input::PhotoFile& photo : photos) {
    if (photo.rig && photo.rig->exact_focal_px) names.insert(photo.name);
  }
  return names;
}

std::vector<std::string> ExtractorArguments(const PoseOptions& options) {
  return {"--SiftExtraction.use_gpu",
          options.use_gpu ? "1" : "0",
          "--SiftExtraction.max_image_size",
          std::to_string(options.max_image_size),
          "--random_seed",
          std::to_string(options.seed)};
}

// A photo that has as many as it may keep is not searched again.
size_t FewFeatures(const PoseOptions& options) {
  return static_cast<size_t>(std::min(FastColmapFlags().few_features, options.max_features));
}

// The photos of each camera in parts of about the same size.
std::vector<survey::DatabasePart> SplitPhotos(const ColmapJob& job, const std::vector<input::PhotoFile>& photos, const std::string& input,
                                              size_t photos_per_part) {
  std::map<std::string, std::vector<std::string>> groups;
  for (const input::PhotoFile& photo : photos) groups[CameraKey(photo)].push_back(photo.name);
  if (groups.size() > 1) base::LogInfo("{} kinds of photos (by size, camera, focal length): each gets its own camera model", groups.size());
  std::vector<survey::DatabasePart> parts;
  uint32_t camera_id = 1;
  for (const auto& [key, names] : groups) {
    const size_t n_parts = (names.size() + photos_per_part - 1) / photos_per_part;
    for (size_t i = 0; i < n_parts; ++i) {
      survey::DatabasePart part{.file = {}, .camera_id = camera_id, .names = {}};
      std::string identity = input;
      for (size_t k = i * names.size() / n_parts; k < (i + 1) * names.size() / n_parts; ++k) {
        part.names.push_back(names[k]);
        identity += "\n" + names[k];
      }
      part.file = PartsFolder(job) / ("part_" + base::HashHex(identity) + ".db");
      parts.push_back(std::move(part));
    }
    ++camera_id;
  }
  return parts;
}

}  // namespace

std::string FeatureInputs(const ColmapJob& job, const ColmapSettings& settings, const std::vector<input::PhotoFile>& photos,
                          const PoseOptions& options) {
  std::string text = job.photo_root.string() + "\n" + options.camera_model + "\n" + std::to_string(options.max_image_size) + "\n" +
                     std::to_string(options.max_features) + "\n" + std::to_string(options.seed) + "\n" + std::to_string(options.use_gpu) + "\n";
  const auto add_file = [&text](const fs::path& file) {
    std::error_code error;
    const auto time = fs::last_write_time(file, error);
    text += file.string() + " " + std::to_string(fs::file_size(file, error)) + " " + std::to_string(time.time_since_epoch().count()) + "\n";
  };
  for (const input::PhotoFile& photo : photos) {
    add_file(job.photo_root / photo.name);
    const fs::path mask = job.masks / (photo.name + ".png");
    if (!job.masks.empty() && fs::exists(mask)) add_file(mask);
    if (photo.rig) text += LensOfRig(*photo.rig) + "\n";
  }
  const FastColmapFlags flags;
  if (settings.fast) text += fmt::format("fast {} {} {}\n", flags.first_octave, flags.max_features, FewFeatures(options));
  return text;
}

size_t PhotosPerPart(size_t n_photos, int n_processes, int n_threads) {
  const auto threads = static_cast<size_t>(std::max(n_threads, 1)), processes = static_cast<size_t>(std::max(n_processes, 0));
  const size_t most = kMostPerThread * threads;
  if (processes == 0) return most;
  return std::clamp((n_photos + 2 * processes - 1) / (2 * processes), kFewestPerThread * threads, most);
}

void ExtractFeatures(const ColmapJob& job, const ColmapSettings& settings, const std::vector<input::PhotoFile>& photos, const PoseOptions& options,
                     const std::string& input, RemoteTasks* ranks) {
  base::RequireWritableFolder(PartsFolder(job));
  const size_t per_part =
      ranks == nullptr ? PhotosPerPart(photos.size(), 0, settings.n_threads) : PhotosPerPart(photos.size(), ranks->size(), ranks->threads());
  const std::vector<survey::DatabasePart> parts = SplitPhotos(job, photos, input, per_part);
  const FastColmapFlags flags;
  const std::vector<std::string> thorough = {"--SiftExtraction.max_num_features", std::to_string(options.max_features)};
  const std::vector<std::string> fast = {"--SiftExtraction.max_num_features", std::to_string(std::min(options.max_features, flags.max_features)),
                                         "--SiftExtraction.first_octave", std::to_string(flags.first_octave)};
  const std::set<std::string> exact_names = ExactNames(photos);
  std::vector<PoseTask> missing;
  size_t n_missing = 0;
  for (const survey::DatabasePart& part : parts) {
    if (fs::exists(part.file)) continue;
    const bool exact = exact_names.contains(part.names.front());
    missing.emplace_back(FeatureTask{.job = job,
                                     .program = settings.program,
                                     .arguments = ExtractorArguments(options),
                                     .camera_model = exact ? "PINHOLE" : options.camera_model,
                                     .search = settings.fast ? fast : thorough,
                                     .few_features = settings.fast ? FewFeatures(options) : 0,
                                     .search_again = thorough,
                                     .names = part.names,
                                     .file = part.file});
    n_missing += part.names.size();
  }
  if (n_missing < photos.size()) base::LogInfo("features of {} of {} photos are already found", photos.size() - n_missing, photos.size());
  if (!missing.empty()) {
    base::Progress progress("find features", static_cast<double>(n_missing), "photos");
    const auto advance = [&progress](double more) { progress.Advance(more); };
    if (ranks != nullptr) {
      ranks->Run(missing, advance);
    } else {
      for (const PoseTask& task : missing) RunFeatureTask(std::get<FeatureTask>(task), settings.n_threads, advance);
    }
    progress.Finish();
  }
  survey::MergeFeatures(parts, job.Database());
  survey::ColmapDatabase database(job.Database());
  CorrectFocals(photos, database);
  SetExactLenses(photos, database);
}

void RemoveFeatureParts(const ColmapJob& job) {
  std::error_code ignored;
  fs::remove_all(PartsFolder(job), ignored);
}

}  // namespace skyquilt::prepare::poses
