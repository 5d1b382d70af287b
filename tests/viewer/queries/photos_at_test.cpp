#include <gtest/gtest.h>

#include "products/camera_path.h"
#include "tests/viewer/queries/analytic_field.h"

namespace skyquilt::viewer {
namespace {

class PhotosAtTest : public ::testing::Test {
 protected:
  PhotosAtTest() { survey_->cameras.push_back(products::PinholeCamera(1000, 750, 60.0)); }

  int AddPhoto(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
    survey::Photo photo;
    photo.name = std::to_string(survey_->photos.size()) + ".jpg";
    photo.cam_from_enu = products::PoseLookingAt(eye, target);
    survey_->photos.push_back(photo);
    return static_cast<int>(survey_->photos.size()) - 1;
  }
  nlohmann::json Ask(const Eigen::Vector3d& point, const FieldAccess& access) {
    PhotosAtRequest request;
    request.id = 3;
    request.point_enu = point;
    return AnswerOf(*MakePhotosAt(request, survey_), access);
  }
  // Visible, hidden (0, 1) or not in the answer (-1).
  static int Sight(const nlohmann::json& answer, int photo) {
    for (const nlohmann::json& sight : answer["photos"]) {
      if (sight["photo"] == photo) return sight["visible"].get<bool>() ? 1 : 0;
    }
    return -1;
  }

  std::shared_ptr<survey::Survey> survey_ = std::make_shared<survey::Survey>();
};

TEST_F(PhotosAtTest, AWallHidesThePointFromOneSide) {
  const FieldAccess access = AccessTo(FieldOf(GroundAndBoxes({{{2, -20, 0}, {2.3, 20, 10}}})));
  const int west = AddPhoto({-30, 0, 40}, {0, 0, 0}), east = AddPhoto({30, 0, 25}, {0, 0, 0}), above = AddPhoto({0.01, 0, 60}, {0, 0, 0});
  const nlohmann::json answer = Ask({0, 0, 0}, access);
  EXPECT_EQ(answer["id"], 3);
  EXPECT_EQ(answer["checked"], true);
  EXPECT_EQ(Sight(answer, west), 1);
  EXPECT_EQ(Sight(answer, east), 0);
  EXPECT_EQ(Sight(answer, above), 1);
}

// Less than a hundredth of the distance behind the wall.
TEST_F(PhotosAtTest, APointJustBehindAThinWallIsHidden) {
  const FieldAccess access = AccessTo(FieldOf(GroundAndBoxes({{{2, -20, 0}, {2.3, 20, 10}}}), 0.01));
  const int east = AddPhoto({60, 0.01, 5}, {0, 0, 4}), west = AddPhoto({-60, 0.01, 5}, {0, 0, 4});
  const nlohmann::json answer = Ask({2, 0, 4}, access);
  EXPECT_EQ(Sight(answer, east), 0);
  EXPECT_EQ(Sight(answer, west), 1);
}

TEST_F(PhotosAtTest, PointsNeedNotLieExactlyOnTheSurface) {
  const int photo = AddPhoto({0, 0, 50}, {0, 0, 0});
  // GSD 0.058 m.
  const Surface ground = GroundAndBoxes({});
  EXPECT_EQ(Sight(Ask({0, 0, -0.1}, AccessTo(FieldOf(ground))), photo), 1) << "below by less than 3 GSD";
  EXPECT_EQ(Sight(Ask({0, 0, 0.5}, AccessTo(FieldOf(ground))), photo), 1) << "before the surface";
  EXPECT_EQ(Sight(Ask({0, 0, -0.4}, AccessTo(FieldOf(ground))), photo), 0);
  EXPECT_EQ(Sight(Ask({0, 0, -0.4}, AccessTo(FieldOf(ground, 0.2))), photo), 1) << "within the spread of a soft surface";
  EXPECT_EQ(Sight(Ask({0, 0, -3.0}, AccessTo(FieldOf(ground, 5.0))), photo), 0) << "a tree does not make all behind it visible";
}

TEST_F(PhotosAtTest, OnlyPhotosThatShowThePlaceAreListedFinestFirst) {
  const int far = AddPhoto({5, 0, 80}, {5, 0, 0}), near = AddPhoto({0, 0, 40}, {0, 0, 0});
  const int away = AddPhoto({0, 0, 40}, {0, 0, 100}), beside = AddPhoto({60, 0, 40}, {60, 0, 0});
  const nlohmann::json answer = Ask({3, 4, 0}, AccessTo(FieldOf(GroundAndBoxes({}))));
  ASSERT_EQ(answer["photos"].size(), 2U);
  EXPECT_EQ(answer["photos"][0]["photo"], near);
  EXPECT_EQ(answer["photos"][1]["photo"], far);
  EXPECT_EQ(Sight(answer, away), -1);
  EXPECT_EQ(Sight(answer, beside), -1);
  // f = 866.03: the point is 3 m to the right and 4 m up in the picture.
  const double f = 500.0 / std::tan(std::numbers::pi / 6.0);
  EXPECT_NEAR(answer["photos"][0]["pixel"][0].get<double>(), 500.0 + f * 3.0 / 40.0, 1e-3);
  EXPECT_NEAR(answer["photos"][0]["pixel"][1].get<double>(), 375.0 - f * 4.0 / 40.0, 1e-3);
  EXPECT_NEAR(answer["photos"][0]["distance_m"].get<double>(), std::hypot(3.0, 4.0, 40.0), 1e-6);
  EXPECT_NEAR(answer["photos"][1]["gsd_m"].get<double>(), 80.0 / f, 0.01 * 80.0 / f);
}

TEST_F(PhotosAtTest, WithoutAFieldNothingIsChecked) {
  AddPhoto({0, 0, 40}, {0, 0, 0});
  const nlohmann::json answer = Ask({3, 4, 0}, AccessTo({}));
  EXPECT_EQ(answer["checked"], false);
  EXPECT_EQ(answer["photos"][0]["visible"], true);
}

TEST_F(PhotosAtTest, OfThousandsOnlyTheFinestFiveHundredAreTested) {
  for (int i = 0; i < 3000; ++i) AddPhoto({0, 0, 120.0 - 0.03 * i}, {0, 0, 0});
  size_t rays = 0;
  const RayCaster ground = FieldOf(GroundAndBoxes({}));
  const nlohmann::json answer = Ask({0, 0, 0}, AccessTo([&](std::span<const render::Ray> some, std::span<render::RayColor> out) {
                                      rays += some.size();
                                      ground(some, out);
                                    }));
  ASSERT_EQ(answer["photos"].size(), 500U);
  EXPECT_EQ(rays, 500U);
  EXPECT_EQ(answer["photos"][0]["photo"], 2999);
  EXPECT_EQ(answer["photos"][499]["photo"], 2500);
}

TEST_F(PhotosAtTest, ASurveyIsNeededButNotPhotos) {
  EXPECT_TRUE(Ask({0, 0, 0}, AccessTo(FieldOf(GroundAndBoxes({}))))["photos"].empty());
  EXPECT_THROW(MakePhotosAt({}, nullptr), BadMessage);
}

}  // namespace
}  // namespace skyquilt::viewer
