#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "app/commands/command.h"
#include "app/settings/memory_size.h"

namespace skyquilt::app {
namespace {

struct TourFlags {
  std::string project;
  std::string out;
  int auto_stops = 0;
  bool video = false;
};

}  // namespace

void AddTour(CLI::App& app, CommandState& state) {
  const auto flags = std::make_shared<TourFlags>();
  const auto overrides = std::make_shared<std::vector<config::Override>>();
  CLI::App* command = app.add_subcommand("tour", "export the tour of a project as a folder that plays in any browser");
  command->add_option("project", flags->project, "project folder with a scene")->required()->type_name("FOLDER");
  command
      ->add_option("-o,--out", flags->out, "folder for the tour: new, or an earlier export, which is replaced; default: tour/ in the project folder")
      ->type_name("FOLDER");
  command
      ->add_option_function<std::string>(
          "--size",
          [overrides](const std::string& text) {
            overrides->push_back({"tour.size_mb", fmt::format("{:.9g}", ParseBytes(text) / 1e6)});
          },
          "largest size of the folder, such as 200MB [tour.size_mb]")
      ->type_name("SIZE");
  command
      ->add_option("--auto", flags->auto_stops,
                   "propose a tour with so many stops and save it as the project's tour; never replaces one that a person made or edited")
      ->type_name("N")
      ->check(CLI::Range(1, 50));
  command->add_flag("--video", flags->video, "also make a video of the tour, tour.mp4");
  AddOptionFlag(*command, overrides, "--exposure", "products.exposure",
                "exposure of stops that have none of their own: normal, a number of stops above it, or a photo's name to use its exposure");
  AddMemoryFlag(*command, overrides);
  command->add_option("--front-end", state.front_end, "for work on the page: take it from this folder instead of the program")->type_name("FOLDER");
  command->footer(
      "Examples:\n"
      "  skyquilt tour out -o farm                      the tour made with 'skyquilt view out --edit'\n"
      "  skyquilt tour out --auto 5 -o farm --size 100MB\n"
      "  skyquilt tour out -o farm --video\n"
      "Open farm/index.html, or put the folder on a web server. Nothing else is needed. Run the same command again after an interruption: finished\n"
      "pictures are kept in tour/work of the project.");
  command->callback([&state, flags, overrides] {
    state.run_command = [&state, flags, overrides] {
      coordinator::Pipeline pipeline = state.BeginIn(flags->project, *overrides, false);
      coordinator::ExportProjectTour(
          pipeline, {.out = flags->out.empty() ? pipeline.project.TourFolder() : std::filesystem::absolute(flags->out).lexically_normal(),
                     .auto_stops = flags->auto_stops,
                     .video = flags->video});
    };
  });
}

}  // namespace skyquilt::app
