#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/describe.h"
#include "core/base/errors.h"
#include "core/base/json_text.h"

namespace skyquilt::app {

void AddInfo(CLI::App& app, CommandState& state) {
  struct InfoFlags {
    std::vector<std::string> paths;
    bool json = false;
    bool defaults = false;
  };
  const auto flags = std::make_shared<InfoFlags>();
  CLI::App* command = app.add_subcommand("info", "show the content of files or folders of skyquilt");
  command->add_option("paths", flags->paths, "projects, survey folders, or any files in them: .geojson, .h5, .json, .csv, .toml, .ply, .tif")
      ->type_name("PATH");
  command->add_flag("--json", flags->json, "print JSON: of one path its content, of several an object with the content of each");
  command->add_flag("--defaults", flags->defaults,
                    "print a configuration file: every option with its explanation and its value after --config and --set");
  command->footer(
      "Examples:\n"
      "  skyquilt info out\n"
      "  skyquilt info out/scene.h5 --json\n"
      "  skyquilt info out/blocks.geojson\n"
      "  skyquilt info out/checkpoints/*.h5\n"
      "  skyquilt info --defaults > my.toml");
  command->callback([&state, flags] {
    state.run_command = [&state, flags] {
      if (flags->defaults) {
        std::cout << state.Load({}, {}).Toml();
        return;
      }
      if (flags->paths.empty()) throw base::UsageError("skyquilt info needs a file or folder, or --defaults");
      nlohmann::ordered_json all;
      for (const std::string& path : flags->paths) {
        const nlohmann::ordered_json described = Describe(path);
        if (flags->json) {
          all[path] = described;
        } else {
          if (flags->paths.size() > 1) std::cout << "== " << path << "\n";
          std::cout << FormatReadable(described);
        }
      }
      if (flags->json) std::cout << base::JsonText(flags->paths.size() == 1 ? all[flags->paths.front()] : all, 2) << "\n";
    };
  });
}

}  // namespace skyquilt::app
