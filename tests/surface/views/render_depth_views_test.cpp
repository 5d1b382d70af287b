#include "surface/views/render_depth_views.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/progress.h"
#include "surface/views/view_files.h"
#include "tests/support/temporary_folder.h"
#include "tests/surface/views/analytic_survey.h"

namespace skyquilt::surface {
namespace {

namespace fs = std::filesystem;

class RenderViews : public testing::Test {
 protected:
  RenderViews() {
    base::Progress::SetQuiet(true);
    AddAll(survey_);
  }
  static void AddAll(AnalyticSurvey& survey) {
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) survey.AddPhoto(20.0 * x, 15.0 * y, x == 1 && y == 0);
    }
  }
  DepthViews Render(AnalyticSurvey& survey, int n_threads = 2) {
    base::ThreadPool threads(n_threads);
    return RenderDepthViews(survey.input, AnalyticSurvey::kVoxel, threads);
  }
  // What an uninterrupted run writes.
  std::string WholeFile(int n_threads = 2) {
    TemporaryFolder folder;
    AnalyticSurvey survey(folder.path());
    AddAll(survey);
    Render(survey, n_threads);
    whole_rays_ = survey.scene.rays;
    return base::ReadFile(folder / "views.bin");
  }
  // Interrupts the run after so many rays.
  void Interrupt(int64_t rays) {
    survey_.scene.rays_left = rays;
    EXPECT_THROW(Render(survey_), base::Interrupted);
    survey_.scene.rays_left = std::numeric_limits<int64_t>::max();
  }
  void Damage(const fs::path& file, size_t position) {
    std::string content = base::ReadFile(file);
    ASSERT_LT(position, content.size());
    content[position] = static_cast<char>(content[position] ^ 1);
    base::WriteFileAtomically(file, content);
  }

  TemporaryFolder folder_;
  AnalyticSurvey survey_{folder_.path()};
  int64_t whole_rays_ = 0;
};

constexpr int64_t kPhotoRays = 100 * 75;

TEST_F(RenderViews, OnlyWideViewsAreImproved) {
  int calls = 0;
  const ImprovePhotoViews improve = [&](std::span<const ViewPose> poses, const std::string&, const fs::path&, std::vector<fs::path>* files) {
    ++calls;
    EXPECT_EQ(poses.size(), 8U);
    EXPECT_EQ(files->size(), poses.size());
  };
  base::ThreadPool threads(2);
  RenderDepthViews(survey_.input, AnalyticSurvey::kVoxel, threads, improve);
  EXPECT_EQ(calls, 0);  // 100 pixels wide
  survey_.survey.cameras[0] = PinholeCamera(1400, 20, 1400.0);
  survey_.info.gsd_m = 60.0 / 1400.0;
  const DepthViews views = RenderDepthViews(survey_.input, AnalyticSurvey::kVoxel, threads, improve);
  EXPECT_EQ(calls, 1);
  for (size_t v = 0; v < views.size(); ++v) {
    // Virtual ones count less beside improved ones.
    EXPECT_EQ(views[v].weight[0] == kFullWeight, views.pose(v).photo >= 0);
  }
}

TEST_F(RenderViews, DepthsAreThoseOfTheScene) {
  const DepthViews views = Render(survey_);
  ASSERT_GE(views.size(), 9U);
  for (size_t v = 0; v < views.size(); ++v) {
    const DepthView view = views[v];
    size_t right = 0;
    for (size_t i = 0; i < view.depth_m.size(); ++i) {
      EXPECT_EQ(std::isnan(view.depth_m[i]), view.cosine[i] == 0);
      if (std::isnan(view.depth_m[i])) continue;
      const auto width = static_cast<size_t>(view.pose.width);
      const Eigen::Vector3d d = view.pose.DirectionAt(static_cast<double>(i % width) + 0.5, static_cast<double>(i / width) + 0.5);
      ASSERT_NEAR(static_cast<double>(view.depth_m[i]), survey_.scene.Depth(view.pose.Centre(), d), 1e-3);
      ++right;
    }
    EXPECT_GT(right, view.depth_m.size() / 2);
  }
  EXPECT_FALSE(fs::exists(folder_ / "views"));
}

TEST_F(RenderViews, PhotosComeFirstThenGaps) {
  const DepthViews views = Render(survey_);
  const int order[] = {0, 1, 2, 3, 4, 5, 6, 8};  // 7 is held out
  ASSERT_GT(views.size(), 8U);
  for (size_t v = 0; v < 8; ++v) EXPECT_EQ(views.pose(v).photo, order[v]);
  int64_t virtual_rays = 0;
  for (size_t v = 8; v < views.size(); ++v) {
    EXPECT_EQ(views.pose(v).photo, -1);
    virtual_rays += static_cast<int64_t>(views.pose(v).width) * views.pose(v).height;
  }
  EXPECT_LE(virtual_rays, kPhotoRays * 8);
}

TEST_F(RenderViews, TheyDoNotDependOnWhereHeldOutPhotosAre) {
  const std::string whole = WholeFile();
  survey_.MoveHeldOut();
  Render(survey_);
  EXPECT_TRUE(base::ReadFile(folder_ / "views.bin") == whole);
  EXPECT_EQ(survey_.scene.rays, whole_rays_);
}

TEST_F(RenderViews, WithoutVirtualViewsOnlyPhotos) {
  survey_.input.options.virtual_views = false;
  EXPECT_EQ(Render(survey_).size(), 8U);
}

TEST_F(RenderViews, VirtualViewsOfLevelPhotosAreLevelToo) {
  survey_.survey.photos.clear();
  survey_.scene.house_min = {-40.0, 0.0, 0.0};
  survey_.scene.house_max = {40.0, 10.0, 15.0};
  for (const double x : {-10.0, 0.0, 10.0}) {
    survey_.AddPhoto(x, -20.0);
    survey_.survey.photos.back().cam_from_enu = LookingLevel({x, -20.0, 1.7}, 0.0);
    survey_.survey.photos.back().agl_m = 20.0;
  }
  const DepthViews views = Render(survey_);
  ASSERT_GT(views.size(), 3U);
  for (size_t v = 3; v < views.size(); ++v) {
    const ViewPose& pose = views.pose(v);
    EXPECT_EQ(pose.photo, -1);
    EXPECT_NEAR(pose.Centre().z(), 1.7, 1e-9);
    EXPECT_GT(pose.DirectionAt(pose.cx, pose.cy).y(), 0.5);
  }
}

TEST_F(RenderViews, SameBitsForAnyNumberOfThreads) {
  EXPECT_TRUE(WholeFile(1) == WholeFile(3));
}

TEST_F(RenderViews, AFinishedFileIsOpenedAtOnce) {
  Render(survey_);
  const int64_t rays = survey_.scene.rays;
  const DepthViews again = Render(survey_);
  EXPECT_EQ(survey_.scene.rays, rays);
  EXPECT_GT(again.size(), 8U);
  // But not with other options.
  survey_.input.options.min_opacity = 0.9;
  Render(survey_);
  EXPECT_EQ(survey_.scene.rays, 2 * rays);
}

TEST_F(RenderViews, GoesOnAfterAnInterruption) {
  const std::string whole = WholeFile();
  // In two photos, and in the first virtual view.
  for (const int64_t left : {kPhotoRays * 5 / 2, kPhotoRays * 11 / 2 + 100}) Interrupt(left);
  const int64_t finished = 7 * kPhotoRays;  // 2, then 5 more
  EXPECT_EQ(survey_.scene.rays, finished);
  Interrupt(kPhotoRays + 10);
  const int64_t before = survey_.scene.rays;
  EXPECT_EQ(before, finished + kPhotoRays);
  Render(survey_);
  EXPECT_EQ(survey_.scene.rays, whole_rays_);
  EXPECT_TRUE(base::ReadFile(folder_ / "views.bin") == whole);
}

TEST_F(RenderViews, ADamagedOrForeignViewIsRenderedAgain) {
  const std::string whole = WholeFile();
  Interrupt(whole_rays_ - 1);
  const int64_t finished = survey_.scene.rays;
  Damage(folder_ / "views" / ViewFileName(1), 5000);
  fs::resize_file(folder_ / "views" / ViewFileName(2), 1000);
  fs::copy_file(folder_ / "views" / ViewFileName(4), folder_ / "views" / ViewFileName(3), fs::copy_options::overwrite_existing);
  Render(survey_);
  EXPECT_EQ(survey_.scene.rays, whole_rays_ + 3 * kPhotoRays);
  EXPECT_LT(finished, whole_rays_);
  EXPECT_TRUE(base::ReadFile(folder_ / "views.bin") == whole);
}

TEST_F(RenderViews, ADamagedFileOfAllViewsIsReportedAndMadeAgain) {
  Render(survey_);
  const fs::path file = folder_ / "views.bin";
  const std::string whole = base::ReadFile(file);
  const auto expect_report = [&] { EXPECT_THROW(DepthViews::Open(file), base::InputError); };
  for (const size_t position : {size_t{0}, size_t{33}, size_t{41}, size_t{47}, size_t{60}, size_t{140}}) {  // magic, checksum, count, list
    Damage(file, position);
    expect_report();
    base::WriteFileAtomically(file, whole);
  }
  for (const size_t size : {size_t{0}, size_t{20}, size_t{48}, size_t{100}, whole.size() / 2, whole.size() - 1}) {
    base::WriteFileAtomically(file, std::string_view(whole).substr(0, size));
    expect_report();
  }
  base::WriteFileAtomically(file, whole + "more");
  expect_report();
  Render(survey_);
  EXPECT_TRUE(base::ReadFile(file) == whole);
  // A bit anywhere, in the pictures too.
  for (size_t at = 0; at < whole.size(); at += 1 + whole.size() / 61) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 2);
    base::WriteFileAtomically(file, changed);
    // The key is compared by those who know it.
    if (at < 8 || at >= 24) expect_report();
  }
  base::WriteFileAtomically(file, whole);
  EXPECT_NO_THROW(DepthViews::Open(file));
  EXPECT_THROW(DepthViews::Open(folder_ / "nowhere.bin"), base::InputError);
}

TEST_F(RenderViews, ASurveyWithoutPhotosHasNoViews) {
  survey_.survey.photos.clear();
  EXPECT_EQ(Render(survey_).size(), 0U);
  EXPECT_EQ(Render(survey_).size(), 0U);
  survey_.AddPhoto(0, 0, true);  // only a held-out one
  EXPECT_EQ(Render(survey_).size(), 0U);
}

TEST_F(RenderViews, RaysOfLevelPhotosThatMeetNothingAreMarked) {
  for (survey::Photo& photo : survey_.survey.photos) photo.cam_from_enu = LookingLevel({photo.cam_from_enu.OriginInSource().x(), -60.0, 4.0}, 0.0);
  // The roof is seen too badly for a depth, but is not nothing.
  survey_.scene.change = [](const Eigen::Vector3d& x, render::RayColor& color) {
    if (x.z() > 6.0) color.opacity = 0.3F;
  };
  const DepthViews views = Render(survey_);
  ASSERT_GE(views.size(), 8U);
  int64_t n_free = 0, n_unknown = 0;
  const DepthView view = views[0];
  for (size_t i = 0; i < view.depth_m.size(); ++i) {
    const auto width = static_cast<size_t>(view.pose.width);
    const Eigen::Vector3d d = view.pose.DirectionAt(static_cast<double>(i % width) + 0.5, static_cast<double>(i / width) + 0.5);
    const double depth_m = survey_.scene.Depth(view.pose.Centre(), d);
    const bool free = std::isnan(view.depth_m[i]) && view.cosine[i] == kMeetsNothing;
    if (!(depth_m < 1000.0)) {
      EXPECT_TRUE(free) << i << ": what is beyond the scene's box is nothing too";
    } else if (depth_m < 400.0) {
      EXPECT_FALSE(free) << i;
    }
    n_free += free ? 1 : 0;
    n_unknown += std::isnan(view.depth_m[i]) && view.cosine[i] == 0 ? 1 : 0;
  }
  EXPECT_GT(n_free, 100);
  EXPECT_GT(n_unknown, 0);
}

TEST_F(RenderViews, AnEmptySceneGivesViewsWithoutDepth) {
  survey_.input.caster = [](std::span<const render::Ray>, std::span<render::RayColor>) {};
  const DepthViews views = Render(survey_);
  EXPECT_EQ(views.size(), 8U);
  for (size_t v = 0; v < views.size(); ++v) {
    for (const float depth : views[v].depth_m) EXPECT_TRUE(std::isnan(depth));
  }
}

}  // namespace
}  // namespace skyquilt::surface
