#include "app/settings/load_settings.h"

namespace skyquilt::app {

coordinator::Settings LoadSettings(const std::vector<std::filesystem::path>& files, const std::vector<config::Override>& overrides) {
  coordinator::Settings settings;
  const config::Sections sections = settings.AllSections();
  for (const std::filesystem::path& file : files) config::ReadToml(file, sections);
  for (const config::Override& entry : overrides) config::ApplyOverride(entry, sections);
  settings.Check();
  return settings;
}

}  // namespace skyquilt::app
