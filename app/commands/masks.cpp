#include <CLI/CLI.hpp>

#include "app/commands/command.h"
#include "masks/make_masks.h"

namespace skyquilt::app {

void AddMasks(CLI::App& app, CommandState& state) {
  struct MasksFlags {
    std::string project;
    bool restart = false;
  };
  const auto flags = std::make_shared<MasksFlags>();
  const auto overrides = std::make_shared<std::vector<config::Override>>();
  CLI::App* command = app.add_subcommand("masks", "make masks of a survey: of what moves, by a network, and of ground to ignore");
  command->add_option("project", flags->project, "project folder with a survey")->required()->type_name("FOLDER");
  AddMaskFlags(*command, overrides);
  command->add_flag("--restart", flags->restart, "remove the masks and everything made with them first");
  command->footer(
      "Examples:\n"
      "  skyquilt masks out --segment people.onnx --segment-config people.toml\n"
      "  skyquilt masks out --ignore-ground lake.geojson\n"
      "  skyquilt masks out --ignore-ground lake.geojson --restart     when there is a scene already\n"
      "  mpirun -n 4 skyquilt masks out --segment people.onnx --segment-config people.toml\n"
      "Writes out/survey/made_masks/; out/survey/made_masks/look/ shows what is ignored. Without flags, as the project was made. Given masks "
      "hold too.\n"
      "Exit status: 0 done, 2 wrong usage, 3 bad input, 130 interrupted (resumable).");
  command->callback([&state, flags, overrides] {
    state.run_command = [&state, flags, overrides] {
      coordinator::Pipeline pipeline = state.BeginIn(flags->project, *overrides, flags->restart);
      // Before --restart removes anything.
      masks::CheckFiles(pipeline.settings.masks);
      coordinator::MasksStage(pipeline);
    };
  });
}

}  // namespace skyquilt::app
