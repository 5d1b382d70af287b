#include "app/settings/chosen_settings.h"

#include <algorithm>

#include "app/settings/load_settings.h"
#include "app/settings/presets.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"

namespace skyquilt::app {
namespace {

// The options set by a configuration: those of a file, or of a preset. When a file and a preset have this name, the file is used.
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
  const std::vector<std::string> presets = ConfigNames();
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

std::vector<config::Override> OverridesOf(const NamedConfig& named, const Choice& choice) {
  std::vector<config::Override> overrides = named.overrides;
  overrides.insert(overrides.end(), choice.overrides.begin(), choice.overrides.end());
  return overrides;
}

void Apply(const NamedConfig& named, const Choice& choice, coordinator::Settings& settings) {
  for (const std::filesystem::path& file : named.files) config::ReadToml(file, settings.AllSections());
  for (const config::Override& entry : OverridesOf(named, choice)) settings.Set(entry);
}

}  // namespace

coordinator::Settings ChosenSettings(const std::vector<std::filesystem::path>& files, const Choice& choice) {
  const NamedConfig named = FindConfig(choice.config);
  std::vector<std::filesystem::path> all_files = named.starts_anew ? std::vector<std::filesystem::path>() : files;
  all_files.insert(all_files.end(), named.files.begin(), named.files.end());
  return LoadSettings(all_files, OverridesOf(named, choice));
}

coordinator::Settings ChosenOver(coordinator::Settings settings, const Choice& choice) {
  const NamedConfig named = FindConfig(choice.config);
  if (named.starts_anew) settings = {};
  Apply(named, choice, settings);
  settings.Check();
  return settings;
}

std::optional<coordinator::Settings> ChosenForLevelPhotos(const Choice& choice) {
  const NamedConfig named = FindConfig(choice.config);
  if (named.keeps_views) return std::nullopt;
  coordinator::Settings settings;
  for (const config::Override& entry : PresetOverrides(kLevelPreset)) settings.Set(entry);
  // What these say about old options was said by ChosenSettings.
  const base::LogLevel level = base::GetLogLevel();
  base::SetLogLevel(base::LogLevel::kError);
  Apply(named, choice, settings);
  base::SetLogLevel(level);
  return settings;
}

}  // namespace skyquilt::app
