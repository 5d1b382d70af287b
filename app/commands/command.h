// Shared by all commands: global flags, the ranks, and the way from command line to settings.
// Each command has its own file with a function that adds it to the command line parser.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
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
  std::string front_end;         // --front-end: folder with the page of viewer and tours; empty: those in the program
  bool quiet = false;
  bool verbose = false;
  std::function<void()> run_command;  // runs the command that was given; set while parsing
  std::vector<std::string> rest;      // of 'skyquilt odm': all words behind it
  // The exit status for whoever started the command; empty: as it is.
  std::function<int(int status)> status_for_caller;

  // Settings from, in this order: defaults, `files`, --config, --set, the command's own flags. Later ones win.
  coordinator::Settings Load(const std::vector<std::filesystem::path>& files, const std::vector<config::Override>& flags) const;
  // The given settings, changed by --config, --set and --threads.
  coordinator::Settings LoadOver(coordinator::Settings settings) const;
  // What Load({}, flags) gives if the photos look level (Pipeline::level_settings): with the preset "level" below all else that is given. Not
  // checked, as most photos do not; none when --config names the preset
  // "default" or "level".
  std::optional<coordinator::Settings> LoadForLevelPhotos(const std::vector<config::Override>& flags) const;
  // The pipeline of a project. From here on, log lines are also written to the project's log.txt.
  coordinator::Pipeline Begin(const coordinator::Project& project, coordinator::Settings settings, bool restart) const;
  // The same for an existing project folder, with its stored configuration and the command's flags.
  coordinator::Pipeline BeginIn(const std::string& folder, const std::vector<config::Override>& flags, bool restart) const;
};

using Overrides = std::shared_ptr<std::vector<config::Override>>;

// The range of an option in parentheses, for the help; empty without a range.
std::string AllowedText(const std::string& key);
// Adds a flag whose value sets the option `key` ("section.key"). The option's range and key are added to the help.
void AddOptionFlag(CLI::App& command, const Overrides& overrides, const std::string& flag, const std::string& key, const std::string& help);
// Adds the flag for the simulated place: `take` receives its name. The old flag --preset still works, with a warning.
void AddPlaceFlag(CLI::App& command, const std::string& names, const std::function<void(const std::string&)>& take, const std::string& help);
// --model: a path.
void AddModelFlag(CLI::App& command, std::string& model);
// --gcp: a file, stored as an absolute path; --check-points.
void AddControlFlags(CLI::App& command, const Overrides& overrides);
// The input of `prepare` and `run`: a folder of photos or of videos, several folders of photos, or video files.
void AddPhotosArgument(CLI::App& command, std::vector<std::string>& photos);
// --add: the photos are added to those of a finished project (coordinator/stages/addition.h).
void AddAddFlag(CLI::App& command, bool& add);
// Settings of the project, changed by the flags, for --add. Throws base::UsageError for flags that cannot go with it.
coordinator::Settings SettingsToAdd(const CommandState& state, const coordinator::Project& project, const std::vector<config::Override>& flags,
                                    const std::string& model, bool restart);
// The folder of all photos for --add. Throws base::UsageError for what is no folder.
std::filesystem::path FolderWithAdded(const coordinator::Project& project, const std::vector<std::string>& photos);
// --video-limit.
void AddVideoFlags(CLI::App& command, const Overrides& overrides);
// --panoramas, --rig: a file, stored as an absolute path; --nadir-mask.
void AddPanoramaFlags(CLI::App& command, const Overrides& overrides);
// --up, --scale-bar (may be repeated).
void AddStatedFlags(CLI::App& command, const Overrides& overrides);
// --boundary: a file; stored as an absolute path, as later commands may run elsewhere.
void AddBoundaryFlag(CLI::App& command, const Overrides& overrides);
// --segment, --segment-config, --ignore-ground: files, stored as absolute paths.
void AddMaskFlags(CLI::App& command, const Overrides& overrides);
// --memory.
void AddMemoryFlag(CLI::App& command, const Overrides& overrides);
// --within.
void AddWithinFlag(CLI::App& command, const Overrides& overrides);
// --time-budget alone, for partition, which makes no more blocks than can be trained in it.
void AddTimeBudgetFlag(CLI::App& command, const Overrides& overrides);
// --time-budget, --steps, --checkpoint-every, --memory, --seed, --brightness.
void AddTrainingFlags(CLI::App& command, const Overrides& overrides);
// The project's config.toml; empty when it does not exist yet.
std::vector<std::filesystem::path> ProjectConfig(const coordinator::Project& project);

void AddSimulate(CLI::App& app, CommandState& state);
void AddPrepare(CLI::App& app, CommandState& state);
void AddMasks(CLI::App& app, CommandState& state);
void AddPartition(CLI::App& app, CommandState& state);
void AddTrain(CLI::App& app, CommandState& state);
void AddMerge(CLI::App& app, CommandState& state);
void AddRender(CLI::App& app, CommandState& state);
void AddSurface(CLI::App& app, CommandState& state);
void AddBuildings(CLI::App& app, CommandState& state);
void AddTour(CLI::App& app, CommandState& state);
void AddOdm(CLI::App& app, CommandState& state);
void AddEvaluate(CLI::App& app, CommandState& state);
void AddView(CLI::App& app, CommandState& state);
void AddInfo(CLI::App& app, CommandState& state);
void AddRun(CLI::App& app, CommandState& state);
void AddPlan(CLI::App& app, CommandState& state);

}  // namespace skyquilt::app
