// Makes the masks of photos, one by one. What is made of a photo is a file each, so that any process that sees the same files can do a part of the
// photos, and what is there already is kept while nothing that it was made of has changed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/made_masks.h"
#include "core/survey/survey.h"
#include "masks/ignored_ground.h"
#include "masks/mask_options.h"
#include "masks/segmenter.h"

namespace skyquilt::masks {

// Photos of a survey, as a message between processes.
struct MaskTask {
  std::filesystem::path survey_folder;  // absolute
  MaskOptions options;
  std::vector<size_t> photos;  // in the survey's order
};
std::string ToText(const MaskTask& task);
// Throws nlohmann::json::exception.
MaskTask TaskFromText(const std::string& text);

// How many more photos are done; called by any thread.
using TaskProgress = std::function<void(double more)>;

// Runs tasks one after another; survey, polygons and networks are read once.
class MaskRunner {
 public:
  explicit MaskRunner(int n_threads) : threads_(n_threads) {}
  // Writes the files of the task's photos below made_masks/ of the survey, where masks.json must not be: the survey's masks are those that were
  // given. Throws base::InputError: a network, a configuration, polygons, a photo or a mask that cannot be used; base::Interrupted.
  void Run(const MaskTask& task, const TaskProgress& on_progress);

 private:
  void Open(const MaskTask& task);
  void MaskPhoto(size_t photo, size_t thread);
  image::Image8 NetworkMask(const survey::Photo& photo, const std::string& key, size_t thread);
  Segmenter& SegmenterOf(size_t thread);

  base::ThreadPool threads_;
  std::optional<MaskTask> opened_;
  survey::Survey survey_;
  std::optional<IgnoredGround> ground_;
  std::vector<std::unique_ptr<Segmenter>> segmenters_;  // one per thread
};

// What MaskRunner wrote about a photo. Throws base::InputError when it is not there or damaged.
survey::MadeMask ReadMadeMask(const std::filesystem::path& survey_folder, const std::string& photo);

}  // namespace skyquilt::masks
