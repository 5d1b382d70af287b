#include <gtest/gtest.h>

#include "buildings/pictures/building_pictures.h"
#include "core/base/random.h"
#include "tests/buildings/pictures/made_cameras.h"
#include "tests/buildings/sample_buildings.h"

namespace skyquilt::buildings {
namespace {

const Eigen::Vector3d kTarget(26.0, 34.0, 103.0);

survey::Survey SurveyOf(const std::vector<geo::Rigid3d>& poses) {
  survey::Survey survey;
  survey.cameras.push_back(Pinhole());
  for (const geo::Rigid3d& pose : poses) {
    survey::Photo photo;
    photo.cam_from_enu = pose;
    survey.photos.push_back(photo);
  }
  return survey;
}

TEST(BestPhoto, PrefersThePhotoThatShowsTheWholeBuilding) {
  // The near one is cut: 36 m of image width at 30 m, looking 16 m beside the house.
  const geo::Rigid3d cut = LookingAt({26.0, 4.0, 125.0}, {44.0, 34.0, 103.0}), whole = LookingAt({26.0, -20.0, 150.0}, {20.0, 30.0, 103.0});
  const Building house = MadeHouse({});
  EXPECT_EQ(BestPhoto(house, SurveyOf({cut, whole})), 1);
  EXPECT_EQ(BestPhoto(house, SurveyOf({whole, cut})), 0);
}

TEST(BestPhoto, PrefersObliqueLargeAndCentralViews) {
  const Building house = MadeHouse({});
  const geo::Rigid3d good = LookingAt({26.0, -6.0, 143.0}, kTarget);
  const geo::Rigid3d nadir = LookingDownFrom({26.0, 34.0, 160.0});
  const geo::Rigid3d far = LookingAt({26.0, -106.0, 243.0}, kTarget);
  const geo::Rigid3d aside = LookingAt({26.0, -6.0, 143.0}, {46.0, 44.0, 103.0});
  const geo::Rigid3d away = LookingAt({26.0, -6.0, 143.0}, {26.0, -60.0, 103.0});
  EXPECT_EQ(BestPhoto(house, SurveyOf({nadir, far, aside, away, good})), 4);
  EXPECT_EQ(BestPhoto(house, SurveyOf({good, good})), 0);
}

TEST(BestPhoto, NoneShowsHalfOfTheBuilding) {
  const Building house = MadeHouse({});
  EXPECT_EQ(BestPhoto(house, SurveyOf({})), std::nullopt);
  EXPECT_EQ(BestPhoto(house, SurveyOf({LookingDownFrom({90.0, 34.0, 160.0}), LookingDownFrom({26.0, 34.0, 50.0})})), std::nullopt);
  // 48 m of ground in the image: its east border cuts off more than half of the house, then less.
  EXPECT_EQ(BestPhoto(house, SurveyOf({LookingDownFrom({-1.0, 34.0, 140.0})})), std::nullopt);
  EXPECT_EQ(BestPhoto(house, SurveyOf({LookingDownFrom({7.0, 34.0, 140.0})})), 0);
  EXPECT_EQ(BestPhoto(Building{}, SurveyOf({LookingAt({26.0, -6.0, 143.0}, kTarget)})), std::nullopt);
}

TEST(PartAround, HoldsTheBuildingWithAMarginAndStaysInTheImage) {
  const Building house = MadeTHouse({}, {});
  base::Random random(3);
  int parts = 0, cut = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d at = kTarget + Eigen::Vector3d{random.Uniform(-20, 20), random.Uniform(-20, 20), 0.0};
    const geo::Rigid3d pose = LookingAt(at + Eigen::Vector3d{random.Uniform(-40, 40), -30.0, random.Uniform(20, 60)}, at);
    const camera::Camera camera = i % 2 == 0 ? Pinhole() : Barrel();
    const PhotoPart part = PartAround(house, camera, pose);
    if (part.width == 0) continue;
    ++parts;
    ASSERT_TRUE(part.left >= 0 && part.top >= 0 && part.left + part.width <= camera.width && part.top + part.height <= camera.height);
    for (const Eigen::Vector3d& x : house.lod22.vertex) {
      const auto pixel = camera.ImgFromCam(pose * x);
      if (!pixel || pixel->x() < 0 || pixel->y() < 0 || pixel->x() > camera.width || pixel->y() > camera.height) {
        ++cut;
        continue;
      }
      // A margin of at least 20 pixels unless the image ends there.
      const auto keeps = [](double value, int low, int size, int limit) {
        return value >= (low == 0 ? 0.0 : low + 20.0) && value <= (low + size == limit ? limit : low + size - 20.0);
      };
      EXPECT_TRUE(keeps(pixel->x(), part.left, part.width, camera.width) && keeps(pixel->y(), part.top, part.height, camera.height));
    }
  }
  EXPECT_GT(parts, 100);
  EXPECT_GT(cut, 10);
}

}  // namespace
}  // namespace skyquilt::buildings
