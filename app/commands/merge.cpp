#include <CLI/CLI.hpp>

#include "app/commands/command.h"

namespace skyquilt::app {

void AddMerge(CLI::App& app, CommandState& state) {
  struct MergeFlags {
    std::string project;
    bool restart = false;
  };
  const auto flags = std::make_shared<MergeFlags>();
  CLI::App* command = app.add_subcommand("merge", "join the trained blocks into one scene");
  command->add_option("project", flags->project, "project folder with checkpoints")->required()->type_name("FOLDER");
  command->add_flag("--restart", flags->restart, "remove the scene and everything made from it first");
  command->footer(
      "Examples:\n"
      "  skyquilt merge out\n"
      "  skyquilt merge out --restart\n"
      "Writes out/scene.h5. Where a block failed, the scene shows the coarse context field.");
  command->callback([&state, flags] {
    state.run_command = [&state, flags] {
      coordinator::Pipeline pipeline = state.BeginIn(flags->project, {}, flags->restart);
      coordinator::MergeStage(pipeline);
    };
  });
}

}  // namespace skyquilt::app
