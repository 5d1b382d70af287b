// One stage of the way from photos to report: all that the pipeline has to know of it. The table of all stages is in stage_table.cpp; to add a stage,
// add a row there and its body to stage_bodies.cpp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "coordinator/project/stamp.h"
#include "coordinator/stages/pipeline.h"

namespace skyquilt::coordinator {

using Paths = std::vector<std::filesystem::path>;

// What happens when a finished stage's inputs are other ones now: the later, cheap stages follow by themselves; nobody's survey, blocks or
// hours of training are thrown away unasked.
enum class OnNewInputs { kAgain, kRefuse };

struct Stage {
  std::string name;
  // What its results depend on: "section.key", or "section." for a whole section.
  std::vector<std::string> options;
  // Of those, options that change nothing in its results.
  std::vector<std::string> without_effect = {};
  // Files it cannot begin without, and the stages that make them.
  struct Input {
    std::filesystem::path (*file)(const Project& project);
    std::string stage;
  };
  std::vector<Input> inputs = {};
  // Throws base::InputError when one of them is damaged, before anything is changed; null: the body finds out.
  void (*check)(const Project& project) = nullptr;
  // Identity of what it reads, by name.
  FlatOptions (*inputs)(const Pipeline& pipeline);
  // What it leaves behind, all of it removed when it is restarted.
  Paths (*outputs)(const Project& project);
  // What must exist for it to count as finished.
  Paths (*proof)(const Project& project);
  // Does the work; returns StageStamp::kDone or kFailed. The stamp identifies configuration and inputs.
  std::string (*body)(Pipeline& pipeline, const StageStamp& stamp);
  // Reads again what the body found, when there is nothing to do; null: nothing is kept. False when it cannot be read: the body runs again.
  bool (*recall)(Pipeline& pipeline) = nullptr;
  OnNewInputs on_new_inputs = OnNewInputs::kAgain;
  // A folder of its own within the project, with a stamp of its own; null: the project's.
  Project (*home)(const Project& project) = nullptr;
  bool dated = true;  // false for results that must be the same bytes each time: no dates, no copy of the configuration
};

// In the order they run.
const std::vector<Stage>& Stages();
// Of a name in the table; anything else is a bug.
const Stage& StageNamed(const std::string& name);

// The values of the options that a stage's results depend on.
FlatOptions StageOptions(const Stage& stage, Settings& settings);
// Deletes files and stamps of this stage and of every later one. Throws base::InputError.
void RemoveStagesFrom(const Project& project, const std::string& stage);

// Runs a stage unless its results are fresh. Throws base::InputError when something it needs is missing, base::UsageError as described in
// pipeline.h, and what its body throws.
void RunStage(Pipeline& pipeline, const std::string& name);

}  // namespace skyquilt::coordinator
