#include "prepare/colmap_run.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <map>

#include "core/base/child_process.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/survey/colmap_model.h"

namespace skyquilt::prepare {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxNeighbors = 24;
constexpr size_t kBlockSize = 10;  // photos per side of a block of pairs; small blocks report progress more often

struct Step {
  std::string name;     // of its stamp file
  std::string label;    // of its progress line
  std::string command;  // of COLMAP
  std::vector<std::string> arguments;
};

std::string Key(const PhotoFile& photo) {
  const survey::PhotoTags& tags = photo.tags;
  return std::to_string(photo.width) + "x" + std::to_string(photo.height) + "|" + tags.make + "|" + tags.model + "|" +
         (tags.focal_length_mm ? std::to_string(*tags.focal_length_mm) : "");
}

std::map<std::string, std::vector<const PhotoFile*>> GroupByCamera(const std::vector<PhotoFile>& photos) {
  std::map<std::string, std::vector<const PhotoFile*>> groups;
  for (const PhotoFile& photo : photos) groups[Key(photo)].push_back(&photo);
  return groups;
}

// Identifies photos, masks and options: when any of them changes, finished steps must be repeated.
std::string InputHash(const ColmapJob& job, const std::vector<PhotoFile>& photos, const PrepareOptions& options) {
  std::string text = job.photo_root.string() + "\n" + options.camera_model + "\n" + std::to_string(options.max_image_size) + "\n" +
                     std::to_string(options.max_features) + "\n" + std::to_string(options.seed) + "\n" + std::to_string(options.use_gpu) + "\n";
  const auto add_file = [&text](const fs::path& file) {
    std::error_code error;
    const auto time = fs::last_write_time(file, error);
    text += file.string() + " " + std::to_string(fs::file_size(file, error)) + " " + std::to_string(time.time_since_epoch().count()) + "\n";
  };
  for (const PhotoFile& photo : photos) {
    add_file(job.photo_root / photo.name);
    const fs::path mask = job.masks / (photo.name + ".png");
    if (!job.masks.empty() && fs::exists(mask)) add_file(mask);
  }
  return base::HashHex(text);
}

fs::path StampFile(const ColmapJob& job, const std::string& step) {
  return job.folder / (step + ".done");
}

bool IsDone(const ColmapJob& job, const std::string& step, const std::string& hash) {
  const fs::path stamp = StampFile(job, step);
  const fs::path product = job.folder / (step == "model" ? "sparse" : "database.db");
  return fs::exists(product) && fs::exists(stamp) && base::ReadFile(stamp) == hash + "\n";
}

void RunStep(const ColmapJob& job, const fs::path& program, const Step& step, size_t n_photos) {
  const fs::path log = job.folder / "colmap.log";
  std::deque<std::string> last_lines;
  base::Progress progress(step.label, static_cast<double>(n_photos), "photos");
  base::Command command{program, {step.command}};
  command.arguments.insert(command.arguments.end(), step.arguments.begin(), step.arguments.end());
  // COLMAP links against Qt even for commands without a window; this lets it run without a display.
  command.environment = {"QT_QPA_PLATFORM=offscreen"};
  double share = 0.0;
  const int status = base::RunLogged(command, log, [&](const std::string& line) {
    last_lines.push_back(line);
    if (last_lines.size() > 3) last_lines.pop_front();
    share = std::max(share, ColmapLineProgress(line, n_photos));
    progress.Update(share * static_cast<double>(n_photos));
  });
  if (status == 0) {
    progress.Update(static_cast<double>(n_photos));
    progress.Finish();
    return;
  }
  std::string found = "COLMAP's " + step.command + " failed with status " + std::to_string(status);
  if (!last_lines.empty()) found += "; its last line: " + last_lines.back();
  throw base::InputError(log, found,
                         step.command == "mapper"
                             ? "The photos may overlap too little or be blurred: read the log, add photos, or give a model with --model"
                             : "Read the log; if memory ran out, lower prepare.max_image_size");
}

void ExtractFeatures(const ColmapJob& job, const fs::path& program, const std::vector<PhotoFile>& photos, const PrepareOptions& options) {
  // Start with a new database: in a half-filled one the remaining photos would get another camera.
  const fs::path database = job.folder / "database.db";
  for (const char* suffix : {"", "-journal", "-wal", "-shm"}) fs::remove(database.string() + suffix);
  const auto groups = GroupByCamera(photos);
  if (groups.size() > 1) spdlog::info("{} kinds of photos (by size, camera, focal length): each gets its own camera model", groups.size());
  size_t index = 0;
  for (const auto& [key, group] : groups) {
    const fs::path list = job.folder / ("photos_" + std::to_string(index) + ".txt");
    std::string names;
    for (const PhotoFile* photo : group) names += photo->name + "\n";
    base::WriteFileAtomically(list, names);
    Step step{"features", "find features", "feature_extractor", {}};
    step.arguments = {"--database_path",
                      database.string(),
                      "--image_path",
                      job.photo_root.string(),
                      "--image_list_path",
                      list.string(),
                      "--ImageReader.camera_model",
                      options.camera_model,
                      "--ImageReader.single_camera",
                      "1",
                      "--SiftExtraction.use_gpu",
                      options.use_gpu ? "1" : "0",
                      "--SiftExtraction.num_threads",
                      std::to_string(job.n_threads),
                      "--SiftExtraction.max_image_size",
                      std::to_string(options.max_image_size),
                      "--SiftExtraction.max_num_features",
                      std::to_string(options.max_features),
                      "--random_seed",
                      std::to_string(options.seed)};
    if (!job.masks.empty()) step.arguments.insert(step.arguments.end(), {"--ImageReader.mask_path", job.masks.string()});
    RunStep(job, program, step, group.size());
    ++index;
  }
}

void Match(const ColmapJob& job, const fs::path& program, const std::vector<PhotoFile>& photos, const PrepareOptions& options) {
  const auto n_tagged =
      static_cast<size_t>(std::count_if(photos.begin(), photos.end(), [](const PhotoFile& photo) { return photo.tags.gps.has_value(); }));
  const bool spatial = photos.size() >= kMinSpatialPhotos && 10 * n_tagged >= 9 * photos.size();
  Step step{"matches", "match features", spatial ? "spatial_matcher" : "exhaustive_matcher", {}};
  step.arguments = {"--database_path",
                    (job.folder / "database.db").string(),
                    "--SiftMatching.use_gpu",
                    options.use_gpu ? "1" : "0",
                    "--SiftMatching.num_threads",
                    std::to_string(job.n_threads),
                    "--random_seed",
                    std::to_string(options.seed)};
  if (spatial) {
    // Neighbours are limited by number only: COLMAP's default limit of 100 m is too small for high flights.
    step.arguments.insert(step.arguments.end(), {"--SpatialMatching.is_gps", "1", "--SpatialMatching.max_num_neighbors",
                                                 std::to_string(kMaxNeighbors), "--SpatialMatching.max_distance", "100000"});
  } else {
    step.arguments.insert(step.arguments.end(), {"--ExhaustiveMatching.block_size", std::to_string(photos.size() < 100 ? kBlockSize : 50)});
    if (photos.size() > 300) {
      spdlog::warn("{} photos without GPS tags: matching all {} pairs takes long; use photos with GPS tags, or give a model with --model",
                   photos.size(), photos.size() * (photos.size() - 1) / 2);
    }
  }
  RunStep(job, program, step, photos.size());
}

void Map(const ColmapJob& job, const fs::path& program, const std::vector<PhotoFile>& photos, const PrepareOptions& options) {
  const fs::path models = job.folder / "sparse";
  fs::remove_all(models);
  base::RequireWritableFolder(models);
  Step step{"model", "find poses", "mapper", {}};
  step.arguments = {
      "--database_path",      (job.folder / "database.db").string(), "--image_path",  job.photo_root.string(),     "--output_path", models.string(),
      "--Mapper.num_threads", std::to_string(job.n_threads),         "--random_seed", std::to_string(options.seed)};
  RunStep(job, program, step, photos.size());
}

fs::path LargestModel(const fs::path& models, const fs::path& log) {
  fs::path best;
  size_t best_images = 0;
  size_t n_models = 0;
  std::vector<fs::path> folders;
  for (const fs::directory_entry& entry : fs::directory_iterator(models)) {
    if (entry.is_directory() && fs::exists(entry.path() / "images.bin")) folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  for (const fs::path& folder : folders) {
    const size_t n_images = survey::ReadColmapModel(folder).images.size();
    ++n_models;
    if (n_images > best_images) {
      best_images = n_images;
      best = folder;
    }
  }
  if (best.empty())
    throw base::InputError(log, "COLMAP found no model",
                           "The photos may overlap too little or be blurred: read the log, add photos, or give a model with --model");
  if (n_models > 1)
    spdlog::warn("COLMAP found {} models that do not connect; only the largest is used, with {} photos ({}). Photos between them would connect them",
                 n_models, best_images, best.string());
  return best;
}

}  // namespace

double ColmapLineProgress(const std::string& line, size_t n_photos) {
  unsigned a = 0, b = 0, c = 0, d = 0;
  const auto share = [](double done, double total) { return total > 0.0 ? std::clamp(done / total, 0.0, 1.0) : -1.0; };
  if (const size_t at = line.find("Processed file ["); at != std::string::npos) {
    if (std::sscanf(line.c_str() + at, "Processed file [%u/%u]", &a, &b) == 2) return share(a, b);
  }
  if (const size_t at = line.find("Matching block ["); at != std::string::npos) {
    // Printed before each block of pairs: "[row/rows, column/columns]".
    if (std::sscanf(line.c_str() + at, "Matching block [%u/%u, %u/%u]", &a, &b, &c, &d) == 4 && a > 0 && c > 0) {
      return share((a - 1.0) * d + (c - 1.0), static_cast<double>(b) * d);
    }
    if (std::sscanf(line.c_str() + at, "Matching block [%u/%u]", &a, &b) == 2 && a > 0) return share(a - 1.0, b);
  }
  if (const size_t at = line.find("Matching image ["); at != std::string::npos) {
    if (std::sscanf(line.c_str() + at, "Matching image [%u/%u]", &a, &b) == 2 && a > 0) return share(a - 1.0, b);
  }
  if (const size_t at = line.find("Registering image #"); at != std::string::npos) {
    if (std::sscanf(line.c_str() + at, "Registering image #%u (%u)", &a, &b) == 2 && b > 0) return share(b - 1.0, static_cast<double>(n_photos));
  }
  return -1.0;
}

fs::path RunColmap(const ColmapJob& job, const std::vector<PhotoFile>& photos, const PrepareOptions& options) {
  const fs::path program = base::FindProgram(options.colmap);
  if (program.empty()) {
    throw base::InputError(options.colmap, "there is no such program",
                           "Install COLMAP (Debian: apt install colmap), set prepare.colmap to its path, or give a model with --model");
  }
  base::RequireWritableFolder(job.folder);
  const std::string hash = InputHash(job, photos, options);
  const auto run = [&](const std::string& name, const auto& step, const std::vector<std::string>& later) {
    if (IsDone(job, name, hash)) {
      spdlog::info("COLMAP {}: already done", name);
      return;
    }
    for (const std::string& stamp : later) fs::remove(StampFile(job, stamp));
    step(job, program, photos, options);
    base::WriteFileAtomically(StampFile(job, name), hash + "\n");
  };
  spdlog::info("running COLMAP on {} photos; its log is {}", photos.size(), (job.folder / "colmap.log").string());
  run("features", ExtractFeatures, {"features", "matches", "model"});
  run("matches", Match, {"matches", "model"});
  run("model", Map, {"model"});
  return LargestModel(job.folder / "sparse", job.folder / "colmap.log");
}

}  // namespace skyquilt::prepare
