#include "products/point_preview.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"
#include "core/gis/geotiff.h"
#include "tests/products/patterned_survey.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::products {
namespace {

using World = PatternedSurvey;

class PointPreviewTest : public testing::Test {
 protected:
  PointPreview Make(const survey::Survey& survey, const ProductOptions& options = {}) {
    const PointPreview preview = MakePointPreview(survey, options, folder_ / "products", threads_);
    map_ = gis::ReadReduced(folder_ / "products/preview_ortho.tif", 1 << 20).image;
    EXPECT_EQ(map_.width, preview.grid.width);
    EXPECT_EQ(map_.height, preview.grid.height);
    return preview;
  }
  // The cell that holds this place; null outside the map.
  const float* CellAt(const survey::Survey& survey, const gis::MapGrid& grid, double x, double y) const {
    Eigen::Vector2d place(x, y);
    if (survey.georeferenced) {
      place = geo::UtmFromGeodetic(geo::EnuFrame(survey.origin).GeodeticFromEnu({x, y, World::SurfaceZ(x, y)}), grid.zone);
    }
    const Eigen::Vector2d cell = grid.CellOf(place).array().round().matrix();
    if (!(cell.minCoeff() >= 0.0 && cell.x() < map_.width && cell.y() < map_.height)) return nullptr;
    return map_.At(static_cast<int>(cell.x()), static_cast<int>(cell.y()));
  }
  // Differences from the true colours, of 255, over all that the cameras fly over but the edges of the house.
  std::vector<double> Errors(const survey::Survey& survey, const gis::MapGrid& grid) const {
    std::vector<double> errors;
    for (double x = World::kWest; x <= World::kEast; x += 0.7) {
      for (double y = World::kSouth; y <= World::kNorth; y += 0.7) {
        if (World::InHouse(x, y, 4.0) && !World::InHouse(x, y, -3.0)) continue;
        const float* rgba = CellAt(survey, grid, x, y);
        if (rgba == nullptr || rgba[3] != 255.0F) {
          ADD_FAILURE() << "no data at " << x << " " << y;
          continue;
        }
        const std::array<double, 3> color = World::Color(x, y);
        for (size_t c = 0; c < 3; ++c) errors.push_back(std::abs(static_cast<double>(rgba[c]) - 255.0 * color[c]));
      }
    }
    return errors;
  }

  TemporaryFolder folder_;
  base::ThreadPool threads_{2};
  image::ImageF map_;
};

// The photos differ by a whole stop; a quarter of a stop that is left over would be an error of about 9 of 255.
TEST_F(PointPreviewTest, ShowsTheTrueColoursAtTheirPlaces) {
  for (const bool georeferenced : {true, false}) {
    const survey::Survey survey = World::Write(folder_.path(), 0.5, georeferenced);
    const PointPreview preview = Make(survey);
    EXPECT_EQ(preview.photos, 12);
    EXPECT_GT(preview.filled, 0.9);
    const double gsd_m = World::kFlight_m / World::kFocal_px;
    EXPECT_GE(preview.grid.resolution_m, 0.99 * gsd_m);
    EXPECT_LE(preview.grid.resolution_m, 1.1 * gsd_m);
    const std::vector<double> errors = Errors(survey, preview.grid);
    ASSERT_GT(errors.size(), 2000U);
    EXPECT_LT(base::Quantile(errors, 0.5), 2.5);
    EXPECT_LT(base::Quantile(errors, 0.99), 10.0);
    const auto json = base::ParseJson(base::ReadFile(folder_ / "products/preview_ortho.json"));
    EXPECT_EQ(json["preview"], kFromSparsePoints);
    EXPECT_EQ(json["crs"], georeferenced ? "EPSG:32632" : "local");
    EXPECT_EQ(preview.picture, folder_ / "products/preview_ortho.png");
  }
}

TEST_F(PointPreviewTest, TheNumberOfThreadsDoesNotMatter) {
  const survey::Survey survey = World::Write(folder_.path(), 0.5, true);
  base::ThreadPool one(1);
  MakePointPreview(survey, {}, folder_ / "one", one);
  Make(survey);
  for (const char* name : {"preview_ortho.tif", "preview_ortho.png", "preview_ortho.json"}) {
    EXPECT_EQ(base::ReadFile(folder_ / "one" / name), base::ReadFile(folder_ / "products" / name)) << name;
  }
}

TEST_F(PointPreviewTest, BordersOfPhotosAreNoSteps) {
  const survey::Survey survey = World::Write(folder_.path(), 0.5, false);
  const PointPreview preview = Make(survey);
  // Along a line without house the colours of neighbouring cells differ by the pattern alone, which changes by less than 4 of 255 per cell.
  const int row = static_cast<int>(std::lround(preview.grid.CellOf({0.0, 9.0}).y()));
  int compared = 0;
  for (int column = 1; column < map_.width; ++column) {
    const float *here = map_.At(column, row), *before = map_.At(column - 1, row);
    if (here[3] != 255.0F || before[3] != 255.0F) continue;
    ++compared;
    for (size_t c = 0; c < 3; ++c) EXPECT_LE(std::abs(here[c] - before[c]), 6.0F) << column;
  }
  EXPECT_GT(compared, 200);
}

TEST_F(PointPreviewTest, WhereNoPhotoLooksThereIsNoData) {
  survey::Survey survey = World::Write(folder_.path(), 0.0, false);
  // Of the lower row, the first and the last photo are left, which do not meet.
  survey.photos = {survey.photos[0], survey.photos[3]};
  survey.photos[1].cam_from_enu = NadirPhoto({80.0, -12.0, 43.0}, "").cam_from_enu;
  survey.points = {survey.points[1], survey.points[2]};
  const PointPreview preview = Make(survey);
  EXPECT_LT(preview.filled, 0.8);
  const float* gap = CellAt(survey, preview.grid, 30.0, -12.0);
  ASSERT_NE(gap, nullptr);
  EXPECT_EQ(gap[3], 0.0F);
  const float* seen = CellAt(survey, preview.grid, World::kWest, -12.0);
  ASSERT_NE(seen, nullptr);
  EXPECT_EQ(seen[3], 255.0F);
}

TEST_F(PointPreviewTest, TwoPointsAreEnoughAndNoneAreNot) {
  survey::Survey survey = World::Write(folder_.path(), 0.0, true);
  survey.points.resize(2);
  survey.points[0].x_in_enu = {-10.0, 9.0, World::kGround_m};
  survey.points[1].x_in_enu = {14.0, -9.0, World::kGround_m};
  const PointPreview preview = Make(survey);
  EXPECT_GT(preview.filled, 0.9);
  EXPECT_LT(base::Quantile(Errors(survey, preview.grid), 0.5), 2.5);
  survey.points.clear();
  const std::string error = InputErrorOf([&] { Make(survey); });
  EXPECT_NE(error.find("no sparse points"), std::string::npos) << error;
}

TEST_F(PointPreviewTest, OnePhotoIsEnough) {
  survey::Survey survey = World::Write(folder_.path(), 0.0, true);
  survey.photos = {survey.photos[5]};
  const PointPreview preview = Make(survey);
  EXPECT_EQ(preview.photos, 1);
  const float* below = CellAt(survey, preview.grid, -6.5, 6.5);
  ASSERT_NE(below, nullptr);
  EXPECT_EQ(below[3], 255.0F);
}

TEST_F(PointPreviewTest, PhotosThatCannotBeReadAreLeftOut) {
  const survey::Survey survey = World::Write(folder_.path(), 0.0, false);
  std::filesystem::remove(folder_ / "p15.png");
  std::ofstream(folder_ / "p16.png") << "no picture";
  testing::internal::CaptureStdout();
  const PointPreview preview = Make(survey);
  testing::internal::GetCapturedStdout();
  EXPECT_EQ(preview.photos, 10);
  EXPECT_EQ(preview.unreadable, 2);
  EXPECT_LT(base::Quantile(Errors(survey, preview.grid), 0.5), 2.5);
  for (const survey::Photo& photo : survey.photos) std::filesystem::remove(folder_ / photo.name);
  const std::string error = InputErrorOf([&] { Make(survey); });
  EXPECT_NE(error.find("no photo can be read"), std::string::npos) << error;
}

TEST_F(PointPreviewTest, MasksAreKeptTo) {
  survey::Survey survey = World::Write(folder_.path(), 0.0, false);
  // All of the photo above the middle of the northern row is masked, and painted so that it would show.
  image::SavePng(image::Image8(World::kWidth, World::kHeight, 3, 255), folder_ / survey.photos[9].name);
  image::SavePng(image::Image8(World::kWidth, World::kHeight, 1, 0), folder_ / "mask.png");
  survey.photos[9].mask = (folder_ / "mask.png").string();
  const PointPreview preview = Make(survey);
  EXPECT_LT(base::Quantile(Errors(survey, preview.grid), 0.99), 12.0);
}

TEST_F(PointPreviewTest, CamerasBelowTheGroundMakeNone) {
  survey::Survey survey = World::Write(folder_.path(), 0.0, false);
  for (survey::SparsePoint& point : survey.points) point.x_in_enu.z() += 100.0;
  EXPECT_NE(InputErrorOf([&] { Make(survey); }).find("no photo looks down"), std::string::npos);
}

TEST_F(PointPreviewTest, CanBeInterrupted) {
  const survey::Survey survey = World::Write(folder_.path(), 0.0, false);
  ExpectStopsWhenAsked([&] { MakePointPreview(survey, {}, folder_ / "products", threads_); });
  EXPECT_FALSE(FindPreview(folder_ / "products", kFromSparsePoints));
}

}  // namespace
}  // namespace skyquilt::products
