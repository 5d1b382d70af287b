#include "coordinator/project/settings.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "app/settings/chosen_settings.h"
#include "app/settings/load_settings.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::app {
namespace {

TEST(Settings, FlagsWinOverTheFileAndTheFileOverDefaults) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / ("skyquilt_settings_" + std::to_string(getpid()) + ".toml");
  base::WriteFileAtomically(file, "[train]\nlevels = 6\nhidden = 32\n");
  const coordinator::Settings settings = LoadSettings({file}, {config::ParseOverride("train.levels=10"), {"partition.altitudes", "150, 300"}});
  std::filesystem::remove(file);
  EXPECT_EQ(settings.train.levels, 10);
  EXPECT_EQ(settings.train.hidden, 32);
  EXPECT_EQ(settings.train.features, worker::TrainOptions().features);
  EXPECT_EQ(settings.partition.altitudes, (std::vector<double>{150.0, 300.0}));
}

TEST(Settings, TomlOfAnySettingsReadsBackTheSame) {
  coordinator::Settings settings = LoadSettings(
      {}, {{"train.learning_rate", "0.0123"}, {"partition.blocks", "3x2"}, {"run.time_budget_s", "90.5"}, {"evaluate.exif_gain", "false"}});
  const std::filesystem::path file = std::filesystem::temp_directory_path() / ("skyquilt_settings_back_" + std::to_string(getpid()) + ".toml");
  base::WriteFileAtomically(file, settings.Toml());
  coordinator::Settings back = LoadSettings({file}, {});
  std::filesystem::remove(file);
  EXPECT_EQ(back.Flat(), settings.Flat());
}

TEST(Settings, UnknownNamesSuggestTheNearest) {
  EXPECT_NE(UsageErrorOf([] { LoadSettings({}, {{"train.levles", "4"}}); }).find("train.levels"), std::string::npos);
  EXPECT_NE(UsageErrorOf([] { LoadSettings({}, {{"trian.levels", "4"}}); }).find("'train'"), std::string::npos);
  EXPECT_NE(UsageErrorOf([] { LoadSettings({}, {{"levels", "4"}}); }).find(".levels'"), std::string::npos);
  EXPECT_NE(UsageErrorOf([] { config::ParseOverride("train.levels"); }).find("section.key=value"), std::string::npos);
}

TEST(Settings, RemovedOptionsAreStillAccepted) {
  coordinator::Settings defaults;
  EXPECT_EQ(LoadSettings({}, {{"run.context_ranks", "2"}}).Flat(), defaults.Flat());
  const TemporaryFolder folder;
  base::WriteFileAtomically(folder / "old.toml", "[run]\ncontext_ranks = 2\nseed = 1\n");
  EXPECT_EQ(LoadSettings({folder / "old.toml"}, {}).Flat(), defaults.Flat());
}

TEST(Settings, OptionsThatAreConstantsNowAreAcceptedWithTheirValues) {
  coordinator::Settings defaults;
  const TemporaryFolder folder;
  base::WriteFileAtomically(folder / "old.toml",
                            "[partition]\nmargin_fraction = 0.06\nmin_margin_m = 2.0\nz_margin_below_m = 1.5\nz_margin_above_m = 1.5\n"
                            "parameter_budget = 0.0\n[context]\npyramid_until = 1.0\nnetwork_l2 = 1e-06\n[train]\npyramid_until = 1.0\n"
                            "network_l2 = 1e-06\n[products]\npreview_width = 1600\n[surface]\nmax_angle_deg = 85.0\nmax_hole_m2 = 30.0\n"
                            "simplify_voxels = 0.5\nodm_names = false\n[buildings]\nmin_part_m2 = 15.0\nshare_yaw_m = 60.0\n");
  EXPECT_EQ(LoadSettings({folder / "old.toml"}, {}).Flat(), defaults.Flat());
  EXPECT_EQ(defaults.Flat().at("partition.margin_fraction"), "0.06") << "stamps and hashes of earlier versions must stay valid";
  EXPECT_EQ(defaults.Flat().at("context.network_l2"), "1e-06");
  const std::string message = UsageErrorOf([] { LoadSettings({}, {{"surface.simplify_voxels", "0.25"}}); });
  EXPECT_NE(message.find("surface.simplify_voxels is fixed at 0.5 now"), std::string::npos) << message;
}

TEST(Settings, TheContextFollowsTheBlocksWhereItIsNotNamed) {
  const TemporaryFolder folder;
  base::WriteFileAtomically(folder / "my.toml", "[context]\nhidden = 32\n[train]\nlevels = 6\nhidden = 48\nsteps = 500\n");
  const coordinator::Settings settings = LoadSettings({folder / "my.toml"}, {{"train.features", "2"}, {"train.hidden", "56"}});
  EXPECT_EQ(settings.context.levels, 6);
  EXPECT_EQ(settings.context.features, 2);
  EXPECT_EQ(settings.context.hidden, 32);
  EXPECT_EQ(settings.context.steps, 0) << "budgets are each field's own";
  const std::string message = UsageErrorOf([] { LoadSettings({}, {{"train.levels", "7"}, {"train.features", "2"}}); });
  EXPECT_NE(message.find("train.levels"), std::string::npos) << message;
  EXPECT_EQ(message.find("context"), std::string::npos) << message;
  base::WriteFileAtomically(folder / "written.toml", settings.Toml());
  EXPECT_EQ(LoadSettings({folder / "written.toml"}, {}).Flat(), settings.Flat());
}

TEST(Settings, ValuesOfTheWrongTypeOrRangeAreNamed) {
  for (const auto& [key, value] : std::vector<std::pair<std::string, std::string>>{{"train.levels", "many"},
                                                                                   {"train.levels", "4.5"},
                                                                                   {"train.levels", ""},
                                                                                   {"train.learning_rate", "1e-2x"},
                                                                                   {"train.learning_rate", "nan"},
                                                                                   {"evaluate.exif_gain", "maybe"},
                                                                                   {"partition.altitudes", "150,,300"},
                                                                                   {"partition.altitudes", "150,-300"},
                                                                                   {"run.context_share", "1.5"},
                                                                                   {"run.image_width", "-1"},
                                                                                   {"run.seed", "-1"},
                                                                                   {"run.threads", "-2"},
                                                                                   {"brightness.correction", "exfi"},
                                                                                   {"train.steps", "-5"}}) {
    const std::string message = UsageErrorOf([&key = key, &value = value] { LoadSettings({}, {{key, value}}); });
    EXPECT_NE(message.find(key.substr(key.find('.') + 1)), std::string::npos) << key << " = " << value << ": " << message;
  }
}

TEST(Settings, TimeBudgetAndStepsExcludeEachOther) {
  EXPECT_THROW(LoadSettings({}, {{"run.time_budget_s", "60"}, {"train.steps", "100"}}), base::UsageError);
  EXPECT_NO_THROW(LoadSettings({}, {{"run.time_budget_s", "60"}}));
}

TEST(Settings, PresetFilesParseAndTheDefaultOneIsTheDefaults) {
  coordinator::Settings defaults;
  const std::filesystem::path folder = "configs";
  ASSERT_TRUE(std::filesystem::exists(folder / "default.toml"));
  EXPECT_EQ(LoadSettings({folder / "default.toml"}, {}).Flat(), defaults.Flat());
  EXPECT_EQ(base::ReadFile(folder / "default.toml"), defaults.Toml()) << "make it again with: skyquilt info --defaults > configs/default.toml";
  for (const char* name : {"fast.toml", "quality.toml", "level.toml"}) {
    coordinator::Settings preset = LoadSettings({folder / name}, {});
    EXPECT_NE(preset.Flat(), defaults.Flat()) << name;
    EXPECT_EQ(preset.Flat().size(), defaults.Flat().size());
  }
}

TEST(Settings, MethodsAreChosenByTheirNamesAndKeepTheRest) {
  const coordinator::Settings settings =
      ChosenSettings({}, {.config = "tensorf", .overrides = {{"run.time_budget_s", "60"}, {"train.hidden", "32"}}});
  EXPECT_EQ(settings.train.encoding, "planes");
  EXPECT_EQ(settings.train.hidden, 32) << "what the user names wins";
  EXPECT_EQ(settings.run.time_budget_s, 60.0);
  const std::string message = ErrorOf<base::InputError>([] { ChosenSettings({}, {.config = "instant-npg"}); });
  EXPECT_NE(message.find("instant-ngp"), std::string::npos) << message;
}

}  // namespace
}  // namespace skyquilt::app
