// Every format's conventions of axes and pixels, against formulas of its own documentation (made_models.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/base/json_text.h"
#include "core/geo/ecef.h"
#include "core/geo/enu_frame.h"
#include "core/geo/geoid.h"
#include "core/geo/utm.h"
#include "core/image/image.h"
#include "prepare/models/read_model.h"
#include "tests/prepare/models/made_models.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare::models {
namespace {

using Eigen::Vector3d;
using test::MadeModel;

using Project = Eigen::Vector2d (*)(const test::MadeLens&, const test::MadePhoto&, const Vector3d&);

class Conventions : public ::testing::Test {
 protected:
  void WritePhotos() {
    const image::Image8 pixels(survey_.lens.width, survey_.lens.height, 3, 90);
    for (const test::MadePhoto& photo : survey_.photos) {
      image::SavePng(pixels, folder_ / photo.name);
      names_.push_back(photo.name);
    }
  }
  InputModel Read(const test::Files& files, const std::string& name = "") {
    WritePhotos();
    test::WriteFiles(files, folder_.path());
    return ReadModel(name.empty() ? folder_.path() : folder_ / name, ModelPhotos(folder_.path(), names_));
  }
  // survey_from_model maps the model's frame to the survey's.
  void Expect(const InputModel& model, Project project, const geo::Similarity3d& survey_from_model = {}) {
    ASSERT_EQ(model.sfm.images.size(), survey_.photos.size());
    for (const survey::ColmapImage& image : model.sfm.images) {
      const auto photo =
          std::find_if(survey_.photos.begin(), survey_.photos.end(), [&](const test::MadePhoto& made) { return made.name == image.name; });
      ASSERT_NE(photo, survey_.photos.end()) << image.name;
      const Vector3d centre = survey_from_model * image.cam_from_world.OriginInSource();
      EXPECT_LT((centre - photo->centre).norm(), 1e-6) << image.name;
      const Vector3d view = survey_from_model.rotation * (image.cam_from_world.rotation.conjugate() * Vector3d::UnitZ());
      EXPECT_LT((view - photo->axes.col(2)).norm(), 1e-9) << image.name;
      for (const Vector3d& x : survey_.points) {
        const Vector3d x_in_model = survey_from_model.rotation.conjugate() * (x - survey_from_model.translation) / survey_from_model.scale;
        const auto pixel = model.sfm.cameras.at(image.camera_id).ImgFromCam(image.cam_from_world * x_in_model);
        ASSERT_TRUE(pixel.has_value());
        const Eigen::Vector2d expected = project(survey_.lens, *photo, x);
        EXPECT_LT((*pixel - expected).norm(), 0.01) << image.name << " " << pixel->transpose() << ", expected " << expected.transpose();
      }
    }
  }
  void ExpectPoints(const InputModel& model, size_t n_photos) {
    ASSERT_EQ(model.sfm.points.size(), survey_.points.size());
    for (size_t i = 0; i < survey_.points.size(); ++i) {
      EXPECT_LT((model.sfm.points[i].x_in_world - survey_.points[i]).norm(), 1e-5);
      EXPECT_EQ(model.sfm.points[i].rgb, (std::array<uint8_t, 3>{10, 20, 30}));
      EXPECT_EQ(model.sfm.points[i].image_ids.size(), n_photos);
    }
  }
  // Where the model's own place puts the cameras.
  void ExpectPlace(const InputModel& model, const std::function<geo::Geodetic(const Vector3d&)>& geodetic, double tolerance_m) {
    ASSERT_TRUE(model.place.has_value());
    const geo::EnuFrame frame(model.place->origin);
    for (const survey::ColmapImage& image : model.sfm.images) {
      const auto photo =
          std::find_if(survey_.photos.begin(), survey_.photos.end(), [&](const test::MadePhoto& made) { return made.name == image.name; });
      const geo::Geodetic position = frame.GeodeticFromEnu(model.place->enu_from_model * image.cam_from_world.OriginInSource());
      EXPECT_LT((geo::EcefFromGeodetic(position) - geo::EcefFromGeodetic(geodetic(photo->centre))).norm(), tolerance_m) << image.name;
    }
  }

  TemporaryFolder folder_;
  MadeModel survey_ = test::MakeModel();
  std::vector<std::string> names_;
};

TEST_F(Conventions, Transforms) {
  const InputModel model = Read(test::TransformsFiles(survey_));
  EXPECT_EQ(model.format, ModelFormat::kTransforms);
  Expect(model, test::ProjectTransforms);
  ExpectPoints(model, 0);
  EXPECT_EQ(model.sfm.cameras.size(), 1U);
  EXPECT_FALSE(model.place.has_value());
  EXPECT_TRUE(model.test_photos.empty());
}

TEST_F(Conventions, BlenderWithSplit) {
  const InputModel model = Read(test::BlenderFiles(survey_));
  EXPECT_EQ(model.format, ModelFormat::kTransforms);
  Expect(model, test::ProjectBlender);
  EXPECT_TRUE(model.sfm.points.empty());
  EXPECT_EQ(model.test_photos, (std::set<std::string>{survey_.photos.back().name}));
}

TEST_F(Conventions, Opensfm) {
  const InputModel model = Read(test::OpensfmFiles(survey_));
  EXPECT_EQ(model.format, ModelFormat::kOpensfm);
  Expect(model, test::ProjectOpensfm);
  ExpectPoints(model, survey_.photos.size());
  const geo::EnuFrame frame(test::kModelOrigin);
  ExpectPlace(
      model, [&](const Vector3d& x) { return frame.GeodeticFromEnu(x); }, 1e-6);
}

TEST_F(Conventions, OpensfmOfReducedPhotosFitsTheWholeOnes) {
  test::Files files = test::OpensfmFiles(survey_);
  nlohmann::json file = base::ParseJson(files["reconstruction.json"]);
  file[0]["cameras"]["v2 made"]["width"] = 160;
  file[0]["cameras"]["v2 made"]["height"] = 120;
  files["reconstruction.json"] = base::JsonText(file);
  Expect(Read(files, "reconstruction.json"), test::ProjectOpensfm);
}

TEST_F(Conventions, Metashape) {
  const InputModel model = Read(test::MetashapeFiles(survey_));
  EXPECT_EQ(model.format, ModelFormat::kMetashape);
  Expect(model, test::ProjectMetashape, {10.0, Eigen::Quaterniond(test::MetashapeTurn()), Vector3d::Zero()});
  const geo::EnuFrame frame(test::kModelOrigin);
  ExpectPlace(
      model, [&](const Vector3d& x) { return frame.GeodeticFromEnu(x); }, 1e-6);
}

TEST_F(Conventions, Opf) {
  const InputModel model = Read(test::OpfFiles(survey_));
  EXPECT_EQ(model.format, ModelFormat::kOpf);
  Expect(model, test::ProjectOpf);
  ExpectPoints(model, survey_.photos.size());
  // The place is the similarity nearest to the map projection.
  ExpectPlace(
      model,
      [](const Vector3d& x) {
        const Vector3d utm = x - test::kOpfShift;
        return geo::GeodeticFromUtm(utm.head<2>(), utm.z(), {32, true});
      },
      0.01);
}

// Heights above a geoid: the project's constant goes before PROJ's grid, and is needed where there is none.
TEST_F(Conventions, OpfWithHeightsAboveAGeoid) {
  test::Files files = test::OpfFiles(survey_);
  std::string* frame = nullptr;
  for (auto& [name, content] : files) {
    if (content.find("EPSG:32632") != std::string::npos) frame = &content;
  }
  ASSERT_NE(frame, nullptr);
  nlohmann::json file = base::ParseJson(*frame);
  const auto expect = [&](const char* definition, std::optional<double> constant_m, const auto& added_m) {
    file["crs"] = nlohmann::json::object();  // clang 14 forgets to destroy nested braces in a generic lambda
    file["crs"]["definition"] = definition;
    if (constant_m) file["crs"]["geoid_height"] = *constant_m;
    *frame = base::JsonText(file);
    ExpectPlace(
        Read(files),
        [&](const Vector3d& x) {
          const Vector3d utm = x - test::kOpfShift;
          geo::Geodetic place = geo::GeodeticFromUtm(utm.head<2>(), utm.z(), {32, true});
          place.height_m += added_m(place);
          return place;
        },
        0.02);
  };
  const auto constant = [](const geo::Geodetic&) { return 47.5; };
  expect("EPSG:32632+3855", 47.5, constant);
  expect("EPSG:32632+5773", 47.5, constant);
  expect("EPSG:32632+3855", std::nullopt, [](const geo::Geodetic&) { return 0.0; });
  expect("EPSG:32632+5773", std::nullopt, [](const geo::Geodetic& place) { return geo::Egm96Undulation(place.latitude_deg, place.longitude_deg); });
}

TEST_F(Conventions, FisheyesOfTransformsAndMetashapeAreOpencvs) {
  test::Files files = test::TransformsFiles(survey_);
  nlohmann::json file = base::ParseJson(files["transforms.json"]);
  file["camera_model"] = "OPENCV_FISHEYE";
  file["k4"] = 0.001;
  file.erase("p1");
  file.erase("p2");
  files["transforms.json"] = base::JsonText(file);
  const camera::Camera camera = Read(files, "transforms.json").sfm.cameras.at(1);
  EXPECT_EQ(camera.model, camera::CameraModel::kOpencvFisheye);
  EXPECT_EQ(camera.params, (std::vector<double>{510.0, 500.0, 322.0, 237.0, -0.1, 0.02, -0.003, 0.001}));
  // As instant-ngp's scripts say it.
  file.erase("camera_model");
  file["is_fisheye"] = true;
  files["transforms.json"] = base::JsonText(file);
  EXPECT_EQ(Read(files, "transforms.json").sfm.cameras.at(1).params, camera.params);
  std::string xml = test::MetashapeFiles(survey_).at("cameras.xml");
  const auto replace = [&](const std::string& from, const std::string& to) {
    const size_t at = xml.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    xml.replace(at, from.size(), to);
  };
  replace("<calibration type=\"frame\" class=\"adjusted\">", "<calibration type=\"fisheye\" class=\"adjusted\">");
  replace("<p1>-0.00069999999999999999</p1>", "");
  replace("<p2>0.001</p2>", "");
  names_.clear();
  EXPECT_EQ(Read({{"cameras.xml", xml}}, "cameras.xml").sfm.cameras.at(1).params,
            (std::vector<double>{510.0, 500.0, 322.0, 237.0, -0.1, 0.02, -0.003, 0.0}));
}

}  // namespace
}  // namespace skyquilt::prepare::models
