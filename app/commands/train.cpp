#include <CLI/CLI.hpp>

#include "app/commands/command.h"

namespace skyquilt::app {

void AddTrain(CLI::App& app, CommandState& state) {
  struct TrainFlags {
    std::string project;
    bool restart = false;
  };
  const auto flags = std::make_shared<TrainFlags>();
  const auto overrides = std::make_shared<std::vector<config::Override>>();
  CLI::App* command = app.add_subcommand("train", "train the coarse context field and then every block");
  command->add_option("project", flags->project, "project folder with blocks")->required()->type_name("FOLDER");
  AddTrainingFlags(*command, overrides);
  command->add_flag("--restart", flags->restart, "remove the checkpoints and everything made from them first");
  command->footer(
      "Examples:\n"
      "  skyquilt train out --time-budget 10min\n"
      "  skyquilt train out --steps 4000\n"
      "  mpirun -n 4 skyquilt train out --time-budget 1h30m\n"
      "Writes out/checkpoints/ and out/train.json. With several ranks, rank 0 hands out blocks and the others train them.\n"
      "Run the same command again to continue after an interruption.\n"
      "Exit status: 0 done, 4 a block failed after all tries (the others are saved), 130 interrupted (resumable).");
  command->callback([&state, flags, overrides] {
    state.run_command = [&state, flags, overrides] {
      coordinator::Pipeline pipeline = state.BeginIn(flags->project, *overrides, flags->restart);
      coordinator::ThrowIfBlocksFailed(coordinator::TrainStage(pipeline), pipeline.project);
    };
  });
}

}  // namespace skyquilt::app
