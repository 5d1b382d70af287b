#include "surface/refine/refine_views.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "core/base/file.h"
#include "core/base/order_statistics.h"
#include "core/base/progress.h"
#include "core/image/image.h"
#include "surface/refine/neighbours.h"
#include "surface/views/render_depth_views.h"
#include "surface/views/view_files.h"
#include "surface/views/view_poses.h"
#include "tests/support/temporary_folder.h"
#include "tests/surface/views/analytic_survey.h"

namespace skyquilt::surface {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKey = "0123456789abcdef";
constexpr double kWave_m = 1.5;  // of the errors of rendered depths
constexpr int kPhotos = 9;

// Stripes and spots of some metres.
int GreyAt(const Eigen::Vector3d& x) {
  const double value = std::sin(1.1 * x.x() + 0.4 * x.y() + 0.25 * x.z()) + std::sin(0.5 * x.x() - 1.3 * x.y() + 0.35 * x.z()) +
                       0.7 * std::cos(2.3 * x.x() + 1.9 * x.y() - 0.2 * x.z());
  return static_cast<int>(std::lround(128.0 + 40.0 * value));
}

// Photos of a house, of which rendered depths are wrong by about a pixel of disparity.
class Refine : public testing::Test {
 protected:
  Refine() {
    base::Progress::SetQuiet(true);
    for (int i = 0; i < kPhotos; ++i) survey_.AddPhoto(14.0 * (i % 3 - 1), 14.0 * (i / 3 - 1));
    survey_.input.memory_bytes = 1e9;
  }

  // Poses of all photos, with their rendered views in folder/<name>.
  std::vector<ViewPose> Render(const std::string& name) {
    fs::create_directories(folder_ / name);
    std::vector<ViewPose> poses;
    for (const ViewPose& pose : PlacesOfPhotos(survey_.input).training) {
      RenderedView view;
      view.pose = pose;
      for (int y = 0; y < pose.height; ++y) {
        for (int x = 0; x < pose.width; ++x) {
          const double depth = TrueDepth(pose, x, y);
          view.depth_m.push_back(static_cast<float>(depth + kWave_m * std::sin(0.15 * x + pose.photo) * std::cos(0.11 * y)));
          view.cosine.push_back(200);
        }
      }
      SaveView(view, kKey, folder_ / name / ViewFileName(poses.size()));
      poses.push_back(pose);
    }
    return poses;
  }

  double TrueDepth(const ViewPose& pose, int x, int y) const { return survey_.scene.Depth(pose.Centre(), pose.DirectionAt(x + 0.5, y + 0.5)); }

  // Photos with these grey values.
  image::PixelCache Photos(int (*grey)(const Eigen::Vector3d&)) {
    const camera::Camera& camera = survey_.survey.cameras[0];
    std::vector<image::PixelSource> sources;
    for (size_t i = 0; i < survey_.survey.photos.size(); ++i) {
      const geo::Rigid3d& pose = survey_.survey.photos[i].cam_from_enu;
      const Eigen::Vector3d centre = pose.OriginInSource();
      image::Image8 photo(camera.width, camera.height, 3);
      for (int y = 0; y < camera.height; ++y) {
        for (int x = 0; x < camera.width; ++x) {
          const Eigen::Vector3d direction = pose.rotation.conjugate() * camera.RayFromImg({x + 0.5, y + 0.5});
          const int value = grey(centre + survey_.scene.Depth(centre, direction) * direction);
          std::fill_n(photo.At(x, y), 3, static_cast<uint8_t>(value));
        }
      }
      sources.push_back({folder_ / (std::to_string(i) + ".png"), {}});
      image::SavePng(photo, sources.back().photo);
    }
    base::ThreadPool threads(2);
    return image::PixelCache::Open(folder_ / "photos.bin", sources, 0, threads);
  }

  std::vector<fs::path> RefineIn(const std::string& name, std::span<const ViewPose> poses, const image::PixelCache& photos, int n_threads = 2) {
    survey_.input.photos = &photos;
    std::vector<fs::path> files;
    for (size_t i = 0; i < poses.size(); ++i) files.push_back(folder_ / name / ViewFileName(i));
    base::ThreadPool threads(n_threads);
    RefineViews(survey_.input, poses, kKey, folder_ / name, &files, threads);
    return files;
  }

  static std::string All(const std::vector<fs::path>& files) {
    std::string bytes;
    for (const fs::path& file : files) bytes += base::ReadFile(file);
    return bytes;
  }

  TemporaryFolder folder_;
  AnalyticSurvey survey_{folder_.path()};
};

TEST_F(Refine, PhotosCorrectRenderedDepths) {
  const std::vector<ViewPose> poses = Render("a");
  const std::vector<fs::path> files = RefineIn("a", poses, Photos(&GreyAt));
  std::vector<double> before, after;
  size_t full = 0, pixels = 0;
  for (size_t v = 0; v < poses.size(); ++v) {
    const std::optional<RenderedView> view = LoadView(files[v], poses[v], kKey);
    ASSERT_TRUE(view);
    for (int y = 0; y < poses[v].height; ++y) {
      for (int x = 0; x < poses[v].width; ++x) {
        const size_t i = static_cast<size_t>(y) * static_cast<size_t>(poses[v].width) + static_cast<size_t>(x);
        const double depth = TrueDepth(poses[v], x, y), error = std::abs(static_cast<double>(view->depth_m[i]) - depth);
        ++pixels;
        if (view->weight[i] != kConfirmedWeight) continue;
        ++full;
        before.push_back(std::abs(kWave_m * std::sin(0.15 * x + poses[v].photo) * std::cos(0.11 * y)));
        after.push_back(error);
      }
    }
  }
  // The others are at the border of the survey, where no two other photos look, or beside the roof's edge.
  EXPECT_GT(static_cast<double>(full), 0.5 * static_cast<double>(pixels));
  EXPECT_LT(base::Median(after), 0.15 * base::Median(before));
}

TEST_F(Refine, RenderedDepthsStayWherePhotosSayNothing) {
  const std::vector<ViewPose> poses = Render("a");
  std::vector<std::vector<float>> rendered;
  for (size_t v = 0; v < poses.size(); ++v) rendered.push_back(LoadView(folder_ / "a" / ViewFileName(v), poses[v], kKey)->depth_m);
  const std::vector<fs::path> files = RefineIn("a", poses, Photos([](const Eigen::Vector3d&) { return 90; }));
  for (size_t v = 0; v < poses.size(); ++v) {
    const std::optional<RenderedView> view = LoadView(files[v], poses[v], kKey);
    ASSERT_TRUE(view);
    EXPECT_EQ(view->depth_m, rendered[v]);
    EXPECT_EQ(view->cosine, std::vector<uint8_t>(rendered[v].size(), 200));
    for (const uint8_t weight : view->weight) EXPECT_LT(weight, kConfirmedWeight);
  }
}

TEST_F(Refine, IsTheSameForAnyThreadsAndAfterAnInterruption) {
  const image::PixelCache photos = Photos(&GreyAt);
  const std::vector<ViewPose> poses = Render("whole");
  const std::string whole = All(RefineIn("whole", poses, photos, 3));
  EXPECT_FALSE(fs::exists(folder_ / "whole" / "matched"));

  // As a run leaves it that was killed while it compared photos.
  Render("early");
  fs::create_directories(folder_ / "early" / "matched");
  base::WriteFileAtomically(folder_ / "early" / "matched" / ViewFileName(2), "half a file");
  EXPECT_EQ(All(RefineIn("early", poses, photos, 1)), whole);

  // A view that was damaged afterwards is made again, from what is left of the others.
  Render("late");
  const std::vector<fs::path> files = RefineIn("late", poses, photos, 2);
  base::WriteFileAtomically(files[5], "half a file");
  Render("again");
  fs::rename(folder_ / "again" / ViewFileName(5), folder_ / "late" / ViewFileName(5));
  RefineIn("late", poses, photos, 2);
  const std::optional<RenderedView> again = LoadView(files[5], poses[5], kKey);
  ASSERT_TRUE(again);
  EXPECT_GT(std::count(again->weight.begin(), again->weight.end(), kConfirmedWeight), 0.5 * static_cast<double>(again->weight.size()));
}

TEST_F(Refine, APhotoAloneIsLeftAsItIs) {
  const image::PixelCache photos = Photos(&GreyAt);
  const std::vector<ViewPose> poses = {Render("one")[4]};
  fs::rename(folder_ / "one" / ViewFileName(4), folder_ / "one" / ViewFileName(0));
  const std::vector<float> rendered = LoadView(folder_ / "one" / ViewFileName(0), poses[0], kKey)->depth_m;
  const std::vector<fs::path> files = RefineIn("one", poses, photos);
  EXPECT_EQ(LoadView(files[0], poses[0], kKey)->depth_m, rendered);
}

TEST_F(Refine, NeighboursAreThoseWithAUsefulAngle) {
  AnalyticSurvey row(folder_.path());
  // 60 m above the ground: 1, 15 and 40 degrees beside the first, one far away, and one that looks elsewhere.
  for (const double x : {0.0, 1.0, 16.0, 50.0, 400.0}) row.AddPhoto(x, 0.0);
  std::vector<ViewPose> poses = PlacesOfPhotos(row.input).training;
  poses.push_back(poses[2]);
  poses.back().cam_from_enu = LookingLevel(poses[2].Centre(), 0.0);
  RenderedView view;
  view.pose = poses[0];
  view.depth_m.assign(static_cast<size_t>(view.pose.width) * static_cast<size_t>(view.pose.height), 60.0F);
  view.cosine.assign(view.depth_m.size(), 255);
  const std::vector<size_t> found = NeighboursOf(0, view.Get(), poses, 8);
  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0], 2U);
  for (const size_t other : {size_t{0}, size_t{4}, size_t{5}}) EXPECT_EQ(std::count(found.begin(), found.end(), other), 0) << other;
  EXPECT_EQ(NeighboursOf(0, view.Get(), poses, 1), std::vector<size_t>{2});
}

}  // namespace
}  // namespace skyquilt::surface
