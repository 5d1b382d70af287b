#include "prepare/rigs/rig_config.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::prepare::rigs {
namespace {

class RigConfig : public InTemporaryFolder {
 protected:
  std::filesystem::path Write(const std::string& text) const {
    base::WriteFileAtomically(folder_ / "rig_config.json", text);
    return folder_ / "rig_config.json";
  }
  std::string Problem(const std::string& text) const {
    return InputErrorOf([&] { ReadRigConfig(Write(text)); });
  }
};

using RigFile = RigConfig;

// As in COLMAP's documentation, the reference not the first.
constexpr const char* kStereo = R"([{"cameras": [
  {"image_prefix": "left/", "cam_from_rig_rotation": [0.7071067811865475, 0.0, 0.7071067811865476, 0.0],
   "cam_from_rig_translation": [-0.1, 0.02, 0.3], "camera_model_name": "PINHOLE", "camera_params": [500, 500, 320, 240]},
  {"image_prefix": "right/", "ref_sensor": true}]}])";

std::vector<input::PhotoFile> PhotosNamed(const std::vector<std::string>& names) {
  std::vector<input::PhotoFile> photos;
  for (const std::string& name : names) photos.push_back({.name = name, .width = 640, .height = 480});
  return photos;
}

TEST_F(RigFile, ReadsColmapsForm) {
  const std::vector<Rig> rigs = ReadRigConfig(Write(kStereo));
  ASSERT_EQ(rigs.size(), 1U);
  ASSERT_EQ(rigs[0].cameras.size(), 2U);
  EXPECT_EQ(rigs[0].cameras[0].prefix, "right/");
  EXPECT_TRUE(rigs[0].cameras[0].cam_from_rig.rotation.isApprox(Eigen::Quaterniond::Identity()));
  EXPECT_EQ(rigs[0].cameras[1].prefix, "left/");
  EXPECT_NEAR((rigs[0].cameras[1].cam_from_rig.translation - Eigen::Vector3d(-0.1, 0.02, 0.3)).norm(), 0.0, 1e-15);
  // A quarter of a turn about y: the rig's x is the camera's -z.
  EXPECT_NEAR((rigs[0].cameras[1].cam_from_rig.rotation * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitZ()).norm(), 0.0, 1e-12);
}

TEST_F(RigFile, WhatIsWrittenIsRead) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.234, Eigen::Vector3d(1.0, -2.0, 0.5).normalized()));
  const std::vector<Rig> written = {{{{.prefix = "a/", .cam_from_rig = {}, .model = "PINHOLE", .params = {500.0, 500.0, 320.0, 240.0}},
                                      {.prefix = "b/", .cam_from_rig = {turn, {1.0 / 3.0, -2e-9, 5.0}}}}},
                                    {{{.prefix = "c/", .cam_from_rig = {}}}}};
  const std::vector<Rig> read = ReadRigConfig(Write(RigConfigText(written)));
  ASSERT_EQ(read.size(), 2U);
  ASSERT_EQ(read[0].cameras.size(), 2U);
  EXPECT_EQ(read[0].cameras[1].prefix, "b/");
  EXPECT_LT(read[0].cameras[1].cam_from_rig.rotation.angularDistance(turn), 1e-14);
  EXPECT_EQ(read[0].cameras[1].cam_from_rig.translation, written[0].cameras[1].cam_from_rig.translation);
  EXPECT_EQ(read[1].cameras[0].prefix, "c/");
}

TEST_F(RigFile, FaultsNameTheFileTheLineAndTheFix) {
  const std::string camera = R"({"image_prefix": "a/", "ref_sensor": true})";
  const std::pair<std::string, const char*> cases[] = {
      {"", "rig_config.json"},
      {"{}", "must be a list"},
      {"[]", "has no rig"},
      {"[{}]", "cameras"},
      {"[{\"cameras\": []}]", "ref_sensor"},
      {"[{\"cameras\": [{\"ref_sensor\": true}]}]", "image_prefix"},
      {"[{\"cameras\": [" + camera + "," + camera + "]}]", "prefix of another"},
      {"[{\"cameras\": [" + camera + ", {\"image_prefix\": \"b/\", \"ref_sensor\": true}]}]", "second camera"},
      {"[{\"cameras\": [" + camera + ", {\"image_prefix\": \"b/\"}]}]", "cam_from_rig_rotation"},
      {"[{\"cameras\": [" + camera +
           ",\n{\"image_prefix\": \"b/\", \"cam_from_rig_rotation\": [1, 1, 0, 0], \"cam_from_rig_translation\": [0, 0, 0]}]}]",
       "line 2"},
      {"[{\"cameras\": [" + camera + ", {\"image_prefix\": \"b/\", \"cam_from_rig_rotation\": [1, 0, 0], \"cam_from_rig_translation\": [0, 0, 0]}]}]",
       "4"},
      {"[{\"cameras\": [" + camera + ", {\"image_prefix\": \"b/\", \"cam_from_rig_rotation\": [1, 0, 0, 0]}]}]", "cam_from_rig_translation"},
      {"[{\"cameras\": [" + camera +
           ", {\"image_prefix\": \"b/\", \"cam_from_rig_rotation\": [NaN, 0, 0, 0], \"cam_from_rig_translation\": [0, 0, 0]}]}]",
       "cam_from_rig_rotation"},
      {R"([{"cameras": [{"image_prefix": "a/", "ref_sensor": true, "camera_model_name": "PINHOLE", "camera_params": [500, 320, 240]}]}])", "4"},
      {R"([{"cameras": [{"image_prefix": "a/", "ref_sensor": true, "camera_model_name": "SIMPLE_PINHOLE", "camera_params": [0, 320, 240]}]}])",
       "focal length"},
  };
  for (const auto& [text, says] : cases) {
    const std::string problem = Problem(text);
    EXPECT_NE(problem.find(says), std::string::npos) << text << "\n" << problem;
    EXPECT_NE(problem.find("rig_config.json"), std::string::npos) << problem;
    EXPECT_NE(problem.find("COLMAP's documentation"), std::string::npos) << problem;
  }
}

TEST_F(RigFile, PhotosOfOneNameBehindThePrefixesAreOneShot) {
  const std::vector<Rig> rigs = ReadRigConfig(Write(kStereo));
  std::vector<input::PhotoFile> photos = PhotosNamed({"left/day/1.jpg", "left/day/2.jpg", "other.jpg", "right/day/1.jpg", "right/day/3.jpg"});
  UseRigs(rigs, folder_ / "rig_config.json", photos);
  EXPECT_EQ(photos[0].rig->shot, "day/1.jpg");
  EXPECT_EQ(photos[3].rig->shot, "day/1.jpg");
  EXPECT_EQ(photos[1].rig->shot, "day/2.jpg");
  EXPECT_NE(photos[0].rig->camera, photos[3].rig->camera);
  EXPECT_EQ(photos[0].rig->cam_from_rig.translation, Eigen::Vector3d(-0.1, 0.02, 0.3));
  EXPECT_FALSE(photos[2].rig);
  EXPECT_EQ(photos[0].rig->exact_focal_px, 500.0);
  EXPECT_FALSE(photos[3].rig->exact_focal_px);
}

TEST_F(RigFile, OnlyALensWithoutDistortionInTheMiddleOfThePhotoIsKept) {
  const auto focal_with = [&](const std::string& lens) {
    const std::vector<Rig> rigs = ReadRigConfig(Write(R"([{"cameras": [{"image_prefix": "a/", "ref_sensor": true, )" + lens +
                                                      R"(}, {"image_prefix": "b/", "cam_from_rig_rotation": [1, 0, 0, 0],
                                                      "cam_from_rig_translation": [0, 0, 0]}]}])"));
    std::vector<input::PhotoFile> photos = PhotosNamed({"a/1.jpg", "b/1.jpg"});
    UseRigs(rigs, folder_ / "rig_config.json", photos);
    EXPECT_FALSE(photos[1].rig->exact_focal_px);
    return photos[0].rig->exact_focal_px;
  };
  EXPECT_EQ(focal_with(R"("camera_model_name": "PINHOLE", "camera_params": [500, 500, 320, 240])"), 500.0);
  EXPECT_EQ(focal_with(R"("camera_model_name": "SIMPLE_PINHOLE", "camera_params": [500, 320.5, 239.5])"), 500.0);
  EXPECT_FALSE(focal_with(R"("camera_model_name": "PINHOLE", "camera_params": [500, 510, 320, 240])"));
  EXPECT_FALSE(focal_with(R"("camera_model_name": "PINHOLE", "camera_params": [500, 500, 300, 240])"));
  EXPECT_FALSE(focal_with(R"("camera_model_name": "OPENCV", "camera_params": [500, 500, 320, 240, 0.1, 0, 0, 0])"));
  EXPECT_FALSE(focal_with(R"("camera_model_name": "PINHOLE")"));
}

TEST_F(RigFile, NamesThatMakeNoShotAreAnError) {
  const std::vector<Rig> rigs = ReadRigConfig(Write(kStereo));
  std::vector<input::PhotoFile> differ = PhotosNamed({"left/a.jpg", "right/b.jpg"}), others = PhotosNamed({"front/a.jpg", "back/a.jpg"});
  EXPECT_NE(InputErrorOf([&] { UseRigs(rigs, "r.json", differ); }).find("names differ behind the prefixes"), std::string::npos);
  EXPECT_NE(InputErrorOf([&] { UseRigs(rigs, "r.json", others); }).find("front/a.jpg"), std::string::npos);
}

TEST_F(RigFile, IsFoundInOrBesideThePhotoFolder) {
  const std::filesystem::path images = folder_ / "images", photos = folder_ / "photos";
  for (const auto& made : {images, photos}) std::filesystem::create_directories(made);
  const std::filesystem::path file = Write(kStereo);
  EXPECT_EQ(FindRigConfig(folder_.path(), ""), file);
  EXPECT_EQ(FindRigConfig(images, ""), file);
  EXPECT_EQ(FindRigConfig(photos, ""), "");
  EXPECT_EQ(FindRigConfig(images, "none"), "");
  EXPECT_EQ(FindRigConfig(photos, file.string()), file);
  EXPECT_NE(InputErrorOf([&] { FindRigConfig(photos, (folder_ / "no.json").string()); }).find("prepare.rig"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::prepare::rigs
