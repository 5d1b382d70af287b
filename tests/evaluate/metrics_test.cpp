#include "evaluate/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate {
namespace {

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

TEST(MetricsJson, HasEveryPromisedKeyEvenWhenNothingWasMeasured) {
  const auto json = nlohmann::json::parse(MetricsJson(Metrics{}));
  for (const char* key : {"psnr", "ssim", "coverage", "psnr_full_frame", "ssim_full_frame", "lpips", "seam_psnr_gap_db", "train_seconds",
                          "samples_per_second", "peak_rss_bytes"}) {
    ASSERT_TRUE(json.contains(key)) << key;
    EXPECT_TRUE(json[key].is_null()) << key;
  }
  for (const char* key : {"psnr_per_image", "psnr_per_block", "parameters", "ranks", "config", "machine", "date", "geo", "median_agl_m"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_TRUE(json["psnr_per_image"].is_object());
  EXPECT_FALSE(json.contains("depth_rmse_m"));
  EXPECT_FALSE(json.contains("floater_opacity"));
}

TEST(MetricsJson, WritesValuesAndTurnsNanAndInfinityIntoNull) {
  Metrics metrics;
  metrics.psnr = 27.5;
  metrics.has_truth = true;
  metrics.depth_rmse_m = 0.75;
  metrics.floater_opacity = 0.02;
  metrics.floater_profile = {{1.0, 0.03}, {10.0, kNotMeasured}};
  PhotoScore good, blank, equal;
  good.name = "a/one.jpg";
  good.psnr_db = 27.5;
  good.used_pixels = 10;
  good.covered_pixels = 5;
  blank.name = "two.jpg";
  equal.name = "three.jpg";
  equal.psnr_db = std::numeric_limits<double>::infinity();
  metrics.photos = {good, blank, equal};
  metrics.blocks = {{"r0c0", 28.0, 100}, {"r0c1", kNotMeasured, 0}};
  const auto json = nlohmann::json::parse(MetricsJson(metrics));
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

TEST(MetricsJson, IsReadBackAsItWasWritten) {
  Metrics metrics;
  metrics.psnr = 27.515625;
  metrics.seam_psnr_gap_db = -0.125;
  metrics.has_truth = true;
  metrics.depth_median_abs_m = 0.1;
  metrics.floater_opacity = 0.02;
  metrics.floater_profile = {{1.0, 0.03}, {10.0, kNotMeasured}};
  metrics.blocks = {{"r0c0", 28.0, 100}, {"r0c1", kNotMeasured, 0}};
  metrics.train_seconds = 12.5;
  metrics.peak_rss_bytes = 123456789012;
  metrics.parameters = 7;
  metrics.n_test = 3;
  metrics.warnings = {{"one", "do this"}, {"two", "do that"}};
  const TemporaryFolder folder;
  base::WriteFileAtomically(folder.path() / "metrics.json", MetricsJson(metrics));
  const Metrics back = ReadMetrics(folder.path() / "metrics.json");
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
  EXPECT_EQ(back.train_seconds, metrics.train_seconds);
  EXPECT_EQ(back.peak_rss_bytes, metrics.peak_rss_bytes);
  EXPECT_EQ(back.n_test, 3);
  EXPECT_EQ(back.warnings, metrics.warnings);
  base::WriteFileAtomically(folder.path() / "metrics.json", "{\"psnr\": 1, \"rank");
  EXPECT_THROW(ReadMetrics(folder.path() / "metrics.json"), base::InputError);
  base::WriteFileAtomically(folder.path() / "metrics.json", "{\"n_test\": 1, \"photos_held_out\": \"many\"}");
  EXPECT_THROW(ReadMetrics(folder.path() / "metrics.json"), base::InputError);
}

TEST(MetricsJson, FileNamesThatAreNotUtf8AreRepaired) {
  Metrics metrics;
  PhotoScore photo;
  photo.name = "M\xFChle.jpg";
  metrics.photos = {photo};
  EXPECT_NO_THROW({
    const auto json = nlohmann::json::parse(MetricsJson(metrics));
    EXPECT_EQ(json["psnr_per_image"].size(), 1U);
  });
}

}  // namespace
}  // namespace skyquilt::evaluate
