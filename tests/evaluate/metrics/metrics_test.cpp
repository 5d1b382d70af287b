#include "evaluate/metrics/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::evaluate::metrics {
namespace {

using MetricsJsonTest = InTemporaryFolder;

TEST(MeanOfMeasured, LeavesOutWhatWasNotMeasured) {
  EXPECT_DOUBLE_EQ(MeanOfMeasured({20.0, kNotMeasured, 30.0}), 25.0);
  EXPECT_TRUE(std::isnan(MeanOfMeasured({})));
  EXPECT_TRUE(std::isnan(MeanOfMeasured({kNotMeasured})));
}

TEST(MedianOfMeasured, IsTheMiddle) {
  EXPECT_DOUBLE_EQ(MedianOfMeasured({3.0, 1.0, kNotMeasured, 2.0}), 2.0);
  EXPECT_DOUBLE_EQ(MedianOfMeasured({4.0, 1.0, 3.0, 2.0}), 2.5);
  EXPECT_TRUE(std::isnan(MedianOfMeasured({})));
}

TEST_F(MetricsJsonTest, HasEveryPromisedKeyEvenWhenNothingWasMeasured) {
  const auto json = base::ParseJson(MetricsJson(Metrics{}));
  for (const char* key : {"psnr", "ssim", "flip", "coverage", "psnr_full_frame", "ssim_full_frame", "flip_full_frame", "lpips", "seam_psnr_gap_db",
                          "train_seconds", "samples_per_second", "peak_rss_bytes"}) {
    ASSERT_TRUE(json.contains(key)) << key;
    EXPECT_TRUE(json[key].is_null()) << key;
  }
  for (const char* key : {"psnr_per_image", "psnr_per_block", "parameters", "ranks", "config", "machine", "date", "geo", "median_agl_m"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_TRUE(json["psnr_per_image"].is_object());
  EXPECT_FALSE(json.contains("depth_rmse_m"));
  EXPECT_FALSE(json.contains("floater_opacity"));
  ASSERT_TRUE(json.contains("kept_points"));
  EXPECT_TRUE(json["kept_points"].is_null());
  EXPECT_FALSE(json.contains("classes"));
}

// Whole frames, each with its variant, so that they can be set beside published figures.
TEST_F(MetricsJsonTest, NamesTheVariantsOfWhatIsCompared) {
  Metrics metrics;
  metrics.psnr = 20.0;
  metrics.psnr_full_frame = 25.0;
  metrics.ssim = 0.5;
  metrics.ssim_full_frame = 0.75;
  metrics.lpips_note = "not measured";
  photos::PhotoScore photo;
  photo.width = 20;
  photo.height = 10;
  photo.used_pixels = 150;
  metrics.photos = {photo};
  const auto json = base::ParseJson(MetricsJson(metrics))["as_published"];
  EXPECT_EQ(json["psnr"], 25.0);
  EXPECT_EQ(json["ssim"], 0.75);
  EXPECT_TRUE(json["lpips"].is_null());
  EXPECT_EQ(json["lpips_variant"], "not measured");
  EXPECT_NE(json["ssim_variant"].get<std::string>().find("window 11 x 11, sigma 1.5"), std::string::npos);
  EXPECT_NE(json["psnr_variant"].get<std::string>().find("mean over the photos"), std::string::npos);
  EXPECT_EQ(json["photos"], 1);
  EXPECT_EQ(json["width"], 20);
  EXPECT_EQ(json["height"], 10);
  EXPECT_EQ(json["unmasked_share"], 0.75);
  EXPECT_TRUE(base::ParseJson(MetricsJson(Metrics{}))["as_published"]["unmasked_share"].is_null());
}

TEST_F(MetricsJsonTest, WritesValuesAndTurnsNanAndInfinityIntoNull) {
  Metrics metrics;
  metrics.psnr = 27.5;
  metrics.has_truth = true;
  metrics.depth_rmse_m = 0.75;
  metrics.floater_opacity = 0.02;
  metrics.floater_profile = {{1.0, 0.03}, {10.0, kNotMeasured}};
  photos::PhotoScore good, blank, equal;
  good.name = "a/one.jpg";
  good.psnr_db = 27.5;
  good.used_pixels = 10;
  good.covered_pixels = 5;
  blank.name = "two.jpg";
  equal.name = "three.jpg";
  equal.psnr_db = std::numeric_limits<double>::infinity();
  metrics.photos = {good, blank, equal};
  metrics.blocks = {{"r0c0", 28.0, 100}, {"r0c1", kNotMeasured, 0}};
  const auto json = base::ParseJson(MetricsJson(metrics));
  EXPECT_DOUBLE_EQ(json["psnr"].get<double>(), 27.5);
  EXPECT_DOUBLE_EQ(json["depth_rmse_m"].get<double>(), 0.75);
  EXPECT_TRUE(json["depth_median_abs_m"].is_null());
  EXPECT_DOUBLE_EQ(json["floater_opacity"].get<double>(), 0.02);
  EXPECT_DOUBLE_EQ(json["floater_profile"][0]["opacity"].get<double>(), 0.03);
  EXPECT_DOUBLE_EQ(json["floater_profile"][1]["clearance_m"].get<double>(), 10.0);
  EXPECT_TRUE(json["floater_profile"][1]["opacity"].is_null());
  EXPECT_DOUBLE_EQ(json["psnr_per_image"]["a/one.jpg"].get<double>(), 27.5);
  EXPECT_TRUE(json["psnr_per_image"]["two.jpg"].is_null());
  EXPECT_TRUE(json["psnr_per_image"]["three.jpg"].is_null());
  EXPECT_TRUE(json["psnr_per_block"]["r0c1"].is_null());
  EXPECT_DOUBLE_EQ(json["images"][0]["coverage"].get<double>(), 0.5);
  EXPECT_TRUE(json["images"][1]["coverage"].is_null());
}

TEST_F(MetricsJsonTest, IsReadBackAsItWasWritten) {
  Metrics metrics;
  metrics.psnr = 27.515625;
  metrics.seam_psnr_gap_db = -0.125;
  metrics.has_truth = true;
  metrics.depth_median_abs_m = 0.1;
  metrics.floater_opacity = 0.02;
  metrics.floater_profile = {{1.0, 0.03}, {10.0, kNotMeasured}};
  metrics.blocks = {{"r0c0", 28.0, 100}, {"r0c1", kNotMeasured, 0}};
  metrics.kept_points = {.points = 5, .rays = 18, .median_gsd = -0.25, .median_abs_gsd = 1.5, .nmad_gsd = 1.75, .share_beyond_10_gsd = 0.125};
  metrics.train_seconds = 12.5;
  metrics.peak_rss_bytes = 123456789012;
  metrics.parameters = 7;
  metrics.n_test = 3;
  metrics.resected_holdout = true;
  metrics.warnings = {{"one", "do this"}, {"two", "do that"}};
  base::WriteFileAtomically(folder_.path() / "metrics.json", MetricsJson(metrics));
  const Metrics back = ReadMetrics(folder_.path() / "metrics.json");
  EXPECT_EQ(back.psnr, metrics.psnr);
  EXPECT_TRUE(std::isnan(back.ssim));
  EXPECT_EQ(back.seam_psnr_gap_db, metrics.seam_psnr_gap_db);
  EXPECT_TRUE(back.has_truth);
  EXPECT_EQ(back.depth_median_abs_m, metrics.depth_median_abs_m);
  EXPECT_EQ(back.floater_opacity, metrics.floater_opacity);
  ASSERT_EQ(back.floater_profile.size(), 2U);
  EXPECT_EQ(back.floater_profile[0], metrics.floater_profile[0]);
  EXPECT_TRUE(std::isnan(back.floater_profile[1].second));
  ASSERT_EQ(back.blocks.size(), 2U);
  EXPECT_EQ(back.blocks[0].name, "r0c0");
  EXPECT_EQ(back.blocks[0].pixels, 100);
  EXPECT_TRUE(std::isnan(back.blocks[1].psnr_db));
  EXPECT_EQ(back.kept_points.points, 5);
  EXPECT_EQ(back.kept_points.rays, 18);
  EXPECT_EQ(back.kept_points.median_gsd, -0.25);
  EXPECT_EQ(back.kept_points.nmad_gsd, 1.75);
  EXPECT_EQ(back.kept_points.share_beyond_10_gsd, 0.125);
  EXPECT_TRUE(std::isnan(back.kept_points.nmad_m));
  EXPECT_EQ(back.train_seconds, metrics.train_seconds);
  EXPECT_EQ(back.peak_rss_bytes, metrics.peak_rss_bytes);
  EXPECT_EQ(back.n_test, 3);
  EXPECT_TRUE(back.resected_holdout);
  EXPECT_EQ(back.warnings, metrics.warnings);
  base::WriteFileAtomically(folder_.path() / "metrics.json", "{\"psnr\": 1, \"rank");
  EXPECT_THROW(ReadMetrics(folder_.path() / "metrics.json"), base::InputError);
  base::WriteFileAtomically(folder_.path() / "metrics.json", "{\"n_test\": 1, \"photos_held_out\": \"many\"}");
  EXPECT_THROW(ReadMetrics(folder_.path() / "metrics.json"), base::InputError);
}

TEST_F(MetricsJsonTest, ScoresByClassAreReadBackToo) {
  Metrics metrics;
  metrics.has_truth = true;
  EXPECT_FALSE(base::ParseJson(MetricsJson(metrics)).contains("classes"));
  EXPECT_FALSE(base::ParseJson(MetricsJson(metrics)).contains("flat_roof_rms_m"));
  ClassScore roof{.name = "roof", .pixels = 12, .missing_pixels = 3, .depth_bias_m = -0.125, .depth_median_abs_m = 0.25, .depth_nmad_m = 0.5};
  roof.depth_rmse_m = 0.75;
  roof.normal_median_deg = 7.5;
  roof.normal_mean_deg = 12.0;
  roof.head_normal_median_deg = 6.5;
  metrics.classes = {roof, {.name = "tree"}};
  metrics.flat_roofs = 4;
  metrics.flat_roof_rms_m = 0.0625;
  metrics.flat_roof_nmad_m = 0.03125;
  const std::string text = MetricsJson(metrics);
  const auto json = base::ParseJson(text);
  EXPECT_EQ(json["classes"]["roof"]["depth_bias_m"], -0.125);
  EXPECT_EQ(json["classes"]["roof"]["normal_mean_deg"], 12.0);
  EXPECT_EQ(json["classes"]["roof"]["head_normal_median_deg"], 6.5);
  EXPECT_TRUE(json["classes"]["roof"]["density_normal_median_deg"].is_null());
  EXPECT_EQ(json["classes"]["tree"]["pixels"], 0);
  EXPECT_TRUE(json["classes"]["tree"]["depth_nmad_m"].is_null());
  base::WriteFileAtomically(folder_.path() / "metrics.json", text);
  const Metrics back = ReadMetrics(folder_.path() / "metrics.json");
  ASSERT_EQ(back.classes.size(), 2U);
  EXPECT_EQ(back.classes[0].missing_pixels, 3);
  EXPECT_EQ(back.flat_roofs, 4);
  EXPECT_EQ(MetricsJson(back), text);
}

TEST_F(MetricsJsonTest, TheOrthophotoIsReadBackToo) {
  Metrics metrics;
  EXPECT_FALSE(base::ParseJson(MetricsJson(metrics)).contains("orthophoto"));
  ortho::OrthoScores& scores = metrics.ortho.emplace();
  scores.cell_m = 0.05;
  scores.cells = 30000000;
  scores.psnr_db = 24.5;
  scores.seam_levels = 1.25;
  const std::filesystem::path file = folder_ / "metrics.json";
  base::WriteFileAtomically(file, MetricsJson(metrics));
  const Metrics read = ReadMetrics(file);
  ASSERT_TRUE(read.ortho);
  EXPECT_EQ(read.ortho->cells, 30000000);
  EXPECT_EQ(read.ortho->cell_m, 0.05);
  EXPECT_EQ(read.ortho->psnr_db, 24.5);
  EXPECT_EQ(read.ortho->seam_levels, 1.25);
  EXPECT_EQ(read.ortho->photos_in_use, -1);
  EXPECT_TRUE(std::isnan(read.ortho->moving_car_share));
}

TEST_F(MetricsJsonTest, TheGeoReferenceIsReadBackToo) {
  Metrics metrics;
  metrics.georeferenced = true;
  survey::GeoFit& fit = metrics.geo_fit;
  fit = {.n_matches = 9, .n_inliers = 8, .rmse_m = 2.5, .rmse_horizontal_m = 2.0, .rmse_vertical_m = 1.5, .scale = 37.5, .tag_lag_s = 0.25};
  fit.tag_lag_sigma_s = 0.0625;
  fit.flight_vertical_offset_m = {0.0, 1.5};
  fit.flight_vertical_drift_m = {-3.0, 4.0};
  fit.accuracy = {.scale_percent = 0.25, .tilt_deg = 0.5, .yaw_deg = 0.75, .horizontal_m = 1.25, .vertical_m = kNotMeasured};
  fit.gravity = {{.kind = "ground", .n = 5, .lean_east_deg = -0.5, .lean_north_deg = 0.125, .sigma_deg = kNotMeasured, .weight = 0.0}};
  fit.tags_alone_tilt_deg = 19.0;
  metrics.problem_codes = {"no_gimbal", "lag"};
  const std::string text = MetricsJson(metrics);
  const auto geo = base::ParseJson(text).at("geo");
  EXPECT_EQ(geo.at("photos_with_gps"), 9);
  EXPECT_EQ(geo.at("scale_m_per_model_unit"), 37.5);
  EXPECT_EQ(geo.at("tag_lag_s"), 0.25);
  EXPECT_EQ(geo.at("tag_lag_sigma_s"), 0.0625);
  EXPECT_EQ(geo.at("flight_vertical_drift_m").at(1), 4.0);
  EXPECT_EQ(geo.at("accuracy").at("tilt_deg"), 0.5);
  EXPECT_TRUE(geo.at("accuracy").at("vertical_m").is_null());
  EXPECT_EQ(geo.at("gravity").at(0).at("kind"), "ground");
  EXPECT_TRUE(geo.at("gravity").at(0).at("sigma_deg").is_null());
  EXPECT_EQ(geo.at("tags_alone_tilt_deg"), 19.0);
  EXPECT_EQ(geo.at("problems"), (nlohmann::json{"no_gimbal", "lag"}));

  base::WriteFileAtomically(folder_.path() / "metrics.json", text);
  const Metrics back = ReadMetrics(folder_.path() / "metrics.json");
  EXPECT_TRUE(back.georeferenced);
  EXPECT_EQ(back.problem_codes, metrics.problem_codes);
  EXPECT_EQ(MetricsJson(back), text);
}

TEST_F(MetricsJsonTest, AFitThatSaysNothingIsNull) {
  Metrics metrics;
  metrics.geo_fit.rmse_m = 3.0;  // of a fit that was refused
  metrics.geo_fit.n_inliers = 3;
  const auto geo = base::ParseJson(MetricsJson(metrics)).at("geo");
  for (const char* key : {"rmse_m", "rmse_horizontal_m", "rmse_vertical_m", "scale_m_per_model_unit", "tag_lag_sigma_s", "tags_alone_tilt_deg"}) {
    EXPECT_TRUE(geo.at(key).is_null()) << key;
  }
  EXPECT_TRUE(geo.at("accuracy").at("tilt_deg").is_null());
  EXPECT_EQ(geo.at("gravity"), nlohmann::json::array());
}

TEST_F(MetricsJsonTest, TheGeoReferenceOfAnEarlierVersionIsRead) {
  base::WriteFileAtomically(
      folder_.path() / "metrics.json",
      R"({"geo": {"georeferenced": true, "photos_with_gps": 4, "inliers": 3, "rmse_m": 1.5, "flight_vertical_offset_m": [2.0]}})");
  const Metrics back = ReadMetrics(folder_.path() / "metrics.json");
  EXPECT_TRUE(back.georeferenced);
  EXPECT_EQ(back.geo_fit.n_inliers, 3);
  EXPECT_EQ(back.geo_fit.rmse_m, 1.5);
  EXPECT_EQ(back.geo_fit.flight_vertical_offset_m, std::vector<double>{2.0});
  EXPECT_TRUE(std::isnan(back.geo_fit.accuracy.tilt_deg));
  EXPECT_TRUE(back.problem_codes.empty());
}

TEST_F(MetricsJsonTest, FileNamesThatAreNotUtf8AreRepaired) {
  Metrics metrics;
  photos::PhotoScore photo;
  photo.name = "M\xFChle.jpg";
  metrics.photos = {photo};
  EXPECT_NO_THROW({
    const auto json = base::ParseJson(MetricsJson(metrics));
    EXPECT_EQ(json["psnr_per_image"].size(), 1U);
  });
}

}  // namespace
}  // namespace skyquilt::evaluate::metrics
