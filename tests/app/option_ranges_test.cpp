// Every option of the program: a value out of its range is refused before any work, and help and configuration files show the same range.
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

#include "coordinator/project/settings.h"
#include "core/base/file.h"
#include "core/base/pattern.h"
#include "tests/support/call_program.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::app {
namespace {

struct Described {
  std::string key;  // "section.key"
  config::Option option;
};

std::vector<Described> AllOptions(coordinator::Settings& settings) {
  std::vector<Described> all;
  const config::Sections sections = settings.AllSections();
  for (const config::Sections::Entry& entry : sections.entries()) {
    for (const config::Option& option : entry.options) all.push_back({entry.name + "." + option.key, option});
  }
  return all;
}

// A value outside the range, as typed on the command line; empty when the range contains all values that were tried.
std::string ForbiddenValue(const config::Option& option) {
  if (std::holds_alternative<bool*>(option.value) || option.range.Text().empty()) return "";
  if (std::holds_alternative<std::string*>(option.value)) {
    std::string word = *rc::gen::container<std::string>(rc::gen::inRange('a', 'z'));
    return option.range.Contains(word) ? "" : word;
  }
  if (std::holds_alternative<int*>(option.value)) {
    const int value = *rc::gen::oneOf(rc::gen::arbitrary<int>(), rc::gen::inRange(-20, 20), rc::gen::just(std::numeric_limits<int>::max()));
    return option.range.Contains(value) ? "" : std::to_string(value);
  }
  double value = *rc::gen::oneOf(rc::gen::arbitrary<double>(), rc::gen::elementOf(std::vector<double>{-1e-9, -1.0, 1e9, 1e300}));
  return !std::isfinite(value) || option.range.Contains(value) ? "" : config::TomlText(&value);
}

RC_GTEST_PROP(OptionRanges, AValueOutOfRangeIsRefusedBeforeAnyWork, ()) {
  coordinator::Settings settings;
  const std::vector<Described> all = AllOptions(settings);
  const Described& one = *rc::gen::elementOf(all);
  const std::string value = ForbiddenValue(one.option);
  RC_PRE(!value.empty());
  const TemporaryFolder folder;
  const std::filesystem::path out = folder.path() / "project";
  const Called called = CallProgram({"run", "--place", "hamlet", "-o", out.string(), "--set", one.key + "=" + value});
  RC_ASSERT(called.status == 2);
  for (const std::string& part : {one.key, value, one.option.range.Text()}) {
    if (called.err.find(part) == std::string::npos) RC_FAIL("'" + part + "' is not named in: " + called.err);
  }
  RC_ASSERT(!std::filesystem::exists(out));
  // The same in a file, and by a command that works in an existing project.
  const bool is_text = std::holds_alternative<std::string*>(one.option.value);
  const bool is_list = std::holds_alternative<std::vector<double>*>(one.option.value);
  const std::string in_toml = is_text ? "\"" + value + "\"" : is_list ? "[" + value + "]" : value;
  base::WriteFileAtomically(folder.path() / "my.toml", one.key + " = " + in_toml + "\n");
  const Called from_file = CallProgram({"info", "--defaults", "--config", (folder.path() / "my.toml").string()});
  RC_ASSERT(from_file.status == 2);
  RC_ASSERT(from_file.err.find(one.option.range.Text()) != std::string::npos);
  RC_ASSERT(from_file.err.find("my.toml") != std::string::npos);
}

// Every numeric option and every choice has a range; free texts have separate checks.
TEST(OptionRanges, OnlyTextsAndSwitchesHaveNone) {
  coordinator::Settings settings;
  const std::set<std::string> free_texts = {"prepare.holdout",
                                            "prepare.colmap",
                                            "prepare.photos",
                                            "prepare.bands",
                                            "prepare.masks",
                                            "prepare.geo_file",
                                            "prepare.gcp",
                                            "prepare.gcp_marks",
                                            "prepare.gcp_crs",
                                            "prepare.gcp_columns",
                                            "prepare.check_points",
                                            "prepare.up",
                                            "prepare.scale_bars",
                                            "partition.blocks",
                                            "brightness.correction",
                                            "products.exposure",
                                            "products.boundary",
                                            "products.kinds",
                                            "evaluate.lpips_network",
                                            "evaluate.normal_photos",
                                            "buildings.footprints",
                                            "simulate.control_crs",
                                            "masks.segment",
                                            "masks.segment_config",
                                            "masks.ignore_ground",
                                            "prepare.rig",
                                            "brightness.shading_grid",
                                            "merge.look"};
  for (const Described& one : AllOptions(settings)) {
    if (std::holds_alternative<bool*>(one.option.value) || free_texts.contains(one.key)) continue;
    EXPECT_NE(one.option.range.Text(), "") << one.key;
  }
}

TEST(OptionRanges, ContainTheDefaults) {
  coordinator::Settings settings;
  EXPECT_NO_THROW(settings.Check());
}

// An option that no text, preset or bench names has no user: it is a constant.
TEST(OptionRanges, EveryOptionStandsInADocumentAPresetOrABench) {
  std::string texts = base::ReadFile("tests/simulate/faults.toml");
  for (const char* preset : {"fast", "quality", "level"}) texts += base::ReadFile(std::string("configs/") + preset + ".toml");
  for (const char* folder : {"docs", "bench", "app/bench", "app/commands"}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
      const std::string ending = entry.path().extension().string();
      if (ending == ".md" || ending == ".cpp") texts += base::ReadFile(entry.path());
    }
  }
  std::set<std::string> words;
  constexpr const char* kLetters = "abcdefghijklmnopqrstuvwxyz0123456789_";
  for (size_t at = texts.find_first_of(kLetters); at != std::string::npos; at = texts.find_first_of(kLetters, at)) {
    const size_t end = std::min(texts.find_first_not_of(kLetters, at), texts.size());
    words.insert(texts.substr(at, end - at));
    at = end;
  }
  coordinator::Settings settings;
  for (const Described& one : AllOptions(settings)) {
    EXPECT_TRUE(words.contains(one.key.substr(one.key.find('.') + 1))) << one.key;
  }
}

TEST(OptionRanges, AreTheSameInConfigurationFilesAndHelp) {
  coordinator::Settings settings;
  const std::vector<Described> all = AllOptions(settings);
  const std::string defaults = CallProgram({"info", "--defaults"}).out;
  std::string help;
  for (const char* command : {"run", "simulate", "prepare", "partition", "train", "merge", "render", "evaluate"}) {
    help += CallProgram({command, "--help"}).out;
  }
  std::string on_one_line;
  for (const base::PatternMatch& word : base::FindAll(help, "\\S+")) on_one_line += word[0] + " ";
  help = on_one_line;
  // Flags that take durations and memory sizes, in units of their own.
  const std::set<std::string> other_units = {"run.time_budget_s", "run.within_s", "run.memory_gb", "context.checkpoint_every_s",
                                             "train.checkpoint_every_s"};
  size_t in_help = 0;
  for (const Described& one : all) {
    const std::string range = one.option.range.Text();
    const std::string key = one.key.substr(one.key.find('.') + 1);
    if (range.empty() || other_units.contains(one.key) || !one.option.unwritten.empty()) continue;
    const std::string lines = fmt::format("# allowed: {}\n{} = {}\n", range, key, config::TomlText(one.option));
    EXPECT_NE(defaults.find(lines), std::string::npos) << one.key;
    for (size_t at = help.find("[" + one.key + "]"); at != std::string::npos; at = help.find("[" + one.key + "]", at + 1)) {
      const std::string shown = "(" + range + ") ";
      EXPECT_EQ(help.substr(at - std::min(at, shown.size()), shown.size()), shown) << one.key;
      ++in_help;
    }
  }
  EXPECT_GE(in_help, 8U);
}

}  // namespace
}  // namespace skyquilt::app
