#include <CLI/CLI.hpp>

#include "app/commands/command.h"

namespace skyquilt::app {
namespace {

struct BuildingsFlags {
  std::string project;
  std::vector<int> facades;
  bool all_facades = false;
  bool restart = false;
};

// "x,y,z x,y,z length" as three words: the option takes their seven numbers.
std::string ScaleBarText(const std::vector<std::string>& words) {
  return words[0] + "," + words[1] + "," + words[2];
}

}  // namespace

void AddBuildings(CLI::App& app, CommandState& state) {
  const auto flags = std::make_shared<BuildingsFlags>();
  const auto overrides = std::make_shared<std::vector<config::Override>>();
  CLI::App* command = app.add_subcommand("buildings", "find and measure the buildings of a finished surface");
  command->add_option("project", flags->project, "project folder with a surface")->required()->type_name("FOLDER");
  command
      ->add_option_function<std::string>(
          "--footprints",
          [overrides](const std::string& file) {
            overrides->push_back({"buildings.footprints", file.empty() ? file : std::filesystem::absolute(file).lexically_normal().string()});
          },
          "GeoJSON, GeoPackage or Shapefile with known outlines, which are measured instead of found ones [buildings.footprints]")
      ->type_name("FILE");
  command
      ->add_option_function<std::vector<std::string>>(
          "--scale-bar",
          [overrides](const std::vector<std::string>& words) {
            overrides->push_back({"buildings.scale_bar", ScaleBarText(words)});
          },
          "two points x,y,z of the scene and their distance on site in metres: gives a survey without geo-reference its scale [buildings.scale_bar]")
      ->expected(3)
      ->type_name("A B LENGTH");
  command->add_option("--facades", flags->facades, "render the facades of these buildings, by their ids")->delimiter(',')->type_name("ID,...");
  command->add_flag("--all-facades", flags->all_facades, "render the facades of all buildings");
  command->add_flag("--restart", flags->restart, "remove the buildings and the report first");
  command->footer(
      "Examples:\n"
      "  skyquilt buildings out\n"
      "  skyquilt buildings out --footprints cadastre.gpkg --restart\n"
      "  skyquilt buildings out --facades 3,7\n"
      "  skyquilt buildings out --scale-bar 1.2,0.5,0 4.1,0.6,0 2.95 --restart\n"
      "Writes out/buildings: buildings.csv, buildings.city.json (CityJSON 2.0), buildings.gpkg, buildings.glb, buildings.dxf and buildings.json, and "
      "the\n"
      "classes of the points of out/surface/cloud.las. Run 'skyquilt surface' first.");
  command->callback([&state, flags, overrides] {
    state.run_command = [&state, flags, overrides] {
      coordinator::Pipeline pipeline = state.BeginIn(flags->project, *overrides, flags->restart);
      coordinator::BuildingsStage(pipeline);
      if (!flags->facades.empty() || flags->all_facades) {
        coordinator::WriteFacades(pipeline, flags->all_facades ? std::vector<int>() : flags->facades);
      }
    };
  });
}

}  // namespace skyquilt::app
