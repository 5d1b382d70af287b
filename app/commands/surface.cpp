#include <CLI/CLI.hpp>

#include "app/commands/command.h"

namespace skyquilt::app {
namespace {

struct SurfaceFlags {
  std::string project;
  bool restart = false;
};

}  // namespace

void AddSurface(CLI::App& app, CommandState& state) {
  const auto flags = std::make_shared<SurfaceFlags>();
  const auto overrides = std::make_shared<std::vector<config::Override>>();
  CLI::App* command = app.add_subcommand("surface", "make a textured mesh, a point cloud, 3D tiles and a terrain model of the scene");
  command->add_option("project", flags->project, "project folder with a scene")->required()->type_name("FOLDER");
  AddBoundaryFlag(*command, overrides);
  AddMemoryFlag(*command, overrides);
  command->add_flag("--restart", flags->restart, "remove the surface and the report first");
  command->footer(
      "Examples:\n"
      "  skyquilt surface out\n"
      "  skyquilt surface out --boundary site.geojson --restart\n"
      "  skyquilt surface out --restart --set surface.texel_gsd=0.5\n"
      "Writes out/surface: mesh.glb, mesh.obj, mesh.ply, cloud.las, cloud.ply, tiles/tileset.json, dtm.tif, height_above_ground.tif, hillshade.tif "
      "and contours.gpkg.\n"
      "surface.json lists them; georeference.json says how to place them.");
  command->callback([&state, flags, overrides] {
    state.run_command = [&state, flags, overrides] {
      coordinator::Pipeline pipeline = state.BeginIn(flags->project, *overrides, flags->restart);
      coordinator::SurfaceStage(pipeline);
    };
  });
}

}  // namespace skyquilt::app
