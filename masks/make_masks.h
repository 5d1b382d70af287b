// `skyquilt masks`: masks of a prepared survey, by a network and by polygons. Written below made_masks/ of the survey:
//   masks.json        the table that the survey is loaded with afterwards (core/survey/made_masks.h); written last
//   combined/         masks that training and all later stages use: PNG of the photo's size, 0 = ignored; only where they differ from those given
//   look/             photos with what is ignored tinted, for people: red by the network, blue on ignored ground, grey by the given mask
//   network/, photos/ what the network found, and a record per photo: kept, so that an interrupted run goes on and another one repeats only what
//                     has changed
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "core/base/thread_pool.h"
#include "core/survey/made_masks.h"
#include "masks/mask_options.h"
#include "masks/mask_runner.h"

namespace skyquilt::masks {

// Other processes that run tasks.
class RemoteTasks {
 public:
  virtual ~RemoteTasks() = default;
  virtual int threads() = 0;  // of the one with the most
  // Runs all tasks (ToText), in any order; returns when all are done. on_progress is called by the calling thread. Throws base::InputError when one
  // fails, base::Interrupted.
  virtual void Run(std::span<const std::string> tasks, const TaskProgress& on_progress) = 0;
};

// Throws base::InputError for a network, a configuration or polygons that cannot be used with any survey: before hours are spent.
void CheckFiles(const MaskOptions& options);

// survey_folder: absolute, of a prepared survey; masks.json of earlier calls is removed. Logs shares, and warns where much is ignored. Without
// options it writes nothing. `ranks`: processes that share the photos; null: this one does all, with the same result. Throws as MaskRunner.
survey::MadeMasks MakeMasks(const std::filesystem::path& survey_folder, const MaskOptions& options, int n_threads, RemoteTasks* ranks = nullptr);

}  // namespace skyquilt::masks
