#include "surface/texture/photo_texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/survey/picture_colors.h"
#include "surface/texture/field_light.h"
#include "texture_meshes.h"

namespace skyquilt::surface {
namespace {

constexpr int kPhotoSize = 200;

// A level square of 4 x 4 m that photos show from 10 m above with a pixel of 2.5 cm. Texels of 5 cm.
class PhotoTextureTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const ViewPose pose = testing::PoseAt({2, 2, 10}, -Eigen::Vector3d::UnitZ(), 100, 200.0, 0);
    views_ = {testing::ViewOf(pose, testing::PlaneAtZero)};
    survey::Photo photo;
    photo.cam_from_enu = pose.cam_from_enu;
    survey_.photos = {photo};
    survey_.cameras = {{camera::CameraModel::kPinhole, kPhotoSize, kPhotoSize, {400.0, 400.0, 100.0, 100.0}}};
  }

  void AddPhotoFrom(const Eigen::Vector3d& centre) {
    const ViewPose pose = testing::PoseAt(centre, Eigen::Vector3d(2, 2, 0) - centre, 100, 200.0, static_cast<int>(survey_.photos.size()));
    views_.push_back(testing::ViewOf(pose, testing::PlaneAtZero));
    survey_.photos.push_back(survey_.photos[0]);
    survey_.photos.back().cam_from_enu = pose.cam_from_enu;
  }

  using Grey = std::function<int(size_t photo, int x, int y)>;
  // Colours of photos in a field that has one value everywhere.
  PhotoTexture Paint(const Grey& grey, float field_value = 0.5F, int n_threads = 2) {
    base::ThreadPool threads(n_threads);
    survey::PhotoPictures pictures(
        survey_.photos.size(),
        [&](size_t photo) {
          read_[photo] = true;
          if (photo == unreadable_) throw base::InputError("photo.jpg", "is gone", "Put it back");
          survey::PhotoPicture picture;
          picture.rgb = image::Image8(kPhotoSize, kPhotoSize, 3);
          picture.mask = image::Image8(kPhotoSize, kPhotoSize, 1, 255);
          picture.camera = survey_.cameras[0];
          for (int y = 0; y < kPhotoSize; ++y) {
            for (int x = 0; x < kPhotoSize; ++x) {
              std::fill_n(picture.rgb.At(x, y), 3, static_cast<uint8_t>(grey(photo, x, y)));
              if (masked_ && masked_(x, y)) *picture.mask.At(x, y) = 0;
            }
          }
          return picture;
        },
        size_t{1} << 30);
    std::vector<DepthView> views;
    for (const testing::FilledView& view : views_) views.push_back(view.Get());
    const std::vector<TexelBlock> blocks = ChooseViews(geometry_, layout_, texels_, views, 0.3, threads);
    const TexturePhotos photos(geometry_, layout_, texels_, blocks, views, survey_, pictures, 0.3);
    PhotoTexture texture = photos.Colors(threads);
    TexelColors field;
    field.rgb_srgb.assign(texture.cells.size(), {field_value, field_value, field_value});
    field.known.assign(texture.cells.size(), 1);
    photos.ReplaceStrangers(threads, &texture, &field);
    BringIntoFieldLight(layout_, texels_, field, threads, &texture);
    return texture;
  }

  // The first photo's pixel at a texel.
  Eigen::Vector2d PixelOf(size_t i) const {
    return *survey::PixelIn(survey_.cameras[0], survey_.photos[0].cam_from_enu, texels_.PositionOf(geometry_, i));
  }
  static bool ShowsNothing(const PhotoTexture& texture) {
    return std::all_of(texture.cell.begin(), texture.cell.end(), [](int32_t cell) { return cell == -1; });
  }

  Mesh mesh_ = testing::HeightField(4, 1.0, [](double, double) { return 0.0; });
  TileGeometry geometry_ = GeometryOf(mesh_);
  AtlasLayout layout_ = LayOutAtlas(geometry_, 0.05, 512);
  base::ThreadPool one_thread_{1};
  AtlasTexels texels_ = FindTexels(geometry_, layout_, one_thread_);
  std::vector<testing::FilledView> views_;
  survey::Survey survey_;
  std::function<bool(int x, int y)> masked_;
  size_t unreadable_ = 100;
  std::array<bool, 4> read_ = {};
};

int Stripes(size_t, int x, int) {
  return x % 16 < 8 ? 60 : 180;
}

// An exposure and a vignette of the photo are not those of the texture.
TEST_F(PhotoTextureTest, ConstantAndSlowlyChangingLightIsTheFields) {
  const PhotoTexture constant = Paint([](size_t, int, int) { return 210; });
  for (const auto& rgb : constant.rgb_srgb) ASSERT_NEAR(static_cast<double>(rgb[1]), 0.5, 2e-3);
  const PhotoTexture ramp = Paint([](size_t, int x, int) { return 100 + x / 4; });
  for (const auto& rgb : ramp.rgb_srgb) ASSERT_NEAR(static_cast<double>(rgb[1]), 0.5, 0.04);  // at borders it is compared with one side only
}

// The photo is twice as bright: its stripes keep their ratio in linear light, around the field's mean.
TEST_F(PhotoTextureTest, FineDetailIsThePhotos) {
  const PhotoTexture texture = Paint(Stripes, 0.4F);
  double dark = 0.0, bright = 0.0;
  int n_dark = 0, n_bright = 0;
  for (size_t i = 0; i < texture.cell.size(); ++i) {
    const Eigen::Vector2d pixel = PixelOf(i);
    const double in_stripe = std::fmod(pixel.x(), 16.0);
    if ((pixel.array() < 40.0).any() || (pixel.array() > 160.0).any()) continue;
    const double light = static_cast<double>(survey::QuickLight(texture.rgb_srgb[i][0]));
    if (in_stripe > 2.5 && in_stripe < 5.5) {
      dark += light;
      ++n_dark;
    }
    if (in_stripe > 10.5 && in_stripe < 13.5) {
      bright += light;
      ++n_bright;
    }
  }
  ASSERT_GT(n_dark, 50);
  ASSERT_GT(n_bright, 50);
  const auto light_of = [](int grey) { return static_cast<double>(survey::QuickLight(static_cast<float>(grey) / 255.0F)); };
  EXPECT_NEAR((bright / n_bright) / (dark / n_dark), light_of(180) / light_of(60), 1.5);
  EXPECT_NEAR(0.5 * (bright / n_bright + dark / n_dark), static_cast<double>(survey::QuickLight(0.4F)), 0.02);
}

// Both photos have one half each, in different light: no step remains where they meet.
TEST_F(PhotoTextureTest, PhotosOfDifferentLightMeetWithoutAStep) {
  AddPhotoFrom({2.01, 2, 10});
  for (size_t v = 0; v < 2; ++v) {
    for (size_t i = 0; i < views_[v].depth_m.size(); ++i) {
      if ((i % 100 < 50) == (v == 0)) views_[v].depth_m[i] = std::nanf("");
    }
  }
  const PhotoTexture texture = Paint([](size_t photo, int, int) { return photo == 0 ? 90 : 200; });
  std::array<int, 2> n = {};
  for (size_t i = 0; i < texture.cell.size(); ++i) {
    if (texture.cell[i] < 0) continue;
    ++n[static_cast<size_t>(texture.cells[static_cast<size_t>(texture.cell[i])].view)];
    ASSERT_NEAR(static_cast<double>(texture.rgb_srgb[i][0]), 0.5, 2e-3);
  }
  EXPECT_GT(std::min(n[0], n[1]), 2000);
}

TEST_F(PhotoTextureTest, LeavesMaskedPlacesToOtherPhotosOrTheField) {
  masked_ = [](int x, int) { return x < 100; };
  const PhotoTexture texture = Paint(Stripes);
  for (size_t i = 0; i < texture.cell.size(); ++i) ASSERT_EQ(texture.cell[i] >= 0, PixelOf(i).x() >= 100.0) << i;
}

TEST_F(PhotoTextureTest, NeedsATrainingPhotoThatSeesThePlace) {
  EXPECT_FALSE(ShowsNothing(Paint(Stripes)));
  survey_.photos[0].is_test = true;
  read_ = {};
  EXPECT_TRUE(ShowsNothing(Paint(Stripes)));
  EXPECT_FALSE(read_[0]);
  survey_.photos[0].is_test = false;
  views_[0].pose.photo = -1;
  EXPECT_TRUE(ShowsNothing(Paint(Stripes)));
  views_[0].pose.photo = 7;  // of no survey
  EXPECT_TRUE(ShowsNothing(Paint(Stripes)));
  views_[0].pose.photo = 0;
  std::fill(views_[0].depth_m.begin(), views_[0].depth_m.end(), 5.0F);  // something is in between
  EXPECT_TRUE(ShowsNothing(Paint(Stripes)));
}

TEST_F(PhotoTextureTest, AnUnreadablePhotoIsReplacedByTheNext) {
  AddPhotoFrom({2, 2, 14});
  unreadable_ = 0;
  const PhotoTexture texture = Paint([](size_t, int x, int y) { return (x + y) % 4 < 2 ? 100 : 140; });
  for (const PhotoCell& cell : texture.cells) ASSERT_EQ(cell.view, 1);
  EXPECT_EQ(std::count(texture.cell.begin(), texture.cell.end(), -1), 0);
}

// A white car stood on grey asphalt while the nearer photo was taken.
TEST_F(PhotoTextureTest, WhatMovedIsTakenFromAPhotoWithoutIt) {
  AddPhotoFrom({2, 2, 14});
  const auto with_car = [](size_t photo, int x, int y) {
    if (photo == 0 && x > 70 && x < 130 && y > 60 && y < 140) return 250;
    return (x + y) % 4 < 2 ? 100 : 140;
  };
  const PhotoTexture texture = Paint(with_car, 0.47F);
  std::array<int, 2> inside = {}, outside = {};
  for (size_t i = 0; i < texture.cell.size(); ++i) {
    ASSERT_GE(texture.cell[i], 0);
    const Eigen::Vector2d pixel = PixelOf(i);
    const auto view = static_cast<size_t>(texture.cells[static_cast<size_t>(texture.cell[i])].view);
    if (std::abs(pixel.x() - 100.0) < 22.0 && std::abs(pixel.y() - 100.0) < 32.0) ++inside[view];
    if (std::abs(pixel.x() - 100.0) > 42.0 || std::abs(pixel.y() - 100.0) > 52.0) ++outside[view];
    ASSERT_LT(texture.rgb_srgb[i][0], 0.75F);
  }
  EXPECT_EQ(inside[0], 0);
  EXPECT_GT(inside[1], 300);
  EXPECT_EQ(outside[1], 0);
  EXPECT_GT(outside[0], 1000);
}

// No photo agrees with the field: the field alone.
TEST_F(PhotoTextureTest, WhatAllPhotosShowOtherwiseIsTheFields) {
  const auto car = [](size_t, int x, int y) { return x > 70 && x < 130 && y > 60 && y < 140 ? 250 : 120; };
  const PhotoTexture texture = Paint(car, 0.47F);
  for (size_t i = 0; i < texture.cell.size(); ++i) {
    const Eigen::Vector2d pixel = PixelOf(i);
    if (std::abs(pixel.x() - 100.0) < 22.0 && std::abs(pixel.y() - 100.0) < 32.0) EXPECT_EQ(texture.cell[i], -1);
    if (std::abs(pixel.x() - 100.0) > 42.0 || std::abs(pixel.y() - 100.0) > 52.0) EXPECT_GE(texture.cell[i], 0);
  }
}

TEST_F(PhotoTextureTest, PhotosAtVeryFlatAnglesShowNothing) {
  views_.clear();
  survey_.photos.clear();
  survey::Photo photo;
  survey_.photos.push_back(photo);
  const Eigen::Vector3d centre(2.0 + 10.0 * std::tan(1.36), 2.0, 10.0);  // 78 degrees from the normal
  const ViewPose pose = testing::PoseAt(centre, Eigen::Vector3d(2, 2, 0) - centre, 100, 200.0, 0);
  views_ = {testing::ViewOf(pose, testing::PlaneAtZero)};
  survey_.photos[0].cam_from_enu = pose.cam_from_enu;
  EXPECT_TRUE(ShowsNothing(Paint(Stripes)));
}

// Beside the edge of what hides a place, a photo's pixels show both.
TEST_F(PhotoTextureTest, KeepsAwayFromTheEdgeOfWhatIsNearer) {
  for (size_t i = 0; i < views_[0].depth_m.size(); ++i) {
    if (i % 100 < 50) views_[0].depth_m[i] = 6.0F;
  }
  const PhotoTexture texture = Paint(Stripes);
  for (size_t i = 0; i < texture.cell.size(); ++i) {
    const double x = 0.5 * PixelOf(i).x();  // in the picture of depth
    if (x < 51.0) ASSERT_EQ(texture.cell[i], -1);
    if (x > 51.0) ASSERT_GE(texture.cell[i], 0);
  }
}

TEST_F(PhotoTextureTest, HasTheSameBytesForAnyNumberOfThreads) {
  AddPhotoFrom({3, 1, 9});
  const auto spots = [](size_t photo, int x, int y) { return static_cast<int>((x * 7 + y * 13 + static_cast<int>(photo) * 29) % 200) + 20; };
  const PhotoTexture one = Paint(spots, 0.5F, 1), four = Paint(spots, 0.5F, 4);
  EXPECT_EQ(one.cell, four.cell);
  EXPECT_EQ(one.rgb_srgb, four.rgb_srgb);
}

}  // namespace
}  // namespace skyquilt::surface
