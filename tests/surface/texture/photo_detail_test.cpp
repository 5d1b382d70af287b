#include "surface/texture/photo_detail.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "core/base/progress.h"
#include "core/image/image.h"
#include "texture_meshes.h"

namespace skyquilt::surface {
namespace {

constexpr int kPhotoSize = 200;

// A level square of 4 x 4 m, its colours all 0.5, and a photo of it from 10 m above with a pixel of 2.5 cm. Texels of 5 cm.
class PhotoDetail : public ::testing::Test {
 protected:
  void SetUp() override {
    base::Progress::SetQuiet(true);
    folder_ = std::filesystem::temp_directory_path() / ("skyquilt_detail_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
    mesh_ = testing::HeightField(4, 1.0, [](double, double) { return 0.0; });
    geometry_ = GeometryOf(mesh_);
    texels_ = FindTexels(geometry_, LayOutAtlas(geometry_, 0.05, 512), threads_);
    const ViewPose pose = testing::PoseAt({2, 2, 10}, -Eigen::Vector3d::UnitZ(), 100, 200.0, 0);
    view_ = testing::ViewOf(pose, testing::PlaneAtZero);
    survey::Photo photo;
    photo.cam_from_enu = pose.cam_from_enu;
    survey_.photos = {photo};
    // Twice the size of the photo in the cache, as when training on smaller ones.
    survey_.cameras = {{camera::CameraModel::kPinhole, 2 * kPhotoSize, 2 * kPhotoSize, {800.0, 800.0, 200.0, 200.0}}};
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  // The red values after adding the detail of a grey photo. All photos of the survey have its pixels, and texels take turns among the views.
  std::vector<float> Add(const std::function<int(int x, int y)>& grey, double share, const std::function<bool(int x, int y)>& masked = nullptr) {
    image::Image8 photo(kPhotoSize, kPhotoSize, 3);
    image::Image8 mask(kPhotoSize, kPhotoSize, 1, 255);
    for (int y = 0; y < kPhotoSize; ++y) {
      for (int x = 0; x < kPhotoSize; ++x) {
        std::fill_n(photo.At(x, y), 3, static_cast<uint8_t>(grey(x, y)));
        if (masked && masked(x, y)) *mask.At(x, y) = 0;
      }
    }
    const std::string name = std::to_string(count_++);
    image::SavePng(photo, folder_ / (name + ".png"));
    image::SavePng(mask, folder_ / (name + "_mask.png"));
    const std::vector<image::PixelSource> sources(survey_.photos.size(), {folder_ / (name + ".png"), folder_ / (name + "_mask.png")});
    const auto cache = image::PixelCache::Open(folder_ / (name + ".bin"), sources, 0, threads_);
    TexelColors colors;
    colors.rgb_srgb.assign(texels_.texel.size(), {0.5F, 0.5F, 0.5F});
    colors.known.assign(texels_.texel.size(), 1);
    std::vector<DepthView> views = {view_.Get()};
    for (const testing::FilledView& view : more_views_) views.push_back(view.Get());
    std::vector<int32_t> chosen;
    for (size_t i = 0; i < texels_.texel.size(); ++i) chosen.push_back(static_cast<int32_t>(i % views.size()));
    AddPhotoDetail(geometry_, texels_, chosen, views, survey_, cache, share, 0.05, 0.3, threads_, &colors);
    std::vector<float> red;
    for (const auto& rgb : colors.rgb_srgb) red.push_back(rgb[0]);
    return red;
  }

  // The photo's pixel at a texel.
  Eigen::Vector2d PixelOf(size_t i) const {
    const Eigen::Vector3d x = survey_.photos[0].cam_from_enu * texels_.PositionOf(geometry_, i);
    return Eigen::Vector2d(x.x(), x.y()) / x.z() * 400.0 + Eigen::Vector2d(100.0, 100.0);
  }

  std::filesystem::path folder_;
  int count_ = 0;
  base::ThreadPool threads_{2};
  Mesh mesh_;
  TileGeometry geometry_;
  AtlasTexels texels_;
  testing::FilledView view_;
  std::vector<testing::FilledView> more_views_;
  survey::Survey survey_;
};

// A photo's brightness and slow changes of it stay out: only the field's count.
TEST_F(PhotoDetail, LeavesConstantAndEvenlyGrowingPhotosOut) {
  const std::vector<float> constant = Add([](int, int) { return 200; }, 1.0);
  for (const float value : constant) ASSERT_NEAR(static_cast<double>(value), 0.5, 1e-5);
  const std::vector<float> ramp = Add([](int x, int) { return 20 + x; }, 1.0);
  for (const float value : ramp) ASSERT_NEAR(static_cast<double>(value), 0.5, 1e-4);
}

TEST_F(PhotoDetail, AddsWhatIsFinerThanFourTexels) {
  // A bright line two texels wide in a dark photo.
  const auto line = [](int x, int) { return x >= 98 && x < 102 ? 150 : 100; };
  const std::vector<float> full = Add(line, 1.0);
  const std::vector<float> half = Add(line, 0.5);
  double most = 0.0;
  for (size_t i = 0; i < full.size(); ++i) {
    const double away = std::abs(PixelOf(i).x() - 100.0);
    const double detail = static_cast<double>(full[i]) - 0.5;
    if (away > 7.0) {
      EXPECT_NEAR(detail, 0.0, 1e-5);
    }
    if (away < 1.0) {
      EXPECT_NEAR(detail, 0.5 * 50.0 / 255.0, 0.03);  // half of the window of four texels is bright
    }
    if (away > 3.5 && away < 4.5) {
      EXPECT_LT(detail, -0.02);
    }
    EXPECT_NEAR(static_cast<double>(half[i]) - 0.5, 0.5 * detail, 1e-5);
    most = std::max(most, detail);
  }
  EXPECT_GT(most, 0.07);
}

TEST_F(PhotoDetail, IsLimited) {
  const std::vector<float> values = Add([](int x, int) { return x >= 98 && x < 102 ? 255 : 0; }, 1.0);
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  EXPECT_NEAR(static_cast<double>(*most), 0.75, 1e-5);
  EXPECT_NEAR(static_cast<double>(*least), 0.25, 1e-5);
}

TEST_F(PhotoDetail, LeavesMaskedPlacesOut) {
  const auto stripes = [](int x, int) { return x % 4 < 2 ? 50 : 200; };
  const std::vector<float> values = Add(stripes, 1.0, [](int x, int) { return x < 100; });
  bool changed = false;
  for (size_t i = 0; i < values.size(); ++i) {
    if (PixelOf(i).x() < 100.0) {
      EXPECT_EQ(values[i], 0.5F);
    }
    changed = changed || values[i] != 0.5F;
  }
  EXPECT_TRUE(changed);
}

TEST_F(PhotoDetail, NeedsATrainingPhotoThatSeesThePlace) {
  const auto stripes = [](int x, int) { return x % 4 < 2 ? 50 : 200; };
  const auto is_unchanged = [&] {
    const std::vector<float> values = Add(stripes, 1.0);
    return std::all_of(values.begin(), values.end(), [](float value) { return value == 0.5F; });
  };
  EXPECT_FALSE(is_unchanged());
  survey_.photos[0].is_test = true;
  EXPECT_TRUE(is_unchanged());
  survey_.photos[0].is_test = false;
  view_.pose.photo = -1;
  EXPECT_TRUE(is_unchanged());
  view_.pose.photo = 7;  // of no survey
  EXPECT_TRUE(is_unchanged());
  view_.pose.photo = 0;
  std::fill(view_.depth_m.begin(), view_.depth_m.end(), 5.0F);  // something is in between
  EXPECT_TRUE(is_unchanged());
}

TEST_F(PhotoDetail, ReadsAllPhotosButTheHeldOutOnes) {
  survey_.photos.push_back(survey_.photos[0]);
  more_views_ = {view_};
  more_views_[0].pose.photo = 1;
  const auto stripes = [](int x, int) { return x % 4 < 2 ? 50 : 200; };
  // Whether texels of each of the two photos have changed.
  const auto changed = [&] {
    const std::vector<float> values = Add(stripes, 1.0);
    std::array<bool, 2> any = {};
    for (size_t i = 0; i < values.size(); ++i) any[i % 2] = any[i % 2] || values[i] != 0.5F;
    return any;
  };
  EXPECT_EQ(changed(), (std::array<bool, 2>{true, true}));
  survey_.photos[1].is_test = true;
  EXPECT_EQ(changed(), (std::array<bool, 2>{true, false}));
}

TEST_F(PhotoDetail, NothingIsAddedAtFlatAngles) {
  // 70 degrees from the normal.
  const Eigen::Vector3d centre(2.0 + 10.0 * std::tan(1.22), 2.0, 10.0);
  const ViewPose pose = testing::PoseAt(centre, Eigen::Vector3d(2, 2, 0) - centre, 100, 200.0, 0);
  view_ = testing::ViewOf(pose, testing::PlaneAtZero);
  survey_.photos[0].cam_from_enu = pose.cam_from_enu;
  for (const float value : Add([](int, int y) { return y % 4 < 2 ? 50 : 200; }, 1.0)) ASSERT_EQ(value, 0.5F);
}

}  // namespace
}  // namespace skyquilt::surface
