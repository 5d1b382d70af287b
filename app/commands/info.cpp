#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/command.h"
#include "app/commands/describe.h"
#include "core/base/errors.h"
#include "core/base/json_text.h"

namespace skyquilt::app {

void AddInfo(CLI::App& app, CommandState& state) {
  struct InfoFlags {
    std::string path;
    bool json = false;
    bool defaults = false;
  };
  const auto flags = std::make_shared<InfoFlags>();
  CLI::App* command = app.add_subcommand("info", "show the content of a file or folder of skyquilt");
  command->add_option("path", flags->path, "project, survey folder, or any file in them: .geojson, .h5, .json, .csv, .toml, .ply, .tif")
      ->type_name("PATH");
  command->add_flag("--json", flags->json, "print JSON");
  command->add_flag("--defaults", flags->defaults,
                    "print a configuration file: every option with its explanation and its value after --config and --set");
  command->footer(
      "Examples:\n"
      "  skyquilt info out\n"
      "  skyquilt info out/scene.h5 --json\n"
      "  skyquilt info out/blocks.geojson\n"
      "  skyquilt info --defaults > my.toml");
  command->callback([&state, flags] {
    state.run_command = [&state, flags] {
      if (flags->defaults) {
        std::cout << state.Load({}, {}).Toml();
        return;
      }
      if (flags->path.empty()) throw base::UsageError("skyquilt info needs a file or folder, or --defaults");
      const nlohmann::ordered_json described = Describe(flags->path);
      if (flags->json) {
        std::cout << base::JsonText(described, 2) << "\n";
      } else {
        std::cout << FormatReadable(described);
      }
    };
  });
}

}  // namespace skyquilt::app
