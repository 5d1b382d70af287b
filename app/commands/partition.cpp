#include <CLI/CLI.hpp>

#include "app/commands/command.h"

namespace skyquilt::app {

void AddPartition(CLI::App& app, CommandState& state) {
  struct PartitionFlags {
    std::string project;
    bool restart = false;
  };
  const auto flags = std::make_shared<PartitionFlags>();
  const auto overrides = std::make_shared<std::vector<config::Override>>();
  CLI::App* command = app.add_subcommand("partition", "divide the survey area into geo-referenced blocks");
  command->add_option("project", flags->project, "project folder with a survey")->required()->type_name("FOLDER");
  AddOptionFlag(*command, overrides, "--blocks", "partition.blocks", "rows x columns such as 2x2, size:<metres> per block, or auto");
  AddOptionFlag(*command, overrides, "--altitudes", "partition.altitudes",
                "altitude above ground in metres of each block, row by row from the south-west, separated by commas");
  AddOptionFlag(*command, overrides, "--image-width", "run.image_width",
                "scale photos down to this width in pixels for training and scoring; 0: full size; auto: by the time");
  AddTimeBudgetFlag(*command, overrides);
  command->add_flag("--restart", flags->restart, "remove the blocks and everything made from them first");
  command->footer(
      "Examples:\n"
      "  skyquilt partition out\n"
      "  skyquilt partition out --time-budget 10min\n"
      "  skyquilt partition out --blocks 2x2\n"
      "  skyquilt partition out --blocks 2x2 --altitudes 150,150,300,500\n"
      "Writes out/blocks.geojson, which opens in QGIS.");
  command->callback([&state, flags, overrides] {
    state.run_command = [&state, flags, overrides] {
      coordinator::Pipeline pipeline = state.BeginIn(flags->project, *overrides, flags->restart);
      coordinator::PartitionStage(pipeline);
    };
  });
}

}  // namespace skyquilt::app
