// tests/simulate/faults.toml: the faults of simulated surveys, which configuration files do not show.
#include <gtest/gtest.h>

#include "core/base/file.h"
#include "core/config/options.h"
#include "simulate/simulate_options.h"

namespace skyquilt::simulate {
namespace {

TEST(FaultOptions, TheFileShowsAllOfThemAndTurnsNoneOn) {
  const std::string file = base::ReadFile("tests/simulate/faults.toml");
  SimulateOptions options;
  config::Sections sections;
  sections.Add("simulate", options, "");
  const auto defaults = config::Flatten(sections);
  config::ReadTomlText(file, "tests/simulate/faults.toml", sections);
  EXPECT_EQ(config::Flatten(sections), defaults);
  const std::string written = config::WriteToml(sections);
  size_t lines = 0;
  for (const config::Option& option : config::OptionsOf(options)) {
    const std::string line = "\n" + option.key + " = ";
    const bool is_fault = !option.unwritten.empty();
    EXPECT_EQ(file.find(line) != std::string::npos, is_fault) << option.key;
    EXPECT_EQ(written.find(line) != std::string::npos, !is_fault) << option.key;
    lines += is_fault ? 1U : 0U;
  }
  EXPECT_EQ(lines, 19U);
}

}  // namespace
}  // namespace skyquilt::simulate
