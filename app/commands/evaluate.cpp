#include <CLI/CLI.hpp>

#include "app/commands/command.h"

namespace skyquilt::app {

void AddEvaluate(CLI::App& app, CommandState& state) {
  struct EvaluateFlags {
    std::string project;
    bool restart = false;
  };
  const auto flags = std::make_shared<EvaluateFlags>();
  const auto overrides = std::make_shared<std::vector<config::Override>>();
  CLI::App* command = app.add_subcommand("evaluate", "score the scene on the held-out photos and write the report");
  command->add_option("project", flags->project, "project folder with a scene")->required()->type_name("FOLDER");
  AddOptionFlag(*command, overrides, "--lpips", "evaluate.lpips_network", "ONNX network for LPIPS; without it LPIPS is not measured");
  AddOptionFlag(*command, overrides, "--max-photos", "evaluate.max_photos", "score at most this many held-out photos, evenly spread");
  AddMemoryFlag(*command, overrides);
  command->add_flag("--restart", flags->restart, "remove the report first");
  command->footer(
      "Examples:\n"
      "  skyquilt evaluate out\n"
      "  skyquilt evaluate out --lpips lpips_alex.onnx\n"
      "Writes out/report/metrics.json and out/report/index.html, a page that needs no internet connection.");
  command->callback([&state, flags, overrides] {
    state.run_command = [&state, flags, overrides] {
      coordinator::Pipeline pipeline = state.BeginIn(flags->project, *overrides, flags->restart);
      pipeline.settings.evaluate.RequireFiles();  // before earlier results are removed
      coordinator::EvaluateStage(pipeline);
    };
  });
}

}  // namespace skyquilt::app
