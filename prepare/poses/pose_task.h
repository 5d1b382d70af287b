// Pieces of the search for poses that do not depend on each other: features of some photos, matches of some pairs. Any process that sees the same
// files can do one. A finished piece is a file, written whole or not at all.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/colmap_database.h"
#include "prepare/poses/colmap_step.h"
#include "prepare/poses/feature_matcher.h"
#include "prepare/poses/feature_store.h"

namespace skyquilt::prepare::poses {

// Features of photos of one camera, by COLMAP.
struct FeatureTask {
  ColmapJob job;
  std::filesystem::path program;
  std::vector<std::string> arguments;  // of feature_extractor, without those for files, threads, camera and those below
  std::string camera_model;            // COLMAP's name
  std::vector<std::string> search;     // arguments that say how hard to search
  // Photos with fewer features than this are searched once more, with these arguments instead. 0: none.
  size_t few_features = 0;
  std::vector<std::string> search_again;
  std::vector<std::string> names;  // of photos
  std::filesystem::path file;      // the database to make
};

// Matches of pairs of photos: a chunk (match_chunk.h).
struct MatchTask {
  std::filesystem::path database;
  std::vector<survey::ImagePair> pairs;
  MatchRules rules;
  size_t min_matches = 0;
  std::filesystem::path file;  // of the chunk
  std::string key;
};

using PoseTask = std::variant<FeatureTask, MatchTask>;

// As messages between processes. TaskFromText throws nlohmann::json::exception.
std::string ToText(const PoseTask& task);
PoseTask TaskFromText(const std::string& text);

// How much was done since the last call, in photos or pairs; called by any thread.
using TaskProgress = std::function<void(double more)>;

// Throws base::InputError that names the log when COLMAP fails, base::Interrupted.
void RunFeatureTask(const FeatureTask& task, int n_threads, const TaskProgress& on_progress);

// Runs tasks one after another. The descriptors of a database are kept from one task to the next.
class TaskRunner {
 public:
  // log: name of COLMAP's log in the folder of a task's job.
  TaskRunner(int n_threads, std::string log) : threads_(n_threads), log_(std::move(log)) {}
  // Throws base::InputError, base::Interrupted.
  void Run(const PoseTask& task, const TaskProgress& on_progress);

 private:
  void Match(const MatchTask& task, const TaskProgress& on_progress);

  base::ThreadPool threads_;
  std::string log_;
  std::filesystem::path database_;
  std::unique_ptr<FeatureStore> features_;
  std::unordered_map<uint32_t, uint32_t> photo_of_image_;  // place in features_
};

// Other processes that run tasks.
class RemoteTasks {
 public:
  virtual ~RemoteTasks() = default;
  virtual int size() = 0;     // number of processes, at least 1
  virtual int threads() = 0;  // of the one with the most
  // Runs all tasks, in any order; returns when all are done. on_progress is called by the calling thread. Throws base::InputError when one fails,
  // base::Interrupted.
  virtual void Run(std::span<const PoseTask> tasks, const TaskProgress& on_progress) = 0;
};

}  // namespace skyquilt::prepare::poses
