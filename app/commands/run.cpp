#include <CLI/CLI.hpp>

#include "app/commands/command.h"
#include "coordinator/stages/level_settings.h"
#include "coordinator/stages/photo_inputs.h"
#include "coordinator/stages/stage.h"
#include "coordinator/stages/timed_run.h"
#include "core/base/errors.h"
#include "viewer/assets.h"

namespace skyquilt::app {
namespace {

struct RunFlags {
  std::vector<std::string> photos;
  std::string place;
  std::string model;
  std::string out;
  bool restart = false;
  bool add = false;
};

void Finish(coordinator::Pipeline& pipeline, const std::filesystem::path& photos, const std::string& model) {
  coordinator::RequireSameConfiguration(pipeline, "prepare");
  coordinator::RunStages(pipeline, photos, model);
  coordinator::ThrowIfBlocksFailed(pipeline.training, pipeline.project);
}

void RunAdding(const CommandState& state, const RunFlags& flags, const std::vector<config::Override>& overrides) {
  if (!flags.place.empty() || flags.photos.empty()) throw base::UsageError("skyquilt run --add needs the folders with the photos to add");
  const coordinator::Project project = coordinator::Project::Open(flags.out);
  coordinator::Pipeline pipeline = state.Begin(project, SettingsToAdd(state, project, overrides, flags.model, flags.restart), false);
  pipeline.adds = true;
  Finish(pipeline, FolderWithAdded(project, flags.photos), flags.model);
}

void Run(const CommandState& state, const RunFlags& flags, const std::vector<config::Override>& overrides) {
  if (flags.photos.empty() == flags.place.empty()) {
    throw base::UsageError("skyquilt run needs either a folder with photos, or videos, or --place NAME");
  }
  coordinator::Settings settings = state.Load({}, overrides);
  // Checked before the output folder is created and before hours of work.
  std::vector<std::filesystem::path> videos = coordinator::VideosAmong(flags.photos);
  const std::string first = flags.photos.empty() || !videos.empty() ? std::string() : flags.photos.front();
  coordinator::RequireInputs(settings, first, flags.model);
  if (coordinator::StageNamed("tour").wanted(settings)) viewer::TourPage(state.front_end);
  coordinator::Pipeline pipeline = state.Begin(coordinator::Project::Create(flags.out), std::move(settings), flags.restart);
  pipeline.level_settings = state.LoadForLevelPhotos(overrides);
  pipeline.videos = std::move(videos);
  coordinator::UseTotalTime(pipeline);
  coordinator::RecallLevelSettings(pipeline);
  Finish(pipeline, coordinator::PhotoFolderOf(flags.photos, pipeline.project), flags.model);
}

}  // namespace

void AddRun(CLI::App& app, CommandState& state) {
  const auto flags = std::make_shared<RunFlags>();
  const auto overrides = std::make_shared<std::vector<config::Override>>();
  CLI::App* command = app.add_subcommand("run", "run all stages: from photos to scene, map products and report");
  AddPhotosArgument(*command, flags->photos);
  command->add_option("-o,--out", flags->out, "project folder; created if it does not exist")->required()->type_name("FOLDER");
  AddPlaceFlag(
      *command, "--place",
      [flags, overrides](const std::string& name) {
        flags->place = name;
        overrides->push_back({"simulate.place", name});
      },
      "simulated place to use instead of photos" + AllowedText("simulate.place") + " [simulate.place]");
  AddModelFlag(*command, flags->model);
  AddControlFlags(*command, overrides);
  AddStatedFlags(*command, overrides);
  AddVideoFlags(*command, overrides);
  AddPanoramaFlags(*command, overrides);
  AddOptionFlag(*command, overrides, "--blocks", "partition.blocks", "rows x columns such as 2x2, size:<metres> per block, or auto");
  AddOptionFlag(*command, overrides, "--altitudes", "partition.altitudes",
                "altitude above ground in metres of each block, row by row from the south-west, separated by commas");
  AddOptionFlag(*command, overrides, "--image-width", "run.image_width",
                "scale photos down to this width in pixels for training and scoring; 0: full size; auto: by the time");
  AddOptionFlag(*command, overrides, "--holdout", "prepare.holdout",
                "photos held out of training, for scoring: every:N, every:N:offset, list:FILE or none");
  AddMaskFlags(*command, overrides);
  AddBoundaryFlag(*command, overrides);
  AddWithinFlag(*command, overrides);
  AddTrainingFlags(*command, overrides);
  AddAddFlag(*command, flags->add);
  command->add_flag("--restart", flags->restart, "remove all earlier results in the project folder first");
  command->footer(
      "Examples:\n"
      "  skyquilt run photos/ -o out --within 20min\n"
      "  skyquilt run photos/ -o out --blocks 2x2 --time-budget 10min --image-width 1000\n"
      "  skyquilt run photos/ --model sparse/0 -o out --blocks 3x3 --time-budget 15min\n"
      "  skyquilt run monday/ tuesday/ -o out --within 1h\n"
      "  skyquilt run wednesday/ -o out --add\n"
      "  skyquilt run DJI_0001.MP4 -o out --within 30min\n"
      "  skyquilt run --place town -o out/town --steps 3000\n"
      "  mpirun -n 3 skyquilt run photos/ -o out --time-budget 1h30m\n"
      "Run the same command again to continue after an interruption; finished stages are skipped.\n"
      "Exit status: 0 done, 2 wrong usage, 3 bad input, 4 a block failed (the rest is saved), 130 interrupted (resumable).");
  command->callback(
      [&state, flags, overrides] { state.run_command = [&state, flags, overrides] { (flags->add ? RunAdding : Run)(state, *flags, *overrides); }; });
}

}  // namespace skyquilt::app
