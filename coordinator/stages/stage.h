// Description of one stage of the pipeline: the options it depends on, its inputs, its outputs and its work. The table of all stages is in
// stage_table.cpp; to add a stage, add a row there and its body to stage_bodies.cpp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "coordinator/project/stamp.h"
#include "coordinator/stages/pipeline.h"

namespace skyquilt::coordinator {

using Paths = std::vector<std::filesystem::path>;

// What to do when the inputs of a finished stage have changed. Later, cheap stages run again by themselves; survey, blocks and hours of training are
// never removed without the user's consent.
enum class OnNewInputs { kRunAgain, kRefuse };

struct Stage {
  std::string name;
  // The options its results depend on: "section.key", or "section." for a whole section.
  std::vector<std::string> options;
  // Exceptions: options in those sections that do not change its results.
  std::vector<std::string> ignored_options = {};
  // Files that must exist before it starts, and the stages that make them.
  struct RequiredFile {
    std::filesystem::path (*file)(const Project& project);
    std::string stage;
  };
  std::vector<RequiredFile> required = {};
  // Throws base::InputError when one of them is damaged, before anything is changed; null: only the body checks.
  void (*check)(const Project& project) = nullptr;
  // Identity of its inputs, by name.
  FlatOptions (*inputs)(const Pipeline& pipeline);
  // Everything it writes; removed when it is restarted.
  Paths (*outputs)(const Project& project);
  // Files that must exist for it to count as finished.
  Paths (*completion_files)(const Project& project);
  // Does the work; returns StageStamp::kDone or kFailed. stamp: configuration and inputs of this run.
  std::string (*body)(Pipeline& pipeline, const StageStamp& stamp);
  // Reads the results into the pipeline when there is nothing to do; null: no results are needed. Returns false when they cannot be read, and the
  // body runs again.
  bool (*load_results)(Pipeline& pipeline) = nullptr;
  // Whether `run` makes it; null: always.
  bool (*wanted)(const Settings& settings) = nullptr;
  OnNewInputs on_new_inputs = OnNewInputs::kRunAgain;
  // A later stage of which results must not be there when this one runs for the first time or with new inputs; they would no longer be what this
  // stage's results give. Empty: none.
  std::string refused_after = {};
  // A separate folder for this stage and its stamp; null: the project folder.
  Project (*separate_folder)(const Project& project) = nullptr;
  bool dated = true;  // false: no date and no copy of the configuration are written, so that results are the same bytes each time
};

// In the order they run.
const std::vector<Stage>& Stages();
// The stage with this name, which must be in the table.
const Stage& StageNamed(const std::string& name);

// The values of the options that a stage's results depend on.
FlatOptions StageOptions(const Stage& stage, Settings& settings);
// Deletes files and stamps of this stage and of every later one. Throws base::InputError.
void RemoveStagesFrom(const Project& project, const std::string& stage);

// Runs a stage unless its results are fresh. Throws base::InputError when something it needs is missing, base::UsageError as described in
// pipeline.h, and what its body throws.
void RunStage(Pipeline& pipeline, const std::string& name);

}  // namespace skyquilt::coordinator
