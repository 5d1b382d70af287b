// What all commands share: global flags, the ranks, and how a command line becomes settings.
// Each command has one file with a function that adds it to the table.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/project/settings.h"
#include "coordinator/stages/pipeline.h"
#include "core/comm/communicator.h"

namespace CLI {
class App;
}

namespace skyquilt::app {

struct CommandState {
  comm::Communicator* comm = nullptr;
  std::string config;            // --config: a TOML file, or the name of a preset
  std::vector<std::string> set;  // --set
  std::string threads;           // --threads
  std::string command_line;      // as it was typed, for reports
  bool quiet = false;
  bool verbose = false;
  std::function<void()> chosen;  // the body of the command on the command line, set while parsing

  // Defaults, `files`, --config, --set, then the command's own flags.
  coordinator::Settings Load(const std::vector<std::filesystem::path>& files, const std::vector<config::Override>& flags) const;
  // --config and --set on top of these.
  coordinator::Settings LoadOver(coordinator::Settings settings) const;
  // A project for a command: logging into it begins. `restart` as given on the command line.
  coordinator::Pipeline Begin(const coordinator::Project& project, coordinator::Settings settings, bool restart) const;
  // The same for the project in a folder, with its own configuration and the command's flags.
  coordinator::Pipeline BeginIn(const std::string& folder, const std::vector<config::Override>& flags, bool restart) const;
};

using Overrides = std::shared_ptr<std::vector<config::Override>>;

// What an option may be, for the help of a flag: " (1 to 16)"; empty when anything goes.
std::string AllowedText(const std::string& key);
// A flag with a value that sets one option, "section.key".
void AddOverride(CLI::App& command, const Overrides& overrides, const std::string& flag, const std::string& key, const std::string& help);
// The flag of commands that simulate: `take` gets the name of the place. Its name in earlier versions, --preset, is still taken, with a warning.
void AddPlaceFlag(CLI::App& command, const std::string& names, const std::function<void(const std::string&)>& take, const std::string& help);
// --memory.
void AddMemoryFlag(CLI::App& command, const Overrides& overrides);
// --time-budget, --steps, --checkpoint-every, --memory, --seed, --brightness.
void AddTrainingFlags(CLI::App& command, const Overrides& overrides);
// The project's own configuration as the lowest layer; empty when there is none yet.
std::vector<std::filesystem::path> ProjectConfig(const coordinator::Project& project);

void AddSimulate(CLI::App& app, CommandState& state);
void AddPrepare(CLI::App& app, CommandState& state);
void AddPartition(CLI::App& app, CommandState& state);
void AddTrain(CLI::App& app, CommandState& state);
void AddMerge(CLI::App& app, CommandState& state);
void AddRender(CLI::App& app, CommandState& state);
void AddEvaluate(CLI::App& app, CommandState& state);
void AddInfo(CLI::App& app, CommandState& state);
void AddBench(CLI::App& app, CommandState& state);
// Those that train.
void AddStudyBenches(CLI::App& bench, CommandState& state);
void AddRun(CLI::App& app, CommandState& state);

}  // namespace skyquilt::app
