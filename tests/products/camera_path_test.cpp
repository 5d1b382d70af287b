#include "products/camera_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "core/base/errors.h"
#include "tests/products/analytic_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::products {
namespace {

Eigen::Vector3d Forward(const geo::Rigid3d& pose) {
  return pose.rotation.conjugate() * Eigen::Vector3d(0, 0, 1);
}
Eigen::Vector3d Right(const geo::Rigid3d& pose) {
  return pose.rotation.conjugate() * Eigen::Vector3d(1, 0, 0);
}
Eigen::Vector3d Down(const geo::Rigid3d& pose) {
  return pose.rotation.conjugate() * Eigen::Vector3d(0, 1, 0);
}

TEST(PinholeCamera, FieldOfViewAcrossTheHeightFollowsFromThatAcrossTheWidth) {
  for (const auto& [width, height] : {std::pair{640, 360}, {300, 300}, {90, 160}}) {
    const camera::Camera camera = PinholeCamera(width, height, FovAcrossWidth(50.0, width, height));
    EXPECT_NEAR(2.0 * std::atan(0.5 * height / camera.FocalY()), 50.0 * std::numbers::pi / 180.0, 1e-12);
  }
}

TEST(PoseFromAngles, FollowsTheCompass) {
  const Eigen::Vector3d eye(10, 20, 30);
  EXPECT_TRUE(PoseFromAngles(eye, 33, -40, 12).OriginInSource().isApprox(eye, 1e-12));
  EXPECT_TRUE(Forward(PoseFromAngles(eye, 0, 0, 0)).isApprox(Eigen::Vector3d(0, 1, 0), 1e-12)) << "north";
  EXPECT_TRUE(Forward(PoseFromAngles(eye, 90, 0, 0)).isApprox(Eigen::Vector3d(1, 0, 0), 1e-12)) << "east";
  EXPECT_TRUE(Forward(PoseFromAngles(eye, 0, -90, 0)).isApprox(Eigen::Vector3d(0, 0, -1), 1e-12)) << "nadir";
  EXPECT_TRUE(Down(PoseFromAngles(eye, 70, 0, 0)).isApprox(Eigen::Vector3d(0, 0, -1), 1e-12)) << "level";
  EXPECT_TRUE(Right(PoseFromAngles(eye, 0, -90, 0)).isApprox(Eigen::Vector3d(1, 0, 0), 1e-12)) << "north is up in a nadir view";
  EXPECT_LT(Right(PoseFromAngles(eye, 0, 0, 20)).z(), -0.3) << "right side down";
}

TEST(PoseLookingAt, PutsTheTargetOnTheAxis) {
  const Eigen::Vector3d eye(1, 2, 50);
  for (const Eigen::Vector3d& target : {Eigen::Vector3d(10, 30, 0), Eigen::Vector3d(-40, 2, 60), Eigen::Vector3d(1, 2, 0)}) {
    const Eigen::Vector3d seen = PoseLookingAt(eye, target) * target;
    EXPECT_NEAR(seen.x(), 0.0, 1e-9);
    EXPECT_NEAR(seen.y(), 0.0, 1e-9);
    EXPECT_GT(seen.z(), 0.0);
  }
}

TEST(PathAlongCameras, FollowsTrainingPhotosInTheirOrder) {
  survey::Survey survey;
  for (int i = 0; i < 21; ++i) {
    survey::Photo photo;
    const Eigen::Vector3d eye(i < 20 ? 20.0 - i : 500.0, 0.0, 2.0);
    photo.cam_from_enu = PoseFromAngles(eye, 0.0, 5.0, i % 2 == 0 ? 0.0 : 90.0);
    photo.time_s = 20.0 - i;
    photo.is_test = i == 20;
    survey.photos.push_back(photo);
  }
  ProductOptions options;
  options.video_seconds = 5.0;
  options.video_fps = 12;
  const std::vector<View> views = PathAlongCameras(survey, options);
  ASSERT_EQ(views.size(), 60U);
  EXPECT_TRUE(views.front().cam_from_enu.OriginInSource().isApprox(Eigen::Vector3d(1, 0, 2), 1e-9)) << "the first that was taken";
  EXPECT_TRUE(views.back().cam_from_enu.OriginInSource().isApprox(Eigen::Vector3d(20, 0, 2), 1e-9));
  for (size_t i = 0; i < views.size(); ++i) {
    const Eigen::Vector3d eye = views[i].cam_from_enu.OriginInSource();
    EXPECT_NEAR(eye.y(), 0.0, 1e-9);
    if (i > 0) EXPECT_GT(eye.x(), views[i - 1].cam_from_enu.OriginInSource().x());
    EXPECT_TRUE(views[i].cam_from_enu.rotation.isApprox(PoseFromAngles(eye, 0.0, 5.0, 0.0).rotation, 1e-6)) << "level, whatever the photos' roll";
  }
  survey.photos.resize(1);
  EXPECT_EQ(PathAlongCameras(survey, options).size(), 60U) << "one photo";
}

TEST(BuiltInPath, StaysAboveTheRoofsAndLooksAtTheScene) {
  const AnalyticScene scene;
  const scene::SceneInfo info = scene.Info({41.0, 2.0, 0.0}, true);
  for (const char* path : {"orbit", "flyover"}) {
    ProductOptions options;
    options.video_path = path;
    const std::vector<View> views = BuiltInPath(info, options);
    EXPECT_EQ(views.size(), 60U);
    for (const View& view : views) {
      EXPECT_GT(view.cam_from_enu.OriginInSource().z(), info.max_enu.z());
      EXPECT_LT(Forward(view.cam_from_enu).z(), -0.5);
      const Eigen::Vector3d eye = view.cam_from_enu.OriginInSource();
      const Eigen::Vector3d ahead = Forward(view.cam_from_enu);
      const Eigen::Vector3d hit = eye + ahead * ((scene.ground_z - eye.z()) / ahead.z());
      EXPECT_TRUE((hit.head<2>().array() > info.min_enu.head<2>().array()).all() && (hit.head<2>().array() < info.max_enu.head<2>().array()).all())
          << path << " " << view.name << " looks at " << hit.transpose();
    }
  }
}

TEST(ViewsOfPhotos, KeepTheLensAndFindNames) {
  survey::Survey survey;
  camera::Camera camera;
  camera.model = camera::CameraModel::kSimpleRadial;
  camera.width = 4000;
  camera.height = 3000;
  camera.params = {3000.0, 2000.0, 1500.0, -0.01};
  survey.cameras.push_back(camera);
  for (const char* name : {"a/one.jpg", "a/two.jpg", "b/two.jpg", "two.png"}) {
    survey::Photo photo;
    photo.name = name;
    photo.is_test = photo.name == "a/two.jpg";
    survey.photos.push_back(photo);
  }
  const std::vector<View> held_out = ViewsOfPhotos(survey, {}, 400);
  ASSERT_EQ(held_out.size(), 1U);
  EXPECT_EQ(held_out[0].name, "a_two");
  EXPECT_EQ(held_out[0].camera.width, 400);
  EXPECT_EQ(held_out[0].camera.height, 300);
  EXPECT_NEAR(held_out[0].camera.FocalX(), 300.0, 1e-9);
  EXPECT_EQ(ViewsOfPhotos(survey, {"one.jpg"}, 0)[0].camera.width, 4000);
  survey.photos[3].name = "a_two.png";
  const std::vector<View> clash = ViewsOfPhotos(survey, {"a/two.jpg", "a_two.png"}, 0);
  EXPECT_NE(clash[0].name, clash[1].name);
  EXPECT_THROW(ViewsOfPhotos(survey, {"three.jpg"}, 0), base::UsageError);
  EXPECT_THROW(ViewsOfPhotos(survey, {}, -1), base::UsageError);
  survey.photos[1].is_test = false;
  EXPECT_THROW(ViewsOfPhotos(survey, {}, 0), base::UsageError);
}

class CameraPathFile : public testing::Test {
 protected:
  std::vector<View> Load(const std::string& text, bool georeferenced = true) {
    const std::filesystem::path file = folder_.path() / "path.json";
    std::ofstream(file) << text;
    return LoadCameraPath(file, AnalyticScene{}.Info({41.0, 2.0, 100.0}, georeferenced), 320, 180);
  }
  TemporaryFolder folder_;
};

TEST_F(CameraPathFile, ReadsBothKindsOfPlaces) {
  const std::vector<View> views = Load(R"([{"position_enu": [1, 2, 3], "yaw": 90, "pitch": -30, "fov": 90, "name": "east"},
                                          {"longitude": 2.0, "latitude": 41.0, "height": 180.0, "pitch": -90}])");
  ASSERT_EQ(views.size(), 2U);
  EXPECT_EQ(views[0].name, "east");
  EXPECT_TRUE(views[0].cam_from_enu.OriginInSource().isApprox(Eigen::Vector3d(1, 2, 3), 1e-12));
  EXPECT_NEAR(views[0].camera.FocalX(), 160.0, 1e-9);
  EXPECT_EQ(views[0].camera.height, 180);
  EXPECT_TRUE(views[1].cam_from_enu.OriginInSource().isApprox(Eigen::Vector3d(0, 0, 80), 1e-6));
}

TEST_F(CameraPathFile, InterpolatesThroughItsKeys) {
  const std::vector<View> views = Load(R"({"frames_between": 4, "views": [{"position_enu": [0, 0, 50]}, {"position_enu": [10, 0, 50], "yaw": 90},
                                           {"position_enu": [20, 10, 60], "yaw": 90, "fov": 40}]})");
  ASSERT_EQ(views.size(), 11U);
  EXPECT_TRUE(views[5].cam_from_enu.OriginInSource().isApprox(Eigen::Vector3d(10, 0, 50), 1e-9));
  EXPECT_TRUE(views[10].cam_from_enu.OriginInSource().isApprox(Eigen::Vector3d(20, 10, 60), 1e-9));
  for (size_t i = 1; i < views.size(); ++i) {
    const double step = (views[i].cam_from_enu.OriginInSource() - views[i - 1].cam_from_enu.OriginInSource()).norm();
    EXPECT_GT(step, 0.3);
    EXPECT_LT(step, 6.0);
  }
  const Eigen::Vector3d between = Forward(views[2].cam_from_enu);
  EXPECT_GT(between.x(), 0.3);
  EXPECT_GT(between.y(), 0.3);
}

TEST_F(CameraPathFile, ComplaintsNameTheEntry) {
  for (const char* text : {"", "{}", "[]", "[1]", R"([{"yaw": 3}])", R"([{"position_enu": [1, 2]}])", R"([{"position_enu": [1, 2, "3"]}])",
                           R"([{"position_enu": [1, 2, 3], "fov": 180}])", R"([{"position_enu": [1, 2, 3], "pich": 3}])",
                           R"([{"longitude": 2, "latitude": 95, "height": 3}])", R"([{"position_enu": [1, 2, 3], "name": "../x"}])",
                           R"([{"position_enu": [1, 2, 3], "name": "x"}, {"position_enu": [1, 2, 3], "name": "x"}])",
                           R"({"views": [{"position_enu": [1, 2, 3]}], "frames_between": -1})"}) {
    EXPECT_THROW(Load(text), base::InputError) << text;
  }
  EXPECT_THROW(Load(R"([{"longitude": 2, "latitude": 41, "height": 3}])", false), base::InputError);
  const std::string error = InputErrorOf([&] { Load(R"([{"position_enu": [1, 2, 3]}, {"position_enu": [1, 2, 3], "pich": 3}])"); });
  EXPECT_NE(error.find("view 1"), std::string::npos) << error;
  EXPECT_NE(error.find("\"pitch\"?"), std::string::npos) << error;
}

}  // namespace
}  // namespace skyquilt::products
