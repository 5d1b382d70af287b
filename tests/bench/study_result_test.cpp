#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "app/settings/load_settings.h"
#include "app/settings/presets.h"
#include "bench/study/study.h"
#include "bench/study/study_tables.h"
#include "core/base/errors.h"
#include "core/base/json_text.h"

namespace skyquilt::bench {
namespace {

VariantResult Example() {
  VariantResult r;
  r.name = "guided";
  r.label = "blocks, \"guided\"";
  r.psnr_db = 27.5;
  r.psnr_common_db = 27.25;
  r.kept_nmad_gsd = 1.25;
  r.flip = 0.125;
  r.train_seconds = 61.0;
  r.blocks = 2;
  r.layout = "1x2";
  r.fields = {{.name = "context", .parameters = 10, .samples = 20, .seconds = 1.0},
              {.name = "r0c0", .parameters = 30, .samples = 40, .scene_parameters = 25, .log2_table_size = 17, .seconds = 2.0, .psnr_db = 28.0},
              {.name = "r0c1", .parameters = 30, .samples = 40, .seconds = 2.0}};
  r.curve = {{1.0, 20.0}, {2.0, 22.0}};
  r.render = "runs/guided/report/images/photo_00001_render.jpg";
  r.fields[1].steps = 1234;
  r.scales = {
      {.group = "h060_", .divisor = 4, .averaged = true, .photos = 3, .width = 160, .psnr_db = 31.5, .render_seconds = 0.25, .frame_seconds = 0.08},
      {.divisor = 8}};
  r.scale_pictures = "runs/guided/scales";
  r.classes = {{.name = "roof", .pixels = 1200, .missing_pixels = 7, .depth_bias_m = -0.25, .depth_nmad_m = 0.125, .normal_median_deg = 4.5},
               {.name = "tree"}};
  r.lights = {{.light = "sun_10", .look = kBetweenLook, .photos = 3, .psnr_db = 24.5, .stops = 0.25, .followed = 0.125},
              {.light = "sun_05", .look = kOwnLook}};
  r.light_pictures = "runs/guided/lights";
  r.flat_roof_rms_m = 0.0625;
  r.flat_roof_nmad_m = 0.03125;
  r.views = "runs/guided/views";
  r.buildings.emplace().found = 3;
  r.buildings->truth.emplace().detection = {{.size = "all", .outlines = 1, .missed = 1}};
  r.buildings->truth->roofs = {{.roof = "all", .errors = {}}};
  r.buildings->truth->each = {{.fate = evaluate::buildings::BuildingOutcome::Fate::kMissed, .truth_id = 4, .roof = "hip", .area_m2 = 60.0}};
  return r;
}

TEST(Signed, HasASignUnlessItRoundsToNothing) {
  EXPECT_EQ(Signed(1.204, 2), "+1.20");
  EXPECT_EQ(Signed(-0.351, 2), "-0.35");
  EXPECT_EQ(Signed(-0.0002, 3), "0.000");
  EXPECT_EQ(Signed(0.0, 0), "0");
  EXPECT_EQ(Signed(-0.0006, 3), "-0.001");
}

TEST(OfItsOwn, LeavesOutTheContext) {
  VariantResult r = Example();
  r.fields[1].samples = 40'000'000;
  r.fields[2].samples = 7'000'000;
  r.fields[2].seconds = 11.6;
  EXPECT_EQ(OfItsOwn(r), "2 to 12 s and 7 to 40 M samples");
  r.fields.resize(2);
  EXPECT_EQ(OfItsOwn(r), "2 s and 40 M samples");
  r.fields.resize(1);
  EXPECT_EQ(OfItsOwn(r), "nothing");
}

TEST(ResultJson, ReadsBackUnchanged) {
  const VariantResult r = Example();
  std::string identity;
  const VariantResult back = ParseResult(ResultJson(r, "abc 1"), &identity);
  EXPECT_EQ(identity, "abc 1");
  EXPECT_EQ(back.label, r.label);
  EXPECT_EQ(back.layout, "1x2");
  EXPECT_EQ(back.psnr_db, r.psnr_db);
  EXPECT_EQ(back.psnr_common_db, 27.25);
  EXPECT_TRUE(std::isnan(back.ssim));
  EXPECT_EQ(back.kept_nmad_gsd, 1.25);
  EXPECT_TRUE(std::isnan(back.kept_median_gsd));
  EXPECT_EQ(back.flip, 0.125);
  ASSERT_EQ(back.fields.size(), 3U);
  EXPECT_EQ(back.fields[1].psnr_db, 28.0);
  EXPECT_EQ(back.fields[1].scene_parameters, 25);
  EXPECT_EQ(back.fields[1].log2_table_size, 17);
  EXPECT_TRUE(std::isnan(back.fields[2].psnr_db));
  EXPECT_EQ(back.curve, r.curve);
  EXPECT_EQ(back.render, r.render);
  EXPECT_EQ(back.fields[1].steps, 1234);
  ASSERT_EQ(back.scales.size(), 2U);
  EXPECT_EQ(back.scales[0].group, "h060_");
  EXPECT_EQ(back.scales[0].divisor, 4);
  EXPECT_TRUE(back.scales[0].averaged);
  EXPECT_EQ(back.scales[0].photos, 3);
  EXPECT_EQ(back.scales[0].width, 160);
  EXPECT_EQ(back.scales[0].psnr_db, 31.5);
  EXPECT_EQ(back.scales[0].render_seconds, 0.25);
  EXPECT_EQ(back.scales[0].frame_seconds, 0.08);
  EXPECT_TRUE(std::isnan(back.scales[1].psnr_db));
  EXPECT_EQ(back.scale_pictures, "runs/guided/scales");
  ASSERT_EQ(back.lights.size(), 2U);
  EXPECT_EQ(back.lights[0].light, "sun_10");
  EXPECT_EQ(back.lights[0].look, kBetweenLook);
  EXPECT_EQ(back.lights[0].photos, 3);
  EXPECT_EQ(back.lights[0].psnr_db, 24.5);
  EXPECT_EQ(back.lights[0].stops, 0.25);
  EXPECT_EQ(back.lights[0].followed, 0.125);
  EXPECT_TRUE(std::isnan(back.lights[1].moved_psnr_db));
  EXPECT_EQ(back.light_pictures, "runs/guided/lights");
  ASSERT_EQ(back.classes.size(), 2U);
  EXPECT_EQ(back.classes[0].name, "roof");
  EXPECT_EQ(back.classes[0].pixels, 1200);
  EXPECT_EQ(back.classes[0].missing_pixels, 7);
  EXPECT_EQ(back.classes[0].depth_bias_m, -0.25);
  EXPECT_EQ(back.classes[0].depth_nmad_m, 0.125);
  EXPECT_EQ(back.classes[0].normal_median_deg, 4.5);
  EXPECT_TRUE(std::isnan(back.classes[0].depth_rmse_m));
  EXPECT_TRUE(std::isnan(back.classes[1].depth_nmad_m));
  EXPECT_EQ(back.flat_roof_rms_m, 0.0625);
  EXPECT_EQ(back.flat_roof_nmad_m, 0.03125);
  EXPECT_EQ(back.views, "runs/guided/views");
  ASSERT_TRUE(back.buildings.has_value());
  ASSERT_EQ(back.buildings->truth->each.size(), 1U);
  EXPECT_EQ(back.buildings->truth->each[0].truth_id, 4);
  EXPECT_EQ(ResultJson(back, identity), ResultJson(r, "abc 1"));
}

TEST(ResultJson, OfAnOlderProgramHasFewerScores) {
  nlohmann::json json = base::ParseJson(ResultJson(Example(), "abc"));
  json.erase("scales");
  json.erase("scale_pictures");
  json.erase("psnr_common_db");
  json.erase("kept_median_gsd");
  json.erase("kept_nmad_gsd");
  json.erase("flip");
  json.erase("classes");
  json.erase("flat_roof_rms_m");
  json.erase("flat_roof_nmad_m");
  json.erase("views");
  json.erase("buildings");
  for (nlohmann::json& field : json["fields"]) field.erase("steps");
  std::string identity;
  const VariantResult back = ParseResult(base::JsonText(json), &identity);
  EXPECT_TRUE(back.scales.empty());
  EXPECT_TRUE(std::isnan(back.psnr_common_db));
  EXPECT_TRUE(std::isnan(back.kept_nmad_gsd));
  EXPECT_TRUE(back.classes.empty());
  EXPECT_TRUE(std::isnan(back.flat_roof_rms_m));
  EXPECT_EQ(back.views, "");
  EXPECT_FALSE(back.buildings.has_value());
  EXPECT_EQ(back.fields[1].steps, 0);
  EXPECT_TRUE(std::isnan(back.flip));
  EXPECT_EQ(back.psnr_db, Example().psnr_db);
}

TEST(ResultJson, RefusesADamagedText) {
  std::string identity;
  const std::string text = ResultJson(Example(), "abc");
  EXPECT_THROW(ParseResult(text.substr(0, text.size() / 2), &identity), nlohmann::json::exception);
  EXPECT_THROW(ParseResult("{}", &identity), nlohmann::json::exception);
}

std::vector<VariantResult> ThreeSeeds() {
  std::vector<VariantResult> seeds(3, Example());
  for (size_t i = 0; i < 3; ++i) {
    seeds[i].name = "guided_s" + std::to_string(i + 1);
    seeds[i].psnr_db = 27.0 + static_cast<double>(i * i);
    seeds[i].train_seconds = 60.0 - static_cast<double>(i);
    seeds[i].layout = "1x" + std::to_string(i + 2);
  }
  return seeds;
}

TEST(MedianResult, HasMediansOfNumbersAndTheRestOfTheFirst) {
  const VariantResult median = MedianResult("guided", "blocks", ThreeSeeds());
  EXPECT_EQ(median.name, "guided");
  EXPECT_EQ(median.label, "blocks");
  EXPECT_EQ(median.psnr_db, 28.0) << "not the mean";
  EXPECT_EQ(median.train_seconds, 59.0);
  EXPECT_EQ(median.layout, "1x2");
  EXPECT_TRUE(std::isnan(median.ssim));
  ASSERT_EQ(median.seeds.size(), 3U);
  EXPECT_EQ(median.seeds[2].psnr_db, 31.0);
  const VariantResult one = MedianResult("guided", "blocks", {ThreeSeeds()[1]});
  EXPECT_EQ(one.name, "guided_s2");
  EXPECT_TRUE(one.seeds.empty());
}

TEST(MedianResult, LeavesOutTrainingsThatFailed) {
  std::vector<VariantResult> seeds = ThreeSeeds();
  seeds[0] = {};
  seeds[0].failure = "no memory";
  VariantResult median = MedianResult("guided", "blocks", seeds);
  EXPECT_EQ(median.failure, "");
  EXPECT_EQ(median.label, "blocks (1 of 3 trainings failed)");
  EXPECT_EQ(median.psnr_db, 29.5);
  EXPECT_EQ(median.layout, "1x3");
  for (VariantResult& seed : seeds) seed = seeds[0];
  median = MedianResult("guided", "blocks", seeds);
  EXPECT_EQ(median.failure, "no memory");
  EXPECT_TRUE(std::isnan(median.psnr_db));
}

TEST(StudyJson, HasEverySeed) {
  BenchPage page;
  page.name = "blocks";
  const nlohmann::json json =
      base::ParseJson(StudyJson(page, {MedianResult("guided", "blocks", ThreeSeeds()), MedianResult("single", "one", {Example()})}, ""));
  const nlohmann::json& guided = json.at("results").at(0);
  EXPECT_EQ(guided.at("psnr_db"), 28.0);
  ASSERT_EQ(guided.at("seeds").size(), 3U);
  EXPECT_EQ(guided.at("seeds").at(1).at("name"), "guided_s2");
  EXPECT_EQ(guided.at("seeds").at(1).at("psnr_common_db"), 27.25);
  EXPECT_FALSE(json.at("results").at(1).contains("seeds"));
}

TEST(QualityTable, LeavesOutColumnsWithoutNumbers) {
  VariantResult failed;
  failed.label = "too large";
  failed.failure = "no memory";
  const BenchTable table = QualityTable({Example(), failed});
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size());
  EXPECT_NE(std::find(table.columns.begin(), table.columns.end(), "PSNR"), table.columns.end());
  EXPECT_EQ(std::find(table.columns.begin(), table.columns.end(), "LPIPS"), table.columns.end());
  EXPECT_EQ(table.rows[1][0].shown, "too large (no memory)");
}

BenchPage ExamplePage() {
  BenchPage page;
  page.name = "example";
  page.title = "An example <of> a page";
  page.verdicts = {"It works."};
  page.sections.push_back({.id = "s", .title = "Section", .lead = "", .charts = {}, .tables = {QualityTable({Example()})}, .pictures = {}});
  return page;
}

TEST(BenchPage, IsEscapedAndHasNumbersInFullPrecision) {
  const BenchPage page = ExamplePage();
  const std::string html = BenchHtml(page);
  EXPECT_EQ(html.find("<of>"), std::string::npos);
  EXPECT_EQ(html.find("blocks, \"guided\""), std::string::npos);
  EXPECT_EQ(html.find("http"), std::string::npos) << "the page opens offline";
  const std::string csv = BenchCsv(page.sections[0].tables[0]);
  EXPECT_EQ(csv.substr(0, csv.find('\n')), "variant,PSNR,\"PSNR, common\",FLIP,\"kept points, NMAD\",training");
  EXPECT_NE(csv.find("\"blocks, \"\"guided\"\"\",27.5,27.25,0.125,1.25,61"), std::string::npos) << csv;
  const std::string text = BenchText(page);
  EXPECT_NE(text.find("27.50"), std::string::npos);
  EXPECT_NE(text.find("- It works."), std::string::npos);
}

TEST(Presets, EqualTheirFilesAndAreValid) {
  for (const std::string& name : app::PresetNames()) {
    coordinator::Settings settings;
    for (const config::Override& entry : app::PresetOverrides(name)) settings.Set(entry);
    EXPECT_NO_THROW(settings.Check()) << name;
    coordinator::Settings from_file = app::LoadSettings({std::string(SKYQUILT_SOURCE_DIR) + "/configs/" + name + ".toml"}, {});
    EXPECT_EQ(settings.Flat(), from_file.Flat()) << name;
  }
  EXPECT_TRUE(app::PresetOverrides("default").empty());
  EXPECT_FALSE(app::PresetOverrides("fast").empty() || app::PresetOverrides("level").empty());
  EXPECT_THROW(app::PresetOverrides("fastest"), base::UsageError);
}

TEST(Methods, AreAllFilesOfTheirFolderAndValid) {
  const std::filesystem::path folder = std::filesystem::path(SKYQUILT_SOURCE_DIR) / "configs" / "methods";
  const std::vector<std::string> names = app::MethodNames();
  std::set<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) files.insert(entry.path().stem().string());
  EXPECT_EQ(files, std::set<std::string>(names.begin(), names.end()));
  for (const std::string& name : app::MethodNames()) {
    coordinator::Settings settings;
    for (const config::Override& entry : app::PresetOverrides(name)) settings.Set(entry);
    EXPECT_NO_THROW(settings.Check()) << name;
    coordinator::Settings from_file = app::LoadSettings({folder / (name + ".toml")}, {});
    EXPECT_EQ(settings.Flat(), from_file.Flat()) << name;
  }
}

// So that one method leaves nothing of another behind.
TEST(Methods, NameTheSameOptions) {
  const auto keys = [](const std::string& name) {
    std::set<std::string> named;
    for (const config::Override& entry : app::PresetOverrides(name)) named.insert(entry.key);
    return named;
  };
  for (const std::string& name : app::MethodNames()) EXPECT_EQ(keys(name), keys("skyquilt")) << name;
  EXPECT_TRUE(keys("skyquilt").contains("train.pyramid_start") && keys("skyquilt").contains("priors.planar"));
}

TEST(Methods, OfTheProgramItselfAreItsDefaults) {
  coordinator::Settings settings, defaults;
  for (const config::Override& entry : app::PresetOverrides("nerf")) settings.Set(entry);
  EXPECT_NE(settings.Flat(), defaults.Flat());
  EXPECT_EQ(settings.context.hidden, 256) << "the context follows";
  for (const config::Override& entry : app::PresetOverrides("skyquilt")) settings.Set(entry);
  EXPECT_EQ(settings.Flat(), defaults.Flat());
}

}  // namespace
}  // namespace skyquilt::bench
