// The configuration file.
#include "coordinator/project/settings.h"
#include "core/base/errors.h"
#include "core/config/options.h"
#include "tests/fuzz/fuzz_target.h"

namespace skyquilt::fuzz {

std::vector<std::string> Seeds() {
  coordinator::Settings settings;
  return {settings.Toml(), "[train]\nsteps = 100\nlearning_rate = 1e-2\n", "[partition]\naltitudes = [150, 300.5]\n", "[|ate = 1e-2\n"};
}

void Feed(const std::string& bytes) {
  try {
    coordinator::Settings settings;
    config::Sections sections = settings.AllSections();
    config::ReadTomlText(bytes, "fuzz.toml", sections);
    settings.Toml();
  } catch (const base::InputError&) {
  } catch (const base::UsageError&) {
  }
}

}  // namespace skyquilt::fuzz
