#include <CLI/CLI.hpp>

#include "app/commands/command.h"

namespace skyquilt::app {

void AddSimulate(CLI::App& app, CommandState& state) {
  struct SimulateFlags {
    std::string out;
    bool restart = false;
  };
  const auto flags = std::make_shared<SimulateFlags>();
  const auto overrides = std::make_shared<std::vector<config::Override>>();
  CLI::App* command = app.add_subcommand("simulate", "make a simulated survey with ground truth: photos, poses, depth, masks, buildings");
  AddPlaceFlag(
      *command, "place,--place",
      [overrides](const std::string& name) {
        overrides->push_back({"simulate.place", name});
      },
      "place to simulate" + AllowedText("simulate.place") + " [simulate.place]");
  command->add_option("-o,--out", flags->out, "folder for the survey; created if it does not exist")->required()->type_name("FOLDER");
  AddOptionFlag(*command, overrides, "--flight", "simulate.flight", "how the photos are taken: from above, or level without GPS");
  AddOptionFlag(*command, overrides, "--seed", "simulate.seed", "seed of the place; another number gives another place of the same kind");
  AddOptionFlag(*command, overrides, "--image-width", "simulate.image_width", "width of the photos in pixels");
  AddOptionFlag(*command, overrides, "--altitudes", "simulate.altitudes",
                "flying height above ground in metres: one, or one per block, separated by commas");
  AddOptionFlag(*command, overrides, "--lights", "simulate.lights",
                "take every photo again under several heights of the sun, or intensities of light");
  command->add_flag_callback(
      "--video",
      [overrides] {
        overrides->push_back({"simulate.video_fps", "5"});
      },
      "also film the flight, with 5 frames per second, into video/flight.mp4, with subtitles as drones write them; other rates: simulate.video_fps");
  command->add_flag_callback(
      "--panoramas",
      [overrides] {
        overrides->push_back({"simulate.panoramas", "12"});
      },
      "also take 12 panoramas of all directions along the flight, into panoramas/, with GPano tags as 360-degree cameras write them; other numbers: "
      "simulate.panoramas");
  command->add_flag("--restart", flags->restart, "remove an earlier survey in the folder first");
  command->footer(
      "Examples:\n"
      "  skyquilt simulate hamlet -o data/hamlet\n"
      "  skyquilt simulate hamlet -o data/film --video --image-width 640\n"
      "  skyquilt simulate hamlet -o data/walk --flight street --panoramas --set simulate.tags=all\n"
      "  skyquilt simulate town -o data/town --seed 7 --altitudes 60,80,60,80\n"
      "  skyquilt simulate hamlet -o data/street --flight street\n"
      "  skyquilt simulate tidalflat -o data/flat --set simulate.exposure_jumps_stops=1.5");
  command->callback([&state, flags, overrides] {
    state.run_command = [&state, flags, overrides] {
      coordinator::Pipeline pipeline{.comm = *state.comm, .project = {}, .settings = state.Load({}, *overrides), .restart = flags->restart};
      coordinator::SimulateStage(pipeline, flags->out);
    };
  });
}

}  // namespace skyquilt::app
