#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/commands/command.h"
#include "app/commands/describe.h"
#include "app/settings/load_settings.h"
#include "app/settings/presets.h"
#include "bench/numerics/numerics_bench.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "tests/support/call_program.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::app {
namespace {

const std::vector<std::string> kCommands = {"run", "simulate", "prepare", "masks", "partition", "train", "merge", "render", "evaluate", "info"};

TEST(CommandLine, EveryCommandHasHelpWithExamples) {
  for (const std::string& command : kCommands) {
    const Called result = CallProgram({command, "--help"});
    EXPECT_EQ(result.status, 0) << command;
    EXPECT_NE(result.out.find("Examples"), std::string::npos) << command;
    EXPECT_NE(result.out.find("skyquilt " + command), std::string::npos) << command;
  }
  EXPECT_NE(CallProgram({"--help"}).out.find("Examples"), std::string::npos);
}

TEST(CommandLine, UnknownWordsGetASuggestionAndStatusTwo) {
  Called result = CallProgram({"trian", "out"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("'train'"), std::string::npos) << result.err;
  result = CallProgram({"train", "out", "--stpes", "5"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("'--steps'"), std::string::npos) << result.err;
  result = CallProgram({"train"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(CallProgram({}).status, 2);
  EXPECT_EQ(CallProgram({"run", "-o", "x", "--time-budget", "soon"}).status, 2);
  result = CallProgram({"info", "--defaults", "--set", "train.levles=3"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("train.levels"), std::string::npos) << result.err;
}

TEST(CommandLine, VersionAndDefaults) {
  const Called version = CallProgram({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_EQ(version.out.rfind("skyquilt ", 0), 0U);
  const Called defaults = CallProgram({"info", "--defaults", "--set", "train.levels=3"});
  EXPECT_EQ(defaults.status, 0);
  EXPECT_NE(defaults.out.find("levels = 3"), std::string::npos);
}

TEST(CommandLine, PresetsAreChosenByName) {
  EXPECT_NE(CallProgram({"info", "--defaults", "--config", "quality"}).out.find("image_width = 1500"), std::string::npos);
  EXPECT_EQ(CallProgram({"info", "--defaults", "--config", "default"}).out, CallProgram({"info", "--defaults"}).out);
  EXPECT_EQ(CallProgram({"info", "--defaults", "--config", std::filesystem::temp_directory_path().string()}).status, 3);
  const Called wrong = CallProgram({"info", "--defaults", "--config", "qualty"});
  EXPECT_EQ(wrong.status, 3);
  EXPECT_NE(wrong.err.find("Did you mean 'quality'?"), std::string::npos) << wrong.err;

  // On top of a project's configuration: a preset changes only its own options, "default" resets all options, --set comes last.
  const std::filesystem::path own = std::filesystem::temp_directory_path() / ("skyquilt_presets_" + std::to_string(getpid()) + ".toml");
  base::WriteFileAtomically(own, "[run]\nimage_width = 123\n[train]\nlevels = 5\n");
  CommandState state;
  state.config = "quality";
  EXPECT_EQ(state.Load({own}, {}).run.image_width, 1500);
  EXPECT_EQ(state.Load({own}, {}).train.levels, 5);
  state.config = "default";
  EXPECT_EQ(state.Load({own}, {}).run.image_width, coordinator::Settings().run.image_width);
  EXPECT_EQ(state.Load({own}, {}).train.levels, coordinator::Settings().train.levels);
  state.set = {"train.levels=3"};
  EXPECT_EQ(state.Load({own}, {}).train.levels, 3);
  EXPECT_EQ(state.LoadOver(state.Load({own}, {})).train.levels, 3);
  // The context follows a preset, and --set after it.
  state.config = "fast";
  state.set = {"train.features=2"};
  EXPECT_EQ(state.Load({}, {}).context.levels, 6);
  EXPECT_EQ(state.Load({}, {}).context.features, 2);
  std::filesystem::remove(own);
}

TEST(CommandLine, LevelPhotosGetAPresetBelowAllThatIsGiven) {
  const TemporaryFolder folder;
  CommandState state;
  coordinator::Settings preset;
  for (const config::Override& entry : PresetOverrides("level")) {
    EXPECT_FALSE(entry.key.starts_with("simulate.") || entry.key.starts_with("prepare."))
        << entry.key << " is read before it is known how photos look";
    preset.Set(entry);
  }
  EXPECT_NO_THROW(preset.Check());
  EXPECT_EQ(state.LoadForLevelPhotos({})->Flat(), preset.Flat());
  const auto path = [&state](const std::vector<config::Override>& flags) { return state.LoadForLevelPhotos(flags)->products.video_path; };
  state.config = (folder.path() / "mine.toml").string();
  base::WriteFileAtomically(state.config, "[products]\nvideo_path = \"orbit\"\n");
  EXPECT_EQ(path({}), "orbit") << "the default, but given";
  EXPECT_EQ(state.LoadForLevelPhotos({})->priors.points, preset.priors.points);
  state.set = {"products.video_path=flyover"};
  EXPECT_EQ(path({}), "flyover");
  EXPECT_EQ(path({{"products.video_path", "orbit"}}), "orbit");
  state.set.clear();
  for (const std::string name : {"default", kLevelPreset}) {
    state.config = name;
    EXPECT_FALSE(state.LoadForLevelPhotos({})) << name;
  }
  for (const std::string name : {"fast", "quality"}) {
    state.config = name;
    const std::optional<coordinator::Settings> both = state.LoadForLevelPhotos({});
    ASSERT_TRUE(both) << name;
    const coordinator::FlatOptions flat = both->Flat();
    for (const config::Override& entry : PresetOverrides(name)) EXPECT_EQ(flat.at(entry.key), entry.value) << name;
    EXPECT_EQ(both->priors.points, preset.priors.points) << name;
    EXPECT_EQ(both->priors.free_space, preset.priors.free_space) << name;
    EXPECT_EQ(both->products.video_path, "cameras") << name;
    EXPECT_NO_THROW(both->Check()) << name;
  }
}

TEST(CommandLine, PrepareChoosesThePresetOfLevelPhotosForLaterCommands) {
  const TemporaryFolder folder;
  const std::string facade = folder.path() / "facade";
  const Called simulated = CallProgram({"simulate", "hamlet", "-o", facade, "--set", "simulate.flight=facade", "--set", "simulate.photos=4", "--set",
                                        "simulate.image_width=64", "--set", "simulate.samples_per_pixel=1"});
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  // Prepares a project; returns the settings that commands of later stages begin with.
  const auto prepared = [&](const std::string& name, const std::vector<std::string>& words, bool chosen) {
    std::vector<std::string> all = {"prepare", facade, "-o", folder.path() / name};
    all.insert(all.end(), words.begin(), words.end());
    const Called called = CallProgram(all);
    EXPECT_EQ(called.status, 0) << called.err;
    EXPECT_EQ(called.err.find("photos look level: settings of the preset level are used") != std::string::npos, chosen) << called.err;
    return LoadSettings({folder.path() / name / "config.toml"}, {});
  };
  EXPECT_EQ(prepared("chosen", {}, true).Flat(), CommandState().LoadForLevelPhotos({})->Flat());
  const coordinator::Settings fast = prepared("fast", {"--config", "fast"}, true);
  EXPECT_EQ(fast.train.levels, 6);
  EXPECT_EQ(fast.priors.points, prepared("chosen", {}, false).priors.points);
  EXPECT_EQ(prepared("not", {"--config", "default"}, false).Flat(), coordinator::Settings().Flat());
  const coordinator::Settings own = prepared("own", {"--set", "products.video_seconds=6"}, true);
  EXPECT_EQ(own.products.video_seconds, 6.0);
  EXPECT_EQ(own.products.video_path, "cameras");
  // What later commands wrote stays when there is nothing to prepare.
  base::WriteFileAtomically(folder.path() / "chosen" / "config.toml", "[products]\nvideo_seconds = 3.0\n");
  EXPECT_EQ(prepared("chosen", {}, false).products.video_seconds, 3.0);
}

TEST(CommandLine, MissingThingsAreInputErrors) {
  EXPECT_EQ(CallProgram({"info", "/nonexistent/skyquilt"}).status, 3);
  EXPECT_EQ(CallProgram({"train", "/nonexistent/skyquilt"}).status, 3);
  EXPECT_EQ(CallProgram({"--config", "/nonexistent/skyquilt.toml", "info", "--defaults"}).status, 3);
}

TEST(CommandLine, RunNeedsPhotosOrAPlaceAndNotBoth) {
  EXPECT_EQ(CallProgram({"run", "-o", "x"}).status, 2);
  EXPECT_EQ(CallProgram({"run", "photos", "--place", "hamlet", "-o", "x"}).status, 2);
}

TEST(CommandLine, AFailedNumericCaseIsStatusFive) {
  const auto status_of = [](double worst) {
    bench::NumericGroup group{.id = "space", .title = "Space"};
    group.cases.push_back({.name = "one", .limit = 1.0, .run = [worst] { return bench::CaseResult{.worst = worst}; }});
    return Guarded([&] { bench::ThrowIfFailed(bench::RunNumerics({group}, true)); });
  };
  EXPECT_EQ(status_of(2.0), 5);
  EXPECT_EQ(status_of(0.5), 0);
}

TEST(CommandLine, NumericsRunsTheGroupsAskedFor) {
  const Called run = CallProgram({"--quiet", "bench", "numerics", "--quick", "--only", "rays,compositing", "--json"});
  ASSERT_EQ(run.status, 0) << run.err;
  const nlohmann::json json = base::ParseJson(run.out);
  EXPECT_EQ(json.at("failed"), 0);
  for (const nlohmann::json& row : json.at("rows")) {
    EXPECT_TRUE(row.at("group") == "rays" || row.at("group") == "compositing") << row;
    EXPECT_FALSE(row.at("expected").get<std::string>().empty());
  }
  EXPECT_EQ(json.at("rows").size(), json.at("passed").get<size_t>());
  const Called unknown = CallProgram({"bench", "numerics", "--only", "space,rain"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_NE(unknown.err.find("rain"), std::string::npos);
  EXPECT_NE(unknown.err.find("nonfinite"), std::string::npos);
}

TEST(CommandLine, WithoutItsBenchmarksTheProgramSaysHowToBuildThem) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"bench", "numerics", "--quick"}, {"--set", "run.seed=2", "--quiet", "bench"}, {"bench", "--help"}}) {
    const Called missing = CallProgram(words, nullptr);
    EXPECT_EQ(missing.status, 3);
    EXPECT_NE(missing.err.find("skyquilt-bench"), std::string::npos) << missing.err;
    EXPECT_NE(missing.err.find("--target skyquilt_bench"), std::string::npos);
  }
  EXPECT_EQ(CallProgram({"--help"}, nullptr).status, 0);
}

TEST(Describe, ForeignFilesAreRefusedByName) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / ("skyquilt_describe_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  base::WriteFileAtomically(folder / "a.h5", "not HDF5");
  base::WriteFileAtomically(folder / "a.json", "{");
  base::WriteFileAtomically(folder / "a.xyz", "?");
  for (const char* name : {"a.h5", "a.json", "a.xyz", "absent"}) EXPECT_THROW(Describe(folder / name), base::InputError) << name;
  EXPECT_THROW(Describe(folder), base::InputError);
  base::WriteFileAtomically(folder / "metrics.json", R"({"psnr": 28.5, "lpips": null})");
  EXPECT_EQ(Describe(folder / "metrics.json").at("content").at("psnr"), 28.5);
  std::filesystem::remove_all(folder);
}

TEST(Readable, ShowsValuesTablesAndText) {
  const nlohmann::ordered_json json = {{"what", "blocks"}, {"rows", 2},
                                       {"none", nullptr},  {"list", {1, 2}},
                                       {"text", "a\nb"},   {"table", {{{"name", "r0c0"}, {"cost", 0.5}}, {{"name", "r0c1"}, {"cost", 0.25}}}}};
  const std::string text = FormatReadable(json);
  EXPECT_NE(text.find("rows: 2\n"), std::string::npos) << text;
  EXPECT_NE(text.find("none: -\n"), std::string::npos) << text;
  EXPECT_NE(text.find("list: 1, 2\n"), std::string::npos) << text;
  EXPECT_NE(text.find("name  cost\n"), std::string::npos) << text;
  EXPECT_NE(text.find("r0c1  0.25\n"), std::string::npos) << text;
}

TEST(Readable, ShowsSentencesBelowEachOther) {
  const std::string sentence(81, 's');
  const nlohmann::ordered_json json = {{"problems", {{{"code", "a"}, {"finding", sentence}}, {{"code", "b"}, {"finding", "short"}}}}};
  EXPECT_EQ(FormatReadable(json), "problems:\n  - code: a\n    finding: " + sentence + "\n  - code: b\n    finding: short\n");
}

}  // namespace
}  // namespace skyquilt::app
