#include <chrono>

#include "coordinator/stages/addition.h"
#include "coordinator/stages/stage.h"
#include "coordinator/stages/training_width.h"
#include "core/base/amounts.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/system.h"
#include "core/base/text.h"

namespace skyquilt::coordinator {
namespace {

void RequireFile(const std::filesystem::path& file, const std::string& stage, const Project& project) {
  if (std::filesystem::exists(file)) return;
  throw base::InputError(file, "does not exist yet",
                         "Run 'skyquilt " + stage + (stage == "prepare" ? " PHOTOS -o " : " ") + project.folder.string() + "' first");
}

// Throws base::UsageError when the inputs have changed and the stage must not run again by itself.
void RequireSameInputs(const Project& project, const Stage& stage, const FlatOptions& inputs) {
  if (stage.on_new_inputs == OnNewInputs::kRunAgain) return;
  const std::string changes = base::Join(config::Differences(LoadStamp(project, stage.name)->inputs, inputs), "\n  ");
  throw base::UsageError("the inputs of '" + stage.name + "' in " + project.folder.string() + " have changed since it ran:\n  " + changes +
                         "\nUse another project folder, or --restart to remove the results of '" + stage.name + "' and of all later stages" +
                         (stage.name == "prepare" ? ". To add photos to those of a finished project, give their folder with --add" : ""));
}

// Throws base::UsageError when the stage's new results would not be those that a later stage used.
void RequireBefore(const Project& project, const Stage& stage, const FlatOptions& inputs) {
  if (stage.refused_after.empty() || !LoadStamp(project, stage.refused_after)) return;
  const std::optional<StageStamp> before = LoadStamp(project, stage.name);
  const std::string changes = base::Join(config::Differences(before ? before->inputs : FlatOptions(), inputs), "\n  ");
  throw base::UsageError("'" + stage.refused_after + "' in " + project.folder.string() + " has begun without these results of '" + stage.name +
                         "':\n  " + changes + "\nUse another project folder, or 'skyquilt " + stage.name + " " + project.folder.string() +
                         " --restart' with the same options, which removes all results from '" + stage.name + "' on and keeps those before");
}

}  // namespace

FlatOptions StageOptions(const Stage& stage, Settings& settings) {
  FlatOptions selected = Select(settings.Flat(), stage.options);
  for (const std::string& key : stage.ignored_options) selected.erase(key);
  return selected;
}

void RemoveStagesFrom(const Project& project, const std::string& name) {
  StageNamed(name);  // throws for an unknown name, with which the loop would remove every stage
  // Latest first: an interrupted removal never leaves a stage whose inputs are missing.
  for (auto stage = Stages().rbegin(); stage != Stages().rend(); ++stage) {
    std::error_code error;
    std::filesystem::remove(project.StampFile(stage->name), error);
    for (const std::filesystem::path& path : stage->outputs(project)) {
      std::filesystem::remove_all(path, error);
      if (error) throw base::InputError(path, "cannot be removed: " + error.message(), "Check the permissions of the project folder");
    }
    if (stage->name == name) return;
  }
}

void RequireSameConfiguration(Pipeline& pipeline, const std::string& first) {
  if (pipeline.restart) return;
  RecallTrainingWidth(pipeline, first);
  bool reached = false;
  for (const Stage& stage : Stages()) {
    reached = reached || stage.name == first;
    // A stage with a separate folder keeps its stamp there.
    if (reached && stage.separate_folder == nullptr) CheckStage(pipeline.project, stage.name, StageOptions(stage, pipeline.settings), {}, {});
  }
}

void RunStage(Pipeline& pipeline, const std::string& name) {
  const Stage& stage = StageNamed(name);
  const Project& project = pipeline.project;
  pipeline.comm.EndAfterStandstill(pipeline.settings.run.rank_timeout_s);
  for (const Stage::RequiredFile& required : stage.required) RequireFile(required.file(project), required.stage, project);
  if (stage.check != nullptr) stage.check(project);
  RecallTrainingWidth(pipeline, name);
  if (name == "partition") ChooseTrainingWidth(pipeline);
  // Identify the inputs before a restart removes anything: they may be among the removed files.
  StageStamp stamp{.stage = name, .state = StageStamp::kRunning, .options = StageOptions(stage, pipeline.settings), .inputs = stage.inputs(pipeline)};
  if (pipeline.restart) {
    RemoveStagesFrom(project, name);
    pipeline.restart = false;
  }
  const Freshness freshness = CheckStage(project, name, stamp.options, stamp.inputs, stage.completion_files(project));
  if (freshness == Freshness::kUpToDate) {
    if (stage.load_results == nullptr || stage.load_results(pipeline)) {
      base::LogInfo("{}: nothing to do, results are up to date", name);
      return;
    }
    base::LogInfo("{}: running again, because its results cannot be read", name);
  }
  if (freshness == Freshness::kInputsChanged || freshness == Freshness::kNotStarted) RequireBefore(project, stage, stamp.inputs);
  if (freshness == Freshness::kInputsChanged) {
    if (name == "prepare" && pipeline.adds) {
      BeginAddition(pipeline);
    } else if (!FollowsAddition(project, name)) {
      RequireSameInputs(project, stage, stamp.inputs);
    }
    if (name == "train" && FollowsAddition(project, name)) RemoveChangedFields(project);
    base::LogInfo("{}: running again, because its inputs have changed", name);
  }
  SaveStamp(project, stamp);
  if (stage.dated) base::WriteFileAtomically(project.ConfigFile(), pipeline.settings.Toml());
  base::LogInfo("{} started", name);
  pipeline.rendering_s = 0.0;
  const auto start = std::chrono::steady_clock::now();
  stamp.state = stage.body(pipeline, stamp);
  if (stage.dated) {
    stamp.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    stamp.rendering_seconds = pipeline.rendering_s;
    stamp.finished_utc = base::UtcTimestamp();
  }
  SaveStamp(project, stamp);
  base::LogDebug("{} took {}", name, base::FormatDuration(stamp.seconds));
}

}  // namespace skyquilt::coordinator
