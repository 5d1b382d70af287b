#include "viewer/view.h"

#include <CLI/CLI.hpp>

#include "app/commands/command.h"

namespace skyquilt::app {
namespace {

struct ViewFlags {
  std::string project;
  std::string compare;
  std::string listen;
  std::string front_end;
  int port = 0;
  bool edit = false;
};

void RunView(const CommandState& state, const ViewFlags& flags, const std::vector<config::Override>& overrides) {
  viewer::ViewOptions options;
  // Looking needs no right to write, and goes on when the disk is full.
  options.project = coordinator::Project::OpenToRead(flags.project);
  if (!flags.compare.empty()) options.before = coordinator::Project::OpenToRead(flags.compare);
  const coordinator::Settings settings = state.Load(ProjectConfig(options.project), overrides);
  options.listen = flags.listen;
  options.port = flags.port;
  options.edit = flags.edit;
  options.front_end = flags.front_end;
  options.exposure = settings.products.exposure;
  options.plain_surround = settings.products.plain_surround;
  options.run = settings.run;
  options.verbose = state.verbose;
  options.quiet = state.quiet;
  viewer::View(*state.comm, options);
}

}  // namespace

void AddView(CLI::App& app, CommandState& state) {
  const auto flags = std::make_shared<ViewFlags>();
  const auto overrides = std::make_shared<std::vector<config::Override>>();
  CLI::App* command = app.add_subcommand("view", "open a project in the browser: fly through it, measure, compare with the photos");
  command->add_option("project", flags->project, "project folder, finished or not")->required()->type_name("FOLDER");
  command->add_option("--compare", flags->compare, "project folder of an earlier survey of the same place, for before and after")
      ->type_name("FOLDER");
  command->add_flag("--edit", flags->edit, "the tour may be changed: prints a link for that, and one for looking and playing only");
  command->add_option("--port", flags->port, "port; 0: a free one")->type_name("N")->check(CLI::Range(0, 65535));
  command->add_option("--listen", flags->listen, "address to listen on instead of 127.0.0.1; others can then reach the viewer, without encryption")
      ->type_name("ADDRESS");
  AddOptionFlag(*command, overrides, "--exposure", "products.exposure",
                "exposure of the exact pictures: normal, a number of stops above it, or a photo's name to use its exposure");
  AddMemoryFlag(*command, overrides);
  command->add_option("--front-end", flags->front_end, "for work on the viewer: take its page from this folder instead of the program")
      ->type_name("FOLDER");
  command->footer(
      "Examples:\n"
      "  skyquilt view out\n"
      "  skyquilt view out --edit                       make a tour; saved in out/tour.json\n"
      "  skyquilt view out/november --compare out/june\n"
      "  mpirun -n 4 skyquilt view out                  the other ranks render\n"
      "Prints a link, and opens nothing by itself. On another machine: ssh -t -L 8000:127.0.0.1:8000 host skyquilt view out --port 8000");
  command->callback([&state, flags, overrides] { state.run_command = [&state, flags, overrides] { RunView(state, *flags, *overrides); }; });
}

}  // namespace skyquilt::app
