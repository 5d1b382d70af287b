#include <CLI/CLI.hpp>

#include "app/commands/command.h"
#include "coordinator/stages/photo_inputs.h"

namespace skyquilt::app {

void AddPrepare(CLI::App& app, CommandState& state) {
  struct PrepareFlags {
    std::vector<std::string> photos;
    std::string model;
    std::string out;
    bool restart = false;
    bool add = false;
  };
  const auto flags = std::make_shared<PrepareFlags>();
  const auto overrides = std::make_shared<std::vector<config::Override>>();
  CLI::App* command = app.add_subcommand("prepare", "make a geo-referenced survey from photos and their camera model");
  AddPhotosArgument(*command, flags->photos);
  command->get_option("photos")->required();
  command->add_option("-o,--out", flags->out, "project folder; created if it does not exist")->required()->type_name("FOLDER");
  AddModelFlag(*command, flags->model);
  AddControlFlags(*command, overrides);
  AddStatedFlags(*command, overrides);
  AddVideoFlags(*command, overrides);
  AddPanoramaFlags(*command, overrides);
  AddOptionFlag(*command, overrides, "--holdout", "prepare.holdout",
                "photos held out of training, for scoring: every:N, every:N:offset, list:FILE or none");
  AddOptionFlag(*command, overrides, "--masks", "prepare.masks",
                "folder of masks named PHOTO.jpg.png, or one mask for all photos; pixels with value 0 are ignored; none: no masks");
  AddAddFlag(*command, flags->add);
  command->add_flag("--restart", flags->restart, "remove the survey and everything made from it first");
  command->footer(
      "Examples:\n"
      "  skyquilt prepare photos/ -o out\n"
      "  skyquilt prepare monday/ tuesday/ -o out\n"
      "  skyquilt prepare DJI_0001.MP4 DJI_0002.MP4 -o out --video-limit 300\n"
      "  skyquilt prepare panoramas/ -o out --nadir-mask 25\n"
      "  skyquilt prepare photos/ --model sparse/0 -o out\n"
      "  skyquilt prepare photos/ --model odm/opensfm/reconstruction.json -o out\n"
      "  skyquilt prepare photos/ -o out --holdout every:10\n"
      "  skyquilt prepare photos/ --gcp gcp_list.txt --check-points T3,T7 -o out\n"
      "  skyquilt prepare facade/ --up cameras --scale-bar left,right,2.35 --set prepare.gcp_marks=marks.csv -o out\n"
      "Writes out/survey/. Exit status: 0 done, 2 wrong usage, 3 bad input, 130 interrupted.");
  command->callback([&state, flags, overrides] {
    state.run_command = [&state, flags, overrides] {
      if (flags->add) {
        const coordinator::Project project = coordinator::Project::Open(flags->out);
        coordinator::Pipeline pipeline = state.Begin(project, SettingsToAdd(state, project, *overrides, flags->model, flags->restart), false);
        pipeline.adds = true;
        coordinator::PrepareStage(pipeline, FolderWithAdded(project, flags->photos), flags->model);
        return;
      }
      coordinator::Settings settings = state.Load({}, *overrides);
      std::vector<std::filesystem::path> videos = coordinator::VideosAmong(flags->photos);
      coordinator::Pipeline pipeline = state.Begin(coordinator::Project::Create(flags->out), std::move(settings), flags->restart);
      pipeline.level_settings = state.LoadForLevelPhotos(*overrides);
      pipeline.videos = std::move(videos);
      coordinator::PrepareStage(pipeline, coordinator::PhotoFolderOf(flags->photos, pipeline.project), flags->model);
    };
  });
}

}  // namespace skyquilt::app
