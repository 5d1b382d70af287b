#include "evaluate/ortho/ortho_scorer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/base/file.h"
#include "core/image/srgb.h"
#include "evaluate/ortho/ortho_json.h"
#include "tests/evaluate/ortho/made_map.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/support/nadir_photo.h"

namespace skyquilt::evaluate::ortho {
namespace {

constexpr double kHeight_m = 50.0, kFocal_px = 800.0, kPixel_m = kHeight_m / kFocal_px;
constexpr double kMtf50OfGaussian = 0.1874;  // times the standard deviation

// Smooth waves in all directions, with a target at (30, 30) of side 6 m whose edge stands 5 degrees off east and is blurred by a Gaussian.
std::array<double, 3> Ground(double x, double y, double blur_m) {
  const double yaw = 5.0 * std::numbers::pi / 180.0, dx = x - 30.0, dy = y - 30.0;
  const double along = dx * std::cos(yaw) + dy * std::sin(yaw), beside = -dx * std::sin(yaw) + dy * std::cos(yaw);
  if (std::max(std::abs(along), std::abs(beside)) < 3.0) {
    const double white = 0.5 * std::erfc(beside / (blur_m * std::numbers::sqrt2));
    const double level = 255.0 * static_cast<double>(image::SrgbFromLinear(static_cast<float>(0.03 + 0.7 * white)));
    return {level, level, level};
  }
  const double wave = std::sin(0.9 * x + 0.3 * y) + std::sin(0.8 * y - 0.4 * x);
  return {100.0 + 15.0 * wave, 110.0 + 12.0 * wave, 90.0 + 10.0 * wave};
}

class OrthoScorerTest : public InTemporaryFolder {
 protected:
  OrthoScorerTest() {
    survey_.photo_root = folder_ / "photos";
    survey_.cameras.push_back({camera::CameraModel::kPinhole, 1200, 900, {kFocal_px, kFocal_px, 600.0, 450.0}});
    for (const auto& [x, y, name] :
         {std::tuple{10.0, 10.0, "a.png"}, {70.0, 10.0, "b.png"}, {10.0, 50.0, "c.png"}, {70.0, 50.0, "d.png"}, {40.0, 30.0, "e.png"}}) {
      survey_.photos.push_back(NadirPhoto({x, y, kHeight_m}, name));
    }
    for (const char* name : {"photos", "truth", "masks", "products"}) std::filesystem::create_directories(folder_ / name);
    info_.min_enu.setZero();
    info_.max_enu.setZero();
    survey::Truth& truth = survey_.truth.emplace();
    truth.ortho_tif = folder_ / "truth/orthophoto.tif";
  }

  std::optional<OrthoResult> Score() {
    base::ThreadPool threads(2);
    return ScoreOrtho(folder_ / "products", survey_, info_, threads);
  }

  const gis::MapGrid grid_ = LocalGrid(0.0, 60.0, 0.1, 800, 600);
  survey::Survey survey_;
  scene::SceneInfo info_;
};

std::array<double, 3> Brighter(std::array<double, 3> colour, double levels) {
  for (double& level : colour) level = std::round(level) + levels;
  return colour;
}

TEST_F(OrthoScorerTest, GivesNothingWithoutAMapAndOnlySourcesWithoutTruth) {
  EXPECT_FALSE(Score());
  survey_.truth.reset();
  WriteColours(
      LocalGrid(0.0, 60.0, 0.5, 160, 120),
      [](double x, double) {
        return std::array{x < 8.0 ? -1.0 : 5.0, 5.0, 5.0};
      },
      folder_ / "products/orthophoto.tif");
  std::optional<OrthoResult> result = Score();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->scores.cells, 144 * 120);
  EXPECT_EQ(result->scores.cell_m, 0.5);
  EXPECT_EQ(result->scores.photos_in_use, -1);
  EXPECT_TRUE(std::isnan(result->scores.psnr_db));
  base::WriteFileAtomically(
      folder_ / "products/ortho_sources.json",
      R"({"photos": {"a.png": {"value": 2, "cells": 75}, "b.png": {"value": 3, "cells": 0}}, "field_cells": 25, "cells": 100})");
  result = Score();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->scores.cells, 100);
  EXPECT_DOUBLE_EQ(result->scores.share_photos, 0.75);
  EXPECT_DOUBLE_EQ(result->scores.share_field, 0.25);
  EXPECT_EQ(result->scores.photos_in_use, 1);
  const OrthoScores read = OrthoScoresFromJson(ToJson(result->scores));
  EXPECT_EQ(read.cells, 100);
  EXPECT_EQ(read.photos_in_use, 1);
  EXPECT_DOUBLE_EQ(read.share_photos, 0.75);
  EXPECT_EQ(read.moving_car_cells, -1);
  EXPECT_TRUE(std::isnan(read.psnr_db));
}

TEST_F(OrthoScorerTest, ComparesWithTheTruthBetweenTheCameras) {
  const auto truth = [](double x, double y) { return Ground(x, y, 0.001); };
  WriteColours(grid_, truth, survey_.truth->ortho_tif);
  // Outside of the cameras everything is wrong, which does not count.
  const auto map = [&](double x, double y) {
    return x > 10.0 && x < 70.0 && y > 10.0 && y < 50.0 ? Brighter(truth(x, y), 3.0) : std::array{0.0, 0.0, 0.0};
  };
  WriteColours(grid_, map, folder_ / "products/orthophoto.tif");
  const std::optional<OrthoResult> result = Score();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->scores.cells_compared, 600 * 400);
  EXPECT_NEAR(result->scores.psnr_db, 20.0 * std::log10(255.0 / 3.0), 0.01);
  EXPECT_GT(result->scores.ssim, 0.95);
  EXPECT_LT(result->scores.ssim, 1.0);
  EXPECT_EQ(result->scores.shift_east_m, 0.0);
  EXPECT_EQ(result->scores.seams, -1) << "without sources";
  ASSERT_FALSE(result->crops.empty());
  EXPECT_EQ(result->crops[0].map.width, result->crops[0].truth.width);
}

TEST_F(OrthoScorerTest, FindsTheErrorOfTheGeoReference) {
  WriteColours(
      grid_, [](double x, double y) { return Ground(x, y, 0.2); }, survey_.truth->ortho_tif);
  WriteColours(
      grid_, [](double x, double y) { return Ground(x - 0.37, y + 0.22, 0.2); }, folder_ / "products/orthophoto.tif");
  const std::optional<OrthoResult> result = Score();
  ASSERT_TRUE(result);
  EXPECT_NEAR(result->scores.shift_east_m, 0.37, 0.01);
  EXPECT_NEAR(result->scores.shift_north_m, -0.22, 0.01);
  EXPECT_GT(result->scores.psnr_db, 40.0);
}

TEST_F(OrthoScorerTest, MeasuresSharpnessSeamsAndCars) {
  WriteColours(
      grid_, [](double x, double y) { return Ground(x, y, 0.001); }, survey_.truth->ortho_tif);
  // Two levels too bright in the west and one too dark in the east; half a car in the place that the mask below shows.
  const auto car = [](double x, double y) { return x > 46.5 && x < 48.5 && y > 38.125 && y < 40.125; };
  WriteColours(
      grid_, [&](double x, double y) { return Brighter(Ground(x, y, 0.1), x < 40.0 ? 2.0 : (car(x, y) ? 30.0 : -1.0)); },
      folder_ / "products/orthophoto.tif");
  WriteNumbers(
      grid_, [](double x, double) { return x < 40.0 ? 2.0 : 6.0; }, folder_ / "products/ortho_sources.tif");
  WriteNumbers(
      LocalGrid(0.0, 60.0, 0.5, 160, 120), [](double, double) { return 0.0; }, folder_ / "products/dsm.tif");
  base::WriteFileAtomically(
      folder_ / "products/ortho_sources.json",
      R"({"photos": {"a.png": {"value": 2, "cells": 240000}, "e.png": {"value": 6, "cells": 240000}}, "field_cells": 0, "cells": 480000})");
  survey_.truth->edge_targets_json = folder_ / "truth/edge_targets.json";
  base::WriteFileAtomically(survey_.truth->edge_targets_json, R"({"targets": [{"centre_enu": [30, 30, 0], "side_m": 6, "yaw_deg": 5}]})");
  image::Image8 photo(1200, 900, 3), mask(1200, 900, 1, 255);
  for (int v = 0; v < 900; ++v) {
    for (int u = 0; u < 1200; ++u) {
      const std::array<double, 3> colour = Ground(40.0 + (u + 0.5 - 600.0) * kPixel_m, 30.0 - (v + 0.5 - 450.0) * kPixel_m, 1.5 * kPixel_m);
      for (size_t c = 0; c < 3; ++c) photo.At(u, v)[c] = static_cast<uint8_t>(std::lround(colour[c]));
      if (u >= 704 && u < 768 && v >= 288 && v < 320) *mask.At(u, v) = 0;
    }
  }
  image::SavePng(photo, folder_ / "photos/e.png");
  survey_.truth->masks_folder = folder_ / "masks";
  image::SavePng(mask, folder_ / "masks/e.png.png");

  const std::optional<OrthoResult> result = Score();
  ASSERT_TRUE(result);
  const OrthoScores& scores = result->scores;
  EXPECT_EQ(scores.edge_targets, 1);
  EXPECT_NEAR(scores.mtf50_per_cell, kMtf50OfGaussian, 0.05 * kMtf50OfGaussian);
  EXPECT_NEAR(scores.mtf50_per_m, kMtf50OfGaussian / 0.1, 0.05 * kMtf50OfGaussian / 0.1);
  EXPECT_NEAR(scores.photo_mtf50_per_px, kMtf50OfGaussian / 1.5, 0.05 * kMtf50OfGaussian / 1.5);
  EXPECT_NEAR(scores.photo_mtf50_per_m, kMtf50OfGaussian / (1.5 * kPixel_m), 0.05 * kMtf50OfGaussian / (1.5 * kPixel_m));
  EXPECT_EQ(scores.seams, 1);
  EXPECT_NEAR(scores.seam_levels, 3.0, 0.1);
  EXPECT_NEAR(scores.seam_levels_worst, 3.0, 0.1);
  EXPECT_EQ(scores.moving_car_cells, 40 * 20);
  EXPECT_NEAR(scores.moving_car_share, 0.5, 0.02);
  EXPECT_GT(scores.psnr_db, 35.0);
  EXPECT_NE(OrthoSummary(scores).find("50.0 % of cells under moving cars differ"), std::string::npos) << OrthoSummary(scores);
}

TEST_F(OrthoScorerTest, SaysWhyATruthElsewhereIsNotUsed) {
  WriteColours(
      LocalGrid(500.0, 60.0, 0.5, 100, 100),
      [](double, double) {
        return std::array{1.0, 1.0, 1.0};
      },
      survey_.truth->ortho_tif);
  WriteColours(
      LocalGrid(0.0, 60.0, 0.5, 160, 120),
      [](double, double) {
        return std::array{5.0, 5.0, 5.0};
      },
      folder_ / "products/orthophoto.tif");
  const std::optional<OrthoResult> result = Score();
  ASSERT_TRUE(result);
  EXPECT_EQ(result->scores.cells, 160 * 120);
  EXPECT_TRUE(std::isnan(result->scores.psnr_db));
}

}  // namespace
}  // namespace skyquilt::evaluate::ortho
