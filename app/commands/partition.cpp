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
  CLI::App* command = app.add_subcommand("partition", "cut the survey's area into geo-referenced blocks at altitudes");
  command->add_option("project", flags->project, "project folder with a survey")->required()->type_name("FOLDER");
  AddOverride(*command, overrides, "--blocks", "partition.blocks", "rows x columns as 2x2, size:<metres>, or auto");
  AddOverride(*command, overrides, "--altitudes", "partition.altitudes",
              "metres above ground, one per block from the south-west, separated by commas");
  AddOverride(*command, overrides, "--image-width", "run.image_width", "width in pixels that photos are trained at; 0: full size");
  command->add_flag("--restart", flags->restart, "remove the blocks and everything made from them first");
  command->footer(
      "Examples:\n"
      "  skyquilt partition out\n"
      "  skyquilt partition out --blocks 2x2\n"
      "  skyquilt partition out --blocks 2x2 --altitudes 150,150,300,500\n"
      "Writes out/blocks.geojson, which opens in QGIS.");
  command->callback([&state, flags, overrides] {
    state.chosen = [&state, flags, overrides] {
      coordinator::Pipeline pipeline = state.BeginIn(flags->project, *overrides, flags->restart);
      coordinator::PartitionStage(pipeline);
    };
  });
}

}  // namespace skyquilt::app
