#include "bench/study/heights_survey.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/progress.h"
#include "core/image/image.h"
#include "core/survey/colmap_model.h"
#include "prepare/prepare.h"
#include "simulate/simulate.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::bench {
namespace {

namespace fs = std::filesystem;

simulate::SimulateOptions SmallHamlet() {
  simulate::SimulateOptions options;
  options.place = "hamlet";
  options.seed = 5;
  options.image_width = 64;
  options.samples_per_pixel = 1;
  return options;
}

const HeightsPlan kPlan = {.flights_m = {60, 120}, .views_m = {30, 240}, .views = 4, .test_every = 8};

std::vector<std::string> Lines(const fs::path& file) {
  std::istringstream text(base::ReadFile(file));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

fs::path DepthFile(const fs::path& folder, const std::string& photo) {
  return folder / "truth" / "depth" / (fs::path(photo).stem().string() + ".tiff");
}

class HeightsSurvey : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    base::Progress::SetQuiet(true);
    root_ = std::make_unique<TemporaryFolder>();
    folder_ = *root_ / "heights";
    holdout_ = SimulateHeights(SmallHamlet(), kPlan, folder_, Threads());
    model_ = survey::ReadColmapModel(folder_ / "sparse/0");
  }
  static void TearDownTestSuite() { root_.reset(); }
  static base::ThreadPool& Threads() {
    static base::ThreadPool threads(2);
    return threads;
  }
  static std::map<int, std::vector<std::string>> NamesByHeight() {
    std::map<int, std::vector<std::string>> names;
    for (const survey::ColmapImage& image : model_.images) names[HeightOfPhoto(image.name)].push_back(image.name);
    return names;
  }

  static inline std::unique_ptr<TemporaryFolder> root_;
  static inline fs::path folder_, holdout_;
  static inline survey::ColmapModel model_;
};

TEST_F(HeightsSurvey, WholeFlightsHaveEquallyManyPhotosAndViewsTheirNumber) {
  const auto names = NamesByHeight();
  ASSERT_EQ(names.size(), 4U);
  EXPECT_GE(names.at(60).size(), 20U);
  EXPECT_EQ(names.at(60).size(), names.at(120).size());
  EXPECT_EQ(names.at(30).size(), 4U);
  EXPECT_EQ(names.at(240).size(), 4U);
  for (const survey::ColmapImage& image : model_.images) EXPECT_TRUE(fs::exists(folder_ / "images" / image.name)) << image.name;
  const auto json = base::ParseJson(base::ReadFile(folder_ / "heights.json"));
  EXPECT_EQ(json["photos"]["h120_"].get<std::vector<std::string>>(), names.at(120));
}

TEST_F(HeightsSurvey, ExactlyTheHeldOutPhotosHaveDepth) {
  EXPECT_EQ(holdout_, folder_ / "holdout.txt");
  const std::vector<std::string> lines = Lines(holdout_);
  const std::set<std::string> held_out(lines.begin(), lines.end());
  EXPECT_EQ(held_out.size(), lines.size());
  for (const auto& [height, names] : NamesByHeight()) {
    const bool whole = height == 60 || height == 120;
    for (size_t i = 0; i < names.size(); ++i) {
      EXPECT_EQ(held_out.contains(names[i]), !whole || i % 8 == 0) << names[i];
      EXPECT_EQ(fs::exists(DepthFile(folder_, names[i])), held_out.contains(names[i])) << names[i];
    }
  }
}

// Points were found in the whole flights. Where views from other heights see them, the true depth agrees: all show the same place in one frame.
TEST_F(HeightsSurvey, AllHeightsShowTheSamePlace) {
  std::map<int, std::vector<double>> pixels_off;
  for (const survey::ColmapImage& image : model_.images) {
    if (!fs::exists(DepthFile(folder_, image.name))) continue;
    const camera::Camera& camera = model_.cameras.at(image.camera_id);
    const image::ImageF depth = image::LoadFloatTiff(DepthFile(folder_, image.name));
    for (const survey::ColmapPoint& point : model_.points) {
      if (std::find(point.image_ids.begin(), point.image_ids.end(), image.id) == point.image_ids.end()) continue;
      const Eigen::Vector3d in_cam = image.cam_from_world * point.x_in_world;
      const auto pixel = camera.ImgFromCam(in_cam);
      ASSERT_TRUE(pixel.has_value());
      const auto seen = static_cast<double>(*depth.At(static_cast<int>(pixel->x()), static_cast<int>(pixel->y())));
      pixels_off[HeightOfPhoto(image.name)].push_back(std::abs(seen - in_cam.z()) / (in_cam.z() / camera.FocalX()));
    }
  }
  ASSERT_EQ(pixels_off.size(), 4U);
  for (auto& [height, off] : pixels_off) {
    ASSERT_GT(off.size(), 100U) << height;
    std::sort(off.begin(), off.end());
    EXPECT_LT(off[off.size() / 2], 0.3) << height;
  }
  // The place is that of an ordinary flight with the same seed.
  simulate::SimulateOptions ordinary = SmallHamlet();
  ordinary.altitudes = {100.0};
  ordinary.single_line = true;
  simulate::Simulate(ordinary, *root_ / "ordinary", Threads());
  EXPECT_EQ(base::ReadFile(folder_ / "truth/buildings.json"), base::ReadFile(*root_ / "ordinary" / "truth/buildings.json"));
}

TEST_F(HeightsSurvey, WholeFlightsAreAboveTheSamePoints) {
  std::map<int, Eigen::Vector3d> mean;
  for (const survey::ColmapImage& image : model_.images) {
    mean.try_emplace(HeightOfPhoto(image.name), Eigen::Vector3d::Zero()).first->second += image.cam_from_world.OriginInSource();
  }
  for (auto& [height, sum] : mean) sum /= static_cast<double>(NamesByHeight().at(height).size());
  EXPECT_LT((mean[120] - mean[60]).head<2>().norm(), 1.0);
  EXPECT_NEAR(mean[120].z() - mean[60].z(), 60.0, 0.5);
  EXPECT_NEAR(mean[240].z() - mean[30].z(), 210.0, 1.0);
}

TEST_F(HeightsSurvey, ViewsAddNoPoints) {
  HeightsPlan plan = kPlan;
  plan.views_m.clear();
  SimulateHeights(SmallHamlet(), plan, *root_ / "no_views", Threads());
  const survey::ColmapModel without = survey::ReadColmapModel(*root_ / "no_views" / "sparse/0");
  ASSERT_EQ(without.images.size() + 8, model_.images.size());
  EXPECT_NEAR(static_cast<double>(model_.points.size()) / static_cast<double>(without.points.size()), 1.0, 0.02);
}

TEST_F(HeightsSurvey, ViewsSeeLittleBeyondTheArea) {
  const auto summary = base::ParseJson(base::ReadFile(folder_ / "simulate.json"));
  const Eigen::Vector2d low(summary["blocks"]["min_enu"][0], summary["blocks"]["min_enu"][1]);
  const Eigen::Vector2d high(summary["blocks"]["max_enu"][0], summary["blocks"]["max_enu"][1]);
  for (const survey::ColmapImage& image : model_.images) {
    if (HeightOfPhoto(image.name) != 30) continue;
    const camera::Camera& camera = model_.cameras.at(image.camera_id);
    const image::ImageF depth = image::LoadFloatTiff(DepthFile(folder_, image.name));
    int inside = 0;
    for (int y = 0; y < depth.height; ++y) {
      for (int x = 0; x < depth.width; ++x) {
        const Eigen::Vector3d ray = camera.RayFromImg({x + 0.5, y + 0.5});
        const Eigen::Vector3d in_cam = ray * (static_cast<double>(*depth.At(x, y)) / ray.z());
        const Eigen::Vector3d seen = image.cam_from_world.rotation.conjugate() * (in_cam - image.cam_from_world.translation);
        if ((seen.head<2>() - low).minCoeff() >= 0.0 && (high - seen.head<2>()).minCoeff() >= 0.0) ++inside;
      }
    }
    EXPECT_GT(inside, 0.9 * depth.width * depth.height) << image.name;
  }
}

TEST_F(HeightsSurvey, PrepareReadsItAndHoldsOutTheList) {
  prepare::PrepareOptions options;
  options.holdout = "list:" + holdout_.string();
  const survey::Survey survey = prepare::Prepare({folder_, {}, *root_ / "prepared"}, options, Threads());
  ASSERT_EQ(survey.photos.size(), model_.images.size());
  EXPECT_TRUE(survey.unregistered.empty());
  EXPECT_TRUE(survey.problems.empty()) << survey.problems.front().finding;
  ASSERT_TRUE(survey.truth.has_value());
  const std::vector<std::string> lines = Lines(holdout_);
  for (const survey::Photo& photo : survey.photos) {
    EXPECT_EQ(photo.is_test, std::find(lines.begin(), lines.end(), photo.name) != lines.end()) << photo.name;
    EXPECT_NEAR(photo.agl_m, HeightOfPhoto(photo.name), 8.0) << photo.name;  // above roofs too
    EXPECT_LT(photo.gps_residual_m, 0.05) << photo.name;
    EXPECT_EQ(photo.exposure.time_s, survey.photos.front().exposure.time_s);
    EXPECT_TRUE(photo.mask.empty());
  }
}

TEST_F(HeightsSurvey, ACompleteSurveyIsKeptAndAnotherOneReplaced) {
  const fs::path folder = *root_ / "again";
  HeightsPlan plan = {.flights_m = {90}, .views_m = {}, .views = 1, .test_every = 4};
  SimulateHeights(SmallHamlet(), plan, folder, Threads());
  const std::string photo = base::ReadFile(folder / "images/h090_IMG_0002.jpg");
  base::WriteFileAtomically(folder / "images/h090_IMG_0002.jpg", "changed");
  SimulateHeights(SmallHamlet(), plan, folder, Threads());
  EXPECT_EQ(base::ReadFile(folder / "images/h090_IMG_0002.jpg"), "changed");
  // Incomplete: as an interruption leaves it.
  fs::remove(folder / "simulate.json");
  base::WriteFileAtomically(folder / "simulate.started", "");
  SimulateHeights(SmallHamlet(), plan, folder, Threads());
  EXPECT_EQ(base::ReadFile(folder / "images/h090_IMG_0002.jpg"), photo);
  // Another plan, and other options.
  plan.flights_m = {100};
  SimulateHeights(SmallHamlet(), plan, folder, Threads());
  EXPECT_FALSE(fs::exists(folder / "images/h090_IMG_0002.jpg"));
  const std::string before = base::ReadFile(folder / "images/h100_IMG_0002.jpg");
  simulate::SimulateOptions other = SmallHamlet();
  other.seed = 6;
  SimulateHeights(other, plan, folder, Threads());
  EXPECT_NE(base::ReadFile(folder / "images/h100_IMG_0002.jpg"), before);
}

TEST(HeightsPlan, ImpossibleOnesAreUsageErrors) {
  const TemporaryFolder folder;
  base::ThreadPool threads(1);
  const auto error = [&](const HeightsPlan& plan) { return UsageErrorOf([&] { SimulateHeights(SmallHamlet(), plan, folder / "never", threads); }); };
  EXPECT_NE(error({.flights_m = {}}), "");
  EXPECT_NE(error({.flights_m = {60, 0}}).find("0 m"), std::string::npos);
  EXPECT_NE(error({.flights_m = {60}, .views_m = {1000}}).find("1000 m"), std::string::npos);
  EXPECT_NE(error({.flights_m = {60, 120}, .views_m = {60}}).find("twice"), std::string::npos);
  EXPECT_NE(error({.views = 0}), "");
  EXPECT_NE(error({.test_every = 1}), "");
  EXPECT_FALSE(fs::exists(folder / "never"));
}

TEST(HeightOfPhoto, ReadsThePrefix) {
  EXPECT_EQ(HeightOfPhoto("h060_IMG_0001.jpg"), 60);
  EXPECT_EQ(HeightOfPhoto(HeightPrefix(7) + "a.jpg"), 7);
  for (const char* other : {"IMG_0001.jpg", "h60_IMG_0001.jpg", "h06a_1.jpg", "h060-1.jpg", "h060", ""}) EXPECT_EQ(HeightOfPhoto(other), -1) << other;
}

RC_GTEST_PROP(HalfOfEach, IsAsManyAsOneFlightAndEvenlySpread, ()) {
  const auto n = *rc::gen::inRange(1, 200);
  std::vector<std::string> names;
  for (const int height : {120, 60}) {
    for (int i = 0; i < n; ++i) names.push_back(HeightPrefix(height) + "IMG_" + std::to_string(1000 + i) + ".jpg");
  }
  const std::vector<std::string> chosen = HalfOfEach(names);
  RC_ASSERT(chosen.size() == static_cast<size_t>(n));
  RC_ASSERT(std::is_sorted(chosen.begin(), chosen.end()));
  std::map<int, std::vector<int>> numbers;
  for (const std::string& name : chosen) numbers[HeightOfPhoto(name)].push_back(std::stoi(name.substr(9, 4)));
  for (const auto& [height, of] : numbers) {
    RC_ASSERT(std::abs(2 * static_cast<int>(of.size()) - n) <= 1);
    for (size_t i = 1; i < of.size(); ++i) RC_ASSERT(of[i] - of[i - 1] >= 1 && of[i] - of[i - 1] <= 3);
  }
}

}  // namespace
}  // namespace skyquilt::bench
