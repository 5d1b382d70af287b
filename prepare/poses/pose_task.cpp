#include "prepare/poses/pose_task.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/system.h"
#include "core/survey/colmap_merge.h"
#include "prepare/poses/match_chunk.h"

namespace skyquilt::prepare::poses {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json JsonOf(const FeatureTask& task) {
  return {{"photo_root", task.job.photo_root.string()},
          {"masks", task.job.masks.string()},
          {"folder", task.job.folder.string()},
          {"program", task.program.string()},
          {"arguments", task.arguments},
          {"camera_model", task.camera_model},
          {"search", task.search},
          {"few_features", task.few_features},
          {"search_again", task.search_again},
          {"names", task.names},
          {"file", task.file.string()}};
}

json JsonOf(const MatchTask& task) {
  return {{"database", task.database.string()}, {"pairs", task.pairs},
          {"max_ratio", task.rules.max_ratio},  {"max_distance", task.rules.max_distance},
          {"mutual", task.rules.mutual},        {"min_matches", task.min_matches},
          {"file", task.file.string()},         {"key", task.key}};
}

// COLMAP 3.8 stores whatever memory held as the descriptor of a feature that lies beyond the last row or column of its octave, where VLFeat computes
// none: one in about 7000 features of Brighton Beach. The GNU C library can fill new memory, so that the same photo gives the same bytes each time.
const std::vector<std::string> kFilledMemory = {"MALLOC_PERTURB_=170", "GLIBC_TUNABLES=glibc.malloc.tcache_count=0"};

// About the time that the first of two searches takes, where most photos are searched twice.
constexpr double kFirstSearchShare = 0.4;

struct PoorPhotos {
  std::vector<std::string> names;
  uint32_t camera_id = 0;
};

// The photos with fewer features than that, all of one camera; they lose those they have.
PoorPhotos RemovePoorFeatures(const fs::path& file, size_t few_features) {
  survey::ColmapDatabase database(file);
  PoorPhotos poor;
  std::vector<uint32_t> ids;
  for (const survey::DatabaseImage& image : database.ReadImages()) {
    if (database.CountDescriptors(image.id) >= few_features) continue;
    ids.push_back(image.id);
    poor.names.push_back(image.name);
    poor.camera_id = image.camera_id;
  }
  database.RemoveFeatures(ids);
  return poor;
}

fs::path PathIn(const json& text, const char* key) {
  return text.at(key).get<std::string>();
}

}  // namespace

std::string ToText(const PoseTask& task) {
  json text = std::visit([](const auto& one) { return JsonOf(one); }, task);
  text["features"] = std::holds_alternative<FeatureTask>(task);
  // Names of files are bytes of any encoding: as CBOR they pass unchanged where JSON demands UTF-8.
  const std::vector<uint8_t> bytes = json::to_cbor(text);
  return {bytes.begin(), bytes.end()};
}

PoseTask TaskFromText(const std::string& bytes) {
  const json text = json::from_cbor(bytes);
  if (text.at("features").get<bool>()) {
    return FeatureTask{.job = {.photo_root = PathIn(text, "photo_root"), .masks = PathIn(text, "masks"), .folder = PathIn(text, "folder")},
                       .program = PathIn(text, "program"),
                       .arguments = text.at("arguments").get<std::vector<std::string>>(),
                       .camera_model = text.at("camera_model").get<std::string>(),
                       .search = text.at("search").get<std::vector<std::string>>(),
                       .few_features = text.at("few_features").get<size_t>(),
                       .search_again = text.at("search_again").get<std::vector<std::string>>(),
                       .names = text.at("names").get<std::vector<std::string>>(),
                       .file = PathIn(text, "file")};
  }
  MatchTask task;
  task.database = PathIn(text, "database");
  task.file = PathIn(text, "file");
  text.at("key").get_to(task.key);
  text.at("pairs").get_to(task.pairs);
  text.at("max_ratio").get_to(task.rules.max_ratio);
  text.at("max_distance").get_to(task.rules.max_distance);
  text.at("mutual").get_to(task.rules.mutual);
  text.at("min_matches").get_to(task.min_matches);
  return task;
}

void RunFeatureTask(const FeatureTask& task, int n_threads, const TaskProgress& on_progress) {
  // A process of a run that was killed may still write: every process has files of its own.
  const std::string own = task.file.string() + "." + base::HostName() + "." + std::to_string(getpid());
  const fs::path database = own + ".db", list = own + ".txt";
  survey::RemoveDatabase(database);
  const auto total = static_cast<double>(task.names.size());
  double done = 0.0;
  const auto advance = [&](double to) {
    if (to > done) on_progress(to - done);
    done = std::max(done, to);
  };
  // The progress of a search goes from `from` to `to`, in photos.
  const auto search = [&](const std::vector<std::string>& names, const std::vector<std::string>& how, const std::vector<std::string>& camera,
                          double from, double to) {
    std::string lines;
    for (const std::string& name : names) lines += name + "\n";
    base::WriteFileAtomically(list, lines);
    ColmapCommand command{task.program, "feature_extractor", task.arguments, kFilledMemory};
    const std::vector<std::string> files = {"--database_path",
                                            database.string(),
                                            "--image_path",
                                            task.job.photo_root.string(),
                                            "--image_list_path",
                                            list.string(),
                                            "--SiftExtraction.num_threads",
                                            std::to_string(n_threads)};
    command.arguments.insert(command.arguments.end(), files.begin(), files.end());
    command.arguments.insert(command.arguments.end(), how.begin(), how.end());
    command.arguments.insert(command.arguments.end(), camera.begin(), camera.end());
    if (!task.job.masks.empty()) command.arguments.insert(command.arguments.end(), {"--ImageReader.mask_path", task.job.masks.string()});
    RunColmapCommand(task.job, command,
                     [&](const std::string& line) { advance(from + (to - from) * std::max(0.0, ColmapLineProgress(line, names.size()))); });
    advance(to);
  };
  const double first_end = task.few_features > 0 ? kFirstSearchShare * total : total;
  search(task.names, task.search, {"--ImageReader.camera_model", task.camera_model, "--ImageReader.single_camera", "1"}, 0.0, first_end);
  if (task.few_features > 0) {
    const PoorPhotos poor = RemovePoorFeatures(database, task.few_features);
    if (!poor.names.empty()) {
      search(poor.names, task.search_again, {"--ImageReader.existing_camera_id", std::to_string(poor.camera_id)}, first_end, total);
    }
  }
  survey::ColmapDatabase(database).UseOneFile();
  base::Publish(database, task.file);
  fs::remove(list);
  advance(total);
}

void TaskRunner::Run(const PoseTask& task, const TaskProgress& on_progress) {
  if (const auto* features = std::get_if<FeatureTask>(&task)) {
    FeatureTask logged = *features;
    logged.job.log = log_;
    RunFeatureTask(logged, threads_.size(), on_progress);
  } else {
    Match(std::get<MatchTask>(task), on_progress);
  }
}

void TaskRunner::Match(const MatchTask& task, const TaskProgress& on_progress) {
  if (features_ == nullptr || database_ != task.database) {
    features_.reset();
    photo_of_image_.clear();
    std::vector<std::string> names;
    for (const survey::DatabaseImage& image : survey::ColmapDatabase(task.database).ReadImages()) {
      photo_of_image_.emplace(image.id, static_cast<uint32_t>(names.size()));
      names.push_back(image.name);
    }
    features_ = std::make_unique<FeatureStore>(task.database, names, kFeatureMemory_bytes);
    database_ = task.database;
  }
  PhotoPairs pairs;
  for (const auto& [first, second] : task.pairs) {
    const auto a = photo_of_image_.find(first), b = photo_of_image_.find(second);
    if (a == photo_of_image_.end() || b == photo_of_image_.end()) {
      throw base::InputError(task.database, fmt::format("has no images {} and {}", first, second), "All ranks must see the same project folder");
    }
    pairs.push_back({a->second, b->second});
  }
  SaveChunk(task.file, task.key,
            MatchChunk(
                *features_, pairs, task.rules, task.min_matches, [&] { on_progress(1.0); }, threads_));
}

}  // namespace skyquilt::prepare::poses
