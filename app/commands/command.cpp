#include "app/commands/command.h"

#include <CLI/CLI.hpp>
#include <cmath>

#include "app/settings/chosen_settings.h"
#include "app/settings/duration.h"
#include "app/settings/memory_size.h"
#include "app/settings/presets.h"
#include "coordinator/stages/addition.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "viewer/tour_parts.h"

namespace skyquilt::app {

namespace {

// --set, the command's flags and --threads after --config.
Choice ChoiceOf(const CommandState& state, const std::vector<config::Override>& flags) {
  Choice choice{.config = state.config};
  for (const std::string& text : state.set) choice.overrides.push_back(config::ParseOverride(text));
  choice.overrides.insert(choice.overrides.end(), flags.begin(), flags.end());
  if (!state.threads.empty()) choice.overrides.push_back({"run.threads", state.threads});
  return choice;
}

}  // namespace

coordinator::Settings CommandState::Load(const std::vector<std::filesystem::path>& files, const std::vector<config::Override>& flags) const {
  return ChosenSettings(files, ChoiceOf(*this, flags));
}

coordinator::Settings CommandState::LoadOver(coordinator::Settings settings) const {
  return ChosenOver(std::move(settings), ChoiceOf(*this, {}));
}

std::optional<coordinator::Settings> CommandState::LoadForLevelPhotos(const std::vector<config::Override>& flags) const {
  return ChosenForLevelPhotos(ChoiceOf(*this, flags));
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
      .add_option("--model", model,
                  "camera model of the photos: COLMAP folder, transforms.json, reconstruction.json (OpenSfM), cameras.xml (Metashape), .opf (Pix4D) "
                  "or poses_bounds.npy (LLFF); "
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

void AddPhotosArgument(CLI::App& command, std::vector<std::string>& photos) {
  command.add_option("photos", photos, "folder with photos or videos, several folders of photos, video files, or a simulated survey")
      ->type_name("FOLDER...|VIDEO...");
}

void AddAddFlag(CLI::App& command, bool& add) {
  command.add_flag("--add", add,
                   "add the photos of these folders to the finished project: its poses stay as they are, and only blocks that added photos show are "
                   "trained again");
}

coordinator::Settings SettingsToAdd(const CommandState& state, const coordinator::Project& project, const std::vector<config::Override>& flags,
                                    const std::string& model, bool restart) {
  if (restart) throw base::UsageError("--add keeps what --restart removes: leave one of them out");
  if (!model.empty()) throw base::UsageError("--add finds the poses of added photos itself: leave --model out");
  coordinator::Settings settings = state.Load(ProjectConfig(project), flags);
  if (std::any_of(flags.begin(), flags.end(), [](const config::Override& flag) { return flag.key == "run.within_s"; })) {
    throw base::UsageError("--within plans whole runs and cannot go with --add, which trains as long as the project's settings say");
  }
  settings.run.within_s = 0.0;
  return settings;
}

std::filesystem::path FolderWithAdded(const coordinator::Project& project, const std::vector<std::string>& photos) {
  std::vector<std::filesystem::path> folders(photos.begin(), photos.end());
  for (const std::filesystem::path& folder : folders) {
    if (!std::filesystem::is_directory(folder)) throw base::InputError(folder, "no such folder", "Give the folders of the photos to add");
  }
  return coordinator::FolderWithAdded(project, folders);
}

void AddVideoFlags(CLI::App& command, const Overrides& overrides) {
  AddOptionFlag(command, overrides, "--video-limit", "prepare.video_limit", "most frames that are taken of all videos together; 0: any number");
}

void AddPanoramaFlags(CLI::App& command, const Overrides& overrides) {
  command.add_flag_callback(
      "--panoramas",
      [overrides] {
        overrides->push_back({"prepare.panoramas", "all"});
      },
      "take every photo that is twice as wide as high for a panorama of all directions, and not only those whose tags say so [prepare.panoramas = "
      "all]");
  command
      .add_option_function<std::string>(
          "--rig",
          [overrides](const std::string& file) {
            const bool is_file = !file.empty() && file != "none";
            overrides->push_back({"prepare.rig", is_file ? std::filesystem::absolute(file).lexically_normal().string() : file});
          },
          "COLMAP's rig_config.json of several cameras that take photos at once; none: every photo by itself [prepare.rig]")
      ->type_name("FILE");
  AddOptionFlag(command, overrides, "--nadir-mask", "prepare.nadir_mask_deg",
                "half the angle in degrees of the cone straight down that is masked in panoramas: tripod, drone or who holds the camera");
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
  AddOptionFlag(command, overrides, "--movers", "robust.movers",
                "do not learn from what moved between photos, found by comparing them: off, on or auto");
  AddOptionFlag(command, overrides, "--brightness", "brightness.correction",
                "correction of exposure differences between photos: none, or any of exif,gain,vignette,shading,luminance");
}

std::vector<std::filesystem::path> ProjectConfig(const coordinator::Project& project) {
  if (!std::filesystem::exists(project.ConfigFile())) return {};
  return {project.ConfigFile()};
}

}  // namespace skyquilt::app
