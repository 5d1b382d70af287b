#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "core/image/image.h"
#include "products/camera_path.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"
#include "tests/viewer/queries/analytic_field.h"
#include "viewer/queries/mean_map.h"

namespace skyquilt::viewer {
namespace {

// Level ground, shown in one grey; photos look straight down from 40 m and show 40 x 30 m.
class ErrorMapTest : public ::testing::Test {
 protected:
  ErrorMapTest() {
    survey_->photo_root = folder_.path();
    survey_->cameras.push_back({.model = camera::CameraModel::kSimplePinhole, .width = 400, .height = 300, .params = {400.0, 200.0, 150.0}});
  }

  void AddPhoto(double x, double y, uint8_t grey, bool is_test = true, bool write = true) {
    survey::Photo photo;
    photo.name = "photo" + std::to_string(survey_->photos.size()) + ".png";
    photo.cam_from_enu = products::PoseLookingAt({x, y, 40}, {x, y, 0});
    photo.is_test = is_test;
    survey_->photos.push_back(photo);
    if (write) image::SavePng(image::Image8(400, 300, 3, grey), folder_ / photo.name);
  }
  // Masks out the right half of the last photo.
  void MaskLastPhoto() {
    image::Image8 mask(400, 300, 1, 255);
    for (int y = 0; y < 300; ++y) std::fill_n(mask.At(200, y), 200, uint8_t{0});
    image::SavePng(mask, folder_ / "mask.png");
    survey_->photos.back().mask = (folder_ / "mask.png").string();
  }
  nlohmann::json Ask() {
    FieldAccess access = AccessTo({});
    const RayCaster ground = FieldOf(GroundAndBoxes({}));
    const PhotoCaster caster = [&](int photo, std::span<const render::Ray> rays, std::span<render::RayColor> out) {
      EXPECT_TRUE(survey_->photos[static_cast<size_t>(photo)].is_test);
      EXPECT_LE(rays.size(), access.batch);
      rays_ += rays.size();
      ground(rays, out);
      for (render::RayColor& color : out) std::fill_n(color.rgb_srgb, 3, 100.0F / 255.0F + gain_ * static_cast<float>(photo));
    };
    const auto query = MakeErrorMap({.id = 9}, survey_, caster, [&](std::string png) {
      png_ = std::move(png);
      return std::string("pictures/1.png");
    });
    return AnswerOf(*query, access);
  }
  cv::Mat Picture() const { return cv::imdecode(std::vector<uint8_t>(png_.begin(), png_.end()), cv::IMREAD_UNCHANGED); }
  // Colour of a place, BGRA.
  static cv::Vec4b At(const cv::Mat& picture, double x, double y) {
    const double cell = 200.0 / picture.cols;
    return picture.at<cv::Vec4b>(picture.rows - 1 - static_cast<int>((y + 100.0) / cell), static_cast<int>((x + 100.0) / cell));
  }

  TemporaryFolder folder_;
  std::shared_ptr<survey::Survey> survey_ = std::make_shared<survey::Survey>();
  float gain_ = 0.0F;
  size_t rays_ = 0;
  std::string png_;
};

TEST_F(ErrorMapTest, ShowsTheErrorWhereThePhotosWereTaken) {
  AddPhoto(0, 0, 250, false);
  AddPhoto(-50, 60, 112);
  AddPhoto(50, -40, 151);
  const nlohmann::json answer = Ask();
  EXPECT_EQ(answer["type"], "error_map");
  EXPECT_EQ(answer["id"], 9);
  EXPECT_EQ(answer["url"], "pictures/1.png");
  EXPECT_EQ(answer["photos"], 2);
  EXPECT_EQ(answer["of_photos"], 2);
  EXPECT_EQ(answer["min"], nlohmann::json({-100.0, -100.0}));
  EXPECT_NEAR(answer["max"][0].get<double>(), 100.0, 1e-9);
  // The photo of 51 levels of error covers half of all cells with data.
  EXPECT_NEAR(answer["scale"].get<double>(), 51.0 / 255.0, 1e-3);
  const cv::Mat picture = Picture();
  ASSERT_EQ(picture.channels(), 4);
  ASSERT_EQ(picture.cols, 512);
  EXPECT_EQ(At(picture, 0, 0)[3], 0) << "photos that were trained on do not count";
  EXPECT_EQ(At(picture, 50, 60)[3], 0);
  // Corners of the photos' ground, north at the top.
  for (const double dx : {-19.0, 19.0}) {
    for (const double dy : {-14.0, 14.0}) {
      EXPECT_EQ(At(picture, -50 + dx, 60 + dy)[3], 255);
      EXPECT_EQ(At(picture, 50 + dx, -40 + dy)[3], 255);
    }
  }
  EXPECT_EQ(At(picture, -50, 60 + 16)[3], 0);
  EXPECT_EQ(At(picture, -50 - 21, 60)[3], 0);
  const image::Image8 ramp = image::Colorize(
      [] {
        image::ImageF values(2, 1, 1);
        values.data = {12.0F / 51.0F, 1.0F};
        return values;
      }(),
      0.0F, 1.0F);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(At(picture, -50, 60)[c], ramp.At(0, 0)[2 - c], 2);
    EXPECT_NEAR(At(picture, 50, -40)[c], ramp.At(1, 0)[2 - c], 2);
  }
}

TEST_F(ErrorMapTest, PhotosAreSmallAndMasksAreLeftOut) {
  AddPhoto(0, 0, 100);
  MaskLastPhoto();
  EXPECT_EQ(Ask()["scale"], 0.02) << "at least";
  EXPECT_EQ(rays_, 125U * 188U);
  // North is up in the photo, so its right half is in the east.
  EXPECT_EQ(At(Picture(), -10, 0)[3], 255);
  EXPECT_EQ(At(Picture(), 10, 0)[3], 0);
}

TEST_F(ErrorMapTest, EachPhotoIsShownWithItsOwnBrightness) {
  gain_ = 10.0F / 255.0F;
  for (int i = 0; i < 3; ++i) AddPhoto(60.0 * i - 60.0, 0, static_cast<uint8_t>(100 + 10 * i));
  EXPECT_EQ(Ask()["scale"], 0.02);
}

TEST_F(ErrorMapTest, MissingPhotosAreLeftOutUnlessAllAre) {
  AddPhoto(0, 0, 120);
  AddPhoto(50, 0, 120, true, false);
  AddPhoto(-50, 0, 120, true, false);
  std::ofstream(folder_ / "photo2.png") << "no picture";
  const nlohmann::json answer = Ask();
  EXPECT_EQ(answer["photos"], 1);
  EXPECT_EQ(answer["of_photos"], 3);
  std::filesystem::remove(folder_ / "photo0.png");
  const std::string error = ErrorOf<BadMessage>([&] { Ask(); });
  EXPECT_NE(error.find("none of the 3 held-out photos can be read: photo0.png"), std::string::npos) << error;
  EXPECT_EQ(error.find(folder_.path().string()), std::string::npos) << "folders are nobody's business";
}

TEST_F(ErrorMapTest, NeedsHeldOutPhotosASurveyAndAField) {
  AddPhoto(0, 0, 120, false);
  EXPECT_THROW(Ask(), BadMessage);
  const PhotoCaster caster = [](int, std::span<const render::Ray>, std::span<render::RayColor>) {};
  const PublishPicture publish = [](const std::string&) { return std::string(); };
  EXPECT_THROW(MakeErrorMap({}, nullptr, caster, publish), BadMessage);
  EXPECT_THROW(MakeErrorMap({}, survey_, {}, publish), BadMessage);
}

TEST_F(ErrorMapTest, AtMostTwoHundredPhotosAreTaken) {
  survey_->cameras[0] = survey_->cameras[0].Resized(4, 3);
  for (int i = 0; i < 450; ++i) AddPhoto(0.2 * i - 45.0, 0, 110, true, false);
  for (const survey::Photo& photo : survey_->photos) image::SavePng(image::Image8(4, 3, 3, 110), folder_ / photo.name);
  const nlohmann::json answer = Ask();
  EXPECT_EQ(answer["photos"], 200);
  EXPECT_EQ(answer["of_photos"], 450);
  EXPECT_EQ(rays_, 200U * 12U);
  // From the first to the last: pixels are 10 m wide, so that the outermost ones are 15 m beside the photos 1 and 448.
  EXPECT_EQ(At(Picture(), -44.8 - 15.0, 10)[3], 255);
  EXPECT_EQ(At(Picture(), 44.6 + 15.0, 10)[3], 255);
}

TEST_F(ErrorMapTest, CanBeGivenUpAtAnyTime) {
  for (int i = 0; i < 4; ++i) AddPhoto(0, 0, 120);
  const FieldAccess access = AccessTo({});
  for (int steps = 0; steps < 6; ++steps) {
    const auto query = MakeErrorMap(
        {}, survey_, [](int, std::span<const render::Ray>, std::span<render::RayColor>) {}, [](const std::string&) { return std::string(); });
    for (int i = 0; i < steps; ++i) query->Step(access);
  }
}

TEST(MeanMap, AveragesAndIgnoresWhatIsOutside) {
  MeanMap map({0, 0}, {10, 5}, 1.0);
  EXPECT_EQ(map.grid().columns, 10);
  EXPECT_EQ(map.grid().rows, 5);
  EXPECT_TRUE(map.Empty());
  for (const Eigen::Vector2d& place : {Eigen::Vector2d(-0.1, 1), Eigen::Vector2d(10.1, 1), Eigen::Vector2d(1, 5.1), Eigen::Vector2d(std::nan(""), 1)})
    map.Add(place, 1.0);
  EXPECT_TRUE(map.Empty());
  map.Add({0.5, 0.5}, 1.0);
  map.Add({0.6, 0.4}, 3.0);
  EXPECT_EQ(map.Quantile(1.0), 2.0);
  for (int i = 1; i < 10; ++i) map.Add({i + 0.5, 0.5}, 0.1 * i);
  EXPECT_EQ(map.Quantile(0.9), 0.9);
  EXPECT_EQ(map.Quantile(0.95), 2.0);
}

TEST(EncodePng, KeepsAllChannels) {
  for (const int channels : {1, 3, 4}) {
    for (const int level : {image::kFastPng, 1, 9}) {
      image::Image8 picture(7, 5, channels);
      for (size_t i = 0; i < picture.data.size(); ++i) picture.data[i] = static_cast<uint8_t>(i * 37);
      const std::string png = image::EncodePng(picture, level);
      const cv::Mat back = cv::imdecode(std::vector<uint8_t>(png.begin(), png.end()), cv::IMREAD_UNCHANGED);
      ASSERT_EQ(back.channels(), channels);
      for (int c = 0; c < channels; ++c) {
        const int stored = channels > 1 && c < 3 ? 2 - c : c;
        EXPECT_EQ(back.ptr(3)[2 * channels + stored], picture.At(2, 3)[c]);
      }
    }
  }
  EXPECT_THROW(image::EncodePng(image::Image8(7, 5, 2), 1), std::logic_error);
  EXPECT_THROW(image::EncodePng(image::Image8(), 1), std::logic_error);
}

}  // namespace
}  // namespace skyquilt::viewer
