#include "app/commands/command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>

#include "app/settings/duration.h"
#include "app/settings/load_settings.h"
#include "app/settings/memory_size.h"
#include "app/settings/presets.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "viewer/tour_parts.h"

namespace skyquilt::app {

namespace {

// The options set by --config: those of a file, or of a preset. When a file and a preset have this name, the file is used.
struct NamedConfig {
  bool keeps_views = false;  // says itself what holds for photos that look level: "default" and "level"
  bool starts_anew = false;  // "default" replaces all values of the project's own configuration
  std::vector<std::filesystem::path> files;
  std::vector<config::Override> overrides;
};

NamedConfig FindConfig(const std::string& config) {
  if (config.empty()) return {};
  // A folder with the name of a preset (for instance an output folder "fast") is not a configuration.
  if (std::filesystem::exists(config) && !std::filesystem::is_directory(config)) return {.files = {config}, .overrides = {}};
  const std::vector<std::string> presets = PresetNames();
  if (std::find(presets.begin(), presets.end(), config) == presets.end()) {
    const std::string nearest = config::Nearest(config, presets);
    throw base::InputError(config, "no such file, and no preset of that name",
                           nearest.empty() ? "Give a TOML file, or one of " + base::Join(presets) : "Did you mean '" + nearest + "'?");
  }
  return {.keeps_views = config == "default" || config == kLevelPreset,
          .starts_anew = config == "default",
          .files = {},
          .overrides = PresetOverrides(config)};
}

// What comes after files: the preset, --set, `flags` and --threads. Later ones win.
std::vector<config::Override> OverridesOf(const CommandState& state, const NamedConfig& named, const std::vector<config::Override>& flags) {
  std::vector<config::Override> overrides = named.overrides;
  for (const std::string& text : state.set) overrides.push_back(config::ParseOverride(text));
  overrides.insert(overrides.end(), flags.begin(), flags.end());
  if (!state.threads.empty()) overrides.push_back({"run.threads", state.threads});
  return overrides;
}

void Apply(const CommandState& state, const NamedConfig& named, const std::vector<config::Override>& flags, coordinator::Settings& settings) {
  for (const std::filesystem::path& file : named.files) config::ReadToml(file, settings.AllSections());
  for (const config::Override& entry : OverridesOf(state, named, flags)) settings.Set(entry);
}

}  // namespace

coordinator::Settings CommandState::Load(const std::vector<std::filesystem::path>& files, const std::vector<config::Override>& flags) const {
  const NamedConfig named = FindConfig(config);
  std::vector<std::filesystem::path> all_files = named.starts_anew ? std::vector<std::filesystem::path>() : files;
  all_files.insert(all_files.end(), named.files.begin(), named.files.end());
  return LoadSettings(all_files, OverridesOf(*this, named, flags));
}

coordinator::Settings CommandState::LoadOver(coordinator::Settings settings) const {
  const NamedConfig named = FindConfig(config);
  if (named.starts_anew) settings = {};
  Apply(*this, named, {}, settings);
  settings.Check();
  return settings;
}

std::optional<coordinator::Settings> CommandState::LoadForLevelPhotos(const std::vector<config::Override>& flags) const {
  const NamedConfig named = FindConfig(config);
  if (named.keeps_views) return std::nullopt;
  coordinator::Settings settings;
  for (const config::Override& entry : PresetOverrides(kLevelPreset)) settings.Set(entry);
  // What these say about old options was said by Load.
  const base::LogLevel level = base::GetLogLevel();
  base::SetLogLevel(base::LogLevel::kError);
  Apply(*this, named, flags, settings);
  base::SetLogLevel(level);
  return settings;
}

coordinator::Pipeline CommandState::Begin(const coordinator::Project& project, coordinator::Settings settings, bool restart) const {
  base::AddLogFile(project.LogFile());
  return coordinator::Pipeline{
      .comm = *comm,
      .project = project,
      .settings = std::move(settings),
      .restart = restart,
      .quiet = quiet,
      .verbose = verbose,
      .tour_parts = [folder = front_end](const coordinator::Project& of) { return viewer::TourParts(of, folder, "skyquilt " SKYQUILT_VERSION); }};
}

coordinator::Pipeline CommandState::BeginIn(const std::string& folder, const std::vector<config::Override>& flags, bool restart) const {
  const coordinator::Project project = coordinator::Project::Open(folder);
  return Begin(project, Load(ProjectConfig(project), flags), restart);
}

std::string AllowedText(const std::string& key) {
  coordinator::Settings settings;
  const config::Sections sections = settings.AllSections();
  const config::Option* option = sections.Find(key);
  SKYQUILT_CHECK(option != nullptr, "a flag refers to the option '" + key + "', which does not exist");
  const std::string range = option->range.Text();
  return range.empty() ? "" : " (" + range + ")";
}

void AddOptionFlag(CLI::App& command, const Overrides& overrides, const std::string& flag, const std::string& key, const std::string& help) {
  command.add_option_function<std::string>(
      flag,
      [overrides, key](const std::string& value) {
        overrides->push_back({key, value});
      },
      help + AllowedText(key) + " [" + key + "]");
}

void AddPlaceFlag(CLI::App& command, const std::string& names, const std::function<void(const std::string&)>& take, const std::string& help) {
  CLI::Option* place = command.add_option_function<std::string>(names, take, help)->type_name("NAME");
  command
      .add_option_function<std::string>(
          "--preset",
          [take](const std::string& name) {
            base::LogWarning("--preset NAME is now --place NAME; the old form still works. Presets ({}) are given with --config",
                             base::Join(PresetNames()));
            take(name);
          },
          "old name of --place")
      ->group("")  // not in the help
      ->excludes(place);
}

namespace {

// A duration that sets options in seconds.
void AddDurationFlag(CLI::App& command, const Overrides& overrides, const std::string& flag, const std::vector<std::string>& keys,
                     const std::string& help) {
  command.add_option_function<std::string>(
      flag,
      [overrides, keys](const std::string& text) {
        // Whole milliseconds: the text form of the option must read back to the same number.
        const double seconds = std::round(ParseDurationSeconds(text) * 1000.0) / 1000.0;
        for (const std::string& key : keys) overrides->push_back({key, std::to_string(seconds)});
      },
      help + " [" + base::Join(keys) + "]");
}

}  // namespace

void AddModelFlag(CLI::App& command, std::string& model) {
  command
      .add_option(
          "--model", model,
          "camera model of the photos: COLMAP folder, transforms.json, reconstruction.json (OpenSfM), cameras.xml (Metashape) or .opf (Pix4D); "
          "without it COLMAP is run")
      ->type_name("PATH");
}

void AddControlFlags(CLI::App& command, const Overrides& overrides) {
  command
      .add_option_function<std::string>(
          "--gcp",
          [overrides](const std::string& file) {
            overrides->push_back({"prepare.gcp", file.empty() ? file : std::filesystem::absolute(file).lexically_normal().string()});
          },
          "ground control points that give the place, from OpenDroneMap, OpenSfM, Pix4D or Metashape [prepare.gcp]")
      ->type_name("FILE");
  AddOptionFlag(command, overrides, "--check-points", "prepare.check_points",
                "points of the control file that are only compared: labels separated by commas, or a file with a label per line");
}

void AddStatedFlags(CLI::App& command, const Overrides& overrides) {
  AddOptionFlag(command, overrides, "--up", "prepare.up",
                "direction of up, where photos cannot tell it: x,y,z in the frame of the camera model, or cameras for the mean up of the photos");
  command
      .add_option_function<std::vector<std::string>>(
          "--scale-bar",
          [overrides](const std::vector<std::string>& bars) {
            overrides->push_back({"prepare.scale_bars", base::Join(bars, "|")});
          },
          "length measured on site, in metres, between two labels of marks in photos or two points x;y;z of the camera model: gives a survey without "
          "a place on Earth its scale; may be repeated [prepare.scale_bars]")
      ->type_name("A,B,LENGTH")
      ->expected(1)
      ->take_all();
}

void AddBoundaryFlag(CLI::App& command, const Overrides& overrides) {
  command
      .add_option_function<std::string>(
          "--boundary",
          [overrides](const std::string& file) {
            overrides->push_back({"products.boundary", file.empty() ? file : std::filesystem::absolute(file).lexically_normal().string()});
          },
          "GeoJSON or GeoPackage file with polygons that limit all products [products.boundary]")
      ->type_name("FILE");
}

void AddMaskFlags(CLI::App& command, const Overrides& overrides) {
  const auto add = [&](const std::string& flag, const std::string& key, const std::string& help) {
    command
        .add_option_function<std::string>(
            flag,
            [overrides, key](const std::string& file) {
              overrides->push_back({key, file.empty() ? file : std::filesystem::absolute(file).lexically_normal().string()});
            },
            help + " [" + key + "]")
        ->type_name("FILE");
  };
  add("--segment", "masks.segment", "ONNX network that finds what moves in each photo, which is then ignored");
  add("--segment-config", "masks.segment_config", "TOML or JSON file that says what the network takes and gives, and which classes are ignored");
  add("--ignore-ground", "masks.ignore_ground", "GeoJSON or GeoPackage file with polygons around ground to ignore");
}

void AddMemoryFlag(CLI::App& command, const Overrides& overrides) {
  command.add_option_function<std::string>(
      "--memory",
      [overrides](const std::string& text) {
        overrides->push_back({"run.memory_gb", FormatGib(ParseBytes(text))});
      },
      "memory limit per machine, such as 2GiB or 1500MB; default: half of the machine's memory [run.memory_gb]");
}

void AddWithinFlag(CLI::App& command, const Overrides& overrides) {
  AddDurationFlag(command, overrides, "--within", {"run.within_s"},
                  "time for everything, from photos to report, such as 20min or 2h: says first what it plans, and what is given up for it");
}

void AddTimeBudgetFlag(CLI::App& command, const Overrides& overrides) {
  AddDurationFlag(command, overrides, "--time-budget", {"run.time_budget_s"}, "time for the whole training, such as 90s, 10min or 1h30m");
}

void AddTrainingFlags(CLI::App& command, const Overrides& overrides) {
  AddTimeBudgetFlag(command, overrides);
  AddOptionFlag(command, overrides, "--steps", "train.steps", "train every block for this many steps instead of a time budget");
  AddDurationFlag(command, overrides, "--checkpoint-every", {"context.checkpoint_every_s", "train.checkpoint_every_s"},
                  "time between two checkpoints of a field, such as 20s or 5min");
  AddMemoryFlag(command, overrides);
  AddOptionFlag(command, overrides, "--seed", "run.seed", "seed of the random numbers of training");
  AddOptionFlag(command, overrides, "--brightness", "brightness.correction",
                "correction of exposure differences between photos: none, or any of exif,gain,vignette,luminance");
}

std::vector<std::filesystem::path> ProjectConfig(const coordinator::Project& project) {
  if (!std::filesystem::exists(project.ConfigFile())) return {};
  return {project.ConfigFile()};
}

}  // namespace skyquilt::app
