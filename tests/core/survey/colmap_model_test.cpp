#include "core/survey/colmap_model.h"

#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::survey {
namespace {

using ColmapModelTest = InTemporaryFolder;

ColmapModel SmallModel() {
  ColmapModel model;
  model.cameras[3] = {camera::CameraModel::kOpencv, 640, 480, {500.0, 501.0, 320.5, 240.25, 0.01, -0.002, 1e-4, -1e-4}};
  model.cameras[7] = {camera::CameraModel::kSimplePinhole, 100, 80, {90.0, 50.0, 40.0}};
  // Of no image.
  model.cameras[20] = {camera::CameraModel::kFov, 640, 480, {500.0, 501.0, 320.5, 240.25, 0.9}};
  model.cameras[21] = {
      camera::CameraModel::kThinPrismFisheye, 640, 480, {500.0, 501.0, 320.5, 240.25, 0.01, 0.02, 3e-4, 4e-4, 0.05, 0.06, 7e-4, 8e-4}};
  model.cameras[22] = {camera::CameraModel::kRadTanThinPrismFisheye,
                       640,
                       480,
                       {500.0, 501.0, 320.5, 240.25, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 7e-4, 8e-4, 9e-4, 1e-3, 2e-3, 3e-3}};
  for (uint32_t i = 0; i < 3; ++i) {
    ColmapImage image;
    image.id = 10 + i;
    image.camera_id = i == 2 ? 7 : 3;
    image.name = i == 1 ? "flight 2/b photo.jpg" : "a" + std::to_string(i) + ".jpg";
    image.cam_from_world.rotation = Eigen::Quaterniond(0.1 + i, 0.9, -0.2, 0.3).normalized();
    image.cam_from_world.translation = Eigen::Vector3d(1.0 / 3.0, -2.0 * i, 1e-7);
    model.images.push_back(image);
  }
  for (uint64_t i = 0; i < 4; ++i) {
    ColmapPoint point;
    point.id = 100 + i;
    point.x_in_world = Eigen::Vector3d(0.1 * static_cast<double>(i), 1.0 / 7.0, -3.0e5);
    point.rgb = {static_cast<uint8_t>(i), 255, 0};
    point.error_px = 0.37;
    point.image_ids = {10, 11};
    if (i == 2) point.image_ids.push_back(12);
    model.points.push_back(point);
  }
  return model;
}

template <typename T>
void Put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

// COLMAP's binary layout (src/base/reconstruction.cc of 3.8), written independently of the reader.
void WriteBinary(const ColmapModel& model, const std::filesystem::path& folder, bool with_observations = true) {
  std::string cameras;
  Put<uint64_t>(cameras, model.cameras.size());
  for (const auto& [id, camera] : model.cameras) {
    Put<uint32_t>(cameras, id);
    Put<int32_t>(cameras, static_cast<int32_t>(camera.model));
    Put<uint64_t>(cameras, static_cast<uint64_t>(camera.width));
    Put<uint64_t>(cameras, static_cast<uint64_t>(camera.height));
    for (const double parameter : camera.params) Put(cameras, parameter);
  }
  std::string images;
  Put<uint64_t>(images, model.images.size());
  for (const ColmapImage& image : model.images) {
    Put<uint32_t>(images, image.id);
    const Eigen::Quaterniond& q = image.cam_from_world.rotation;
    for (const double value : {q.w(), q.x(), q.y(), q.z()}) Put(images, value);
    for (int axis = 0; axis < 3; ++axis) Put(images, image.cam_from_world.translation[axis]);
    Put<uint32_t>(images, image.camera_id);
    images.append(image.name.c_str(), image.name.size() + 1);
    const uint64_t n_observations = with_observations ? 2 : 0;
    Put<uint64_t>(images, n_observations);
    for (uint64_t k = 0; k < n_observations; ++k) {
      Put<double>(images, 12.5);
      Put<double>(images, 7.5);
      Put<int64_t>(images, k == 0 ? 100 : -1);
    }
  }
  std::string points;
  Put<uint64_t>(points, model.points.size());
  for (const ColmapPoint& point : model.points) {
    Put<uint64_t>(points, point.id);
    for (int axis = 0; axis < 3; ++axis) Put(points, point.x_in_world[axis]);
    for (const uint8_t channel : point.rgb) Put(points, channel);
    Put(points, point.error_px);
    Put<uint64_t>(points, point.image_ids.size());
    for (const uint32_t id : point.image_ids) {
      Put(points, id);
      Put<uint32_t>(points, 0);
    }
  }
  base::WriteFileAtomically(folder / "cameras.bin", cameras);
  base::WriteFileAtomically(folder / "images.bin", images);
  base::WriteFileAtomically(folder / "points3D.bin", points);
}

void ExpectEqual(const ColmapModel& a, const ColmapModel& b) {
  ASSERT_EQ(a.cameras.size(), b.cameras.size());
  for (const auto& [id, camera] : a.cameras) {
    ASSERT_TRUE(b.cameras.contains(id));
    EXPECT_EQ(camera.model, b.cameras.at(id).model);
    EXPECT_EQ(camera.width, b.cameras.at(id).width);
    EXPECT_EQ(camera.height, b.cameras.at(id).height);
    EXPECT_EQ(camera.params, b.cameras.at(id).params);
  }
  ASSERT_EQ(a.images.size(), b.images.size());
  for (size_t i = 0; i < a.images.size(); ++i) {
    EXPECT_EQ(a.images[i].id, b.images[i].id);
    EXPECT_EQ(a.images[i].camera_id, b.images[i].camera_id);
    EXPECT_EQ(a.images[i].name, b.images[i].name);
    EXPECT_LT((a.images[i].cam_from_world.rotation.coeffs() - b.images[i].cam_from_world.rotation.coeffs()).norm(), 1e-15);
    EXPECT_EQ(a.images[i].cam_from_world.translation, b.images[i].cam_from_world.translation);
  }
  ASSERT_EQ(a.points.size(), b.points.size());
  for (size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].id, b.points[i].id);
    EXPECT_EQ(a.points[i].x_in_world, b.points[i].x_in_world);
    EXPECT_EQ(a.points[i].rgb, b.points[i].rgb);
    EXPECT_EQ(a.points[i].error_px, b.points[i].error_px);
    EXPECT_EQ(a.points[i].image_ids, b.points[i].image_ids);
  }
}

std::string MessageOf(const std::filesystem::path& folder) {
  return InputErrorOf([&] { ReadColmapModel(folder); });
}

TEST_F(ColmapModelTest, TextAndBinaryGiveTheSameModel) {
  const ColmapModel model = SmallModel();
  for (const bool with_observations : {true, false}) {
    const TemporaryFolder text;
    const TemporaryFolder binary;
    WriteColmapText(model, text.path());
    WriteBinary(model, binary.path(), with_observations);
    ExpectEqual(model, ReadColmapModel(text.path()));
    ExpectEqual(model, ReadColmapModel(binary.path()));
  }
}

TEST_F(ColmapModelTest, TextWithCommentsBlankLinesAndWindowsLineEndsIsRead) {
  base::WriteFileAtomically(folder_ / "cameras.txt", "# a comment\r\n\r\n  # another\r\n1 PINHOLE 10 8 9 9 5 4\r\n");
  base::WriteFileAtomically(
      folder_ / "images.txt",
      "# comment\n1 1 0 0 0 0 0 0 1 a.jpg\n\n# between\n2 1 0 0 0 +1.5 0 0 1 sub\\b.jpg\n1.0 2.0 -1 3.0 4.0 5\n\n3 1 0 0 0 0 0 0 1 c.jpg");
  base::WriteFileAtomically(folder_ / "points3D.txt", "\n# none\n5 1 2 3 10 20 30 0.5 1 0 2 1\n6 1 2 nan 10 20 30 0.5\n");
  const ColmapModel model = ReadColmapModel(folder_.path());
  ASSERT_EQ(model.images.size(), 3U);
  EXPECT_EQ(model.images[1].name, "sub/b.jpg");
  EXPECT_EQ(model.images[1].cam_from_world.translation.x(), 1.5);
  EXPECT_EQ(model.images[2].name, "c.jpg");
  ASSERT_EQ(model.points.size(), 1U);  // the point with nan is dropped
  EXPECT_EQ(model.points[0].image_ids, (std::vector<uint32_t>{1, 2}));
}

TEST(ColmapObservations, TextAndBinaryGiveTheSame) {
  const TemporaryFolder binary;
  WriteBinary(SmallModel(), binary.path());
  const ColmapObservations read = ReadColmapObservations(binary.path());
  ASSERT_EQ(read.size(), 3U);
  for (const auto& [id, list] : read) {
    ASSERT_EQ(list.size(), 1U);  // the second feature belongs to no point
    EXPECT_EQ(list[0].point_id, 100U);
    EXPECT_EQ(list[0].pixel, Eigen::Vector2d(12.5, 7.5));
  }

  const TemporaryFolder text;
  WriteColmapText(SmallModel(), text.path());
  const ColmapObservations from_text = ReadColmapObservations(text.path());
  ASSERT_EQ(from_text.size(), 3U);
  EXPECT_EQ(from_text.at(10).size(), 4U);
  EXPECT_EQ(from_text.at(12).size(), 1U);
  EXPECT_EQ(from_text.at(12)[0].point_id, 102U);

  base::WriteFileAtomically(text / "images.txt",
                            "# comment\r\n1 1 0 0 0 0 0 0 1 a.jpg\r\n12.5 7.5 -1 3.0 4.0 5 1 2 18446744073709551615\r\n2 1 0 0 0 0 0 0 1 b.jpg");
  const ColmapObservations by_hand = ReadColmapObservations(text.path());
  ASSERT_EQ(by_hand.size(), 2U);
  ASSERT_EQ(by_hand.at(1).size(), 1U);
  EXPECT_EQ(by_hand.at(1)[0].point_id, 5U);
  EXPECT_EQ(by_hand.at(1)[0].pixel, Eigen::Vector2d(3.0, 4.0));
  EXPECT_TRUE(by_hand.at(2).empty());
}

TEST(ColmapObservations, DamagedOnesAreRefused) {
  const TemporaryFolder text;
  const auto message = [&](const std::string& line) {
    WriteColmapText(SmallModel(), text.path());
    base::WriteFileAtomically(text / "images.txt", "7 1 0 0 0 0 0 0 3 a.jpg\n" + line + "\n");
    return InputErrorOf([&] { ReadColmapObservations(text.path()); });
  };
  EXPECT_EQ(message("1 2 3"), "");
  EXPECT_NE(message("1 2").find("line 2"), std::string::npos);
  EXPECT_NE(message("1 2 -2").find("'-2'"), std::string::npos);
  EXPECT_NE(message("1 2 3 4 x 6").find("'x'"), std::string::npos);
  EXPECT_NE(message("1 nan 3").find("image 7"), std::string::npos);
  EXPECT_NE(message("1 2 3\n7 1 0 0 0 0 0 0 3 b.jpg\n").find("image 7 twice"), std::string::npos);

  const TemporaryFolder binary;
  WriteBinary(SmallModel(), binary.path());
  const std::string whole = base::ReadFile(binary / "images.bin");
  for (size_t length = 0; length < whole.size(); ++length) {
    std::ofstream(binary / "images.bin", std::ios::binary | std::ios::trunc) << whole.substr(0, length);
    ASSERT_THROW(ReadColmapObservations(binary.path()), base::InputError) << length;
  }
  EXPECT_THROW(ReadColmapObservations(binary / "absent"), base::InputError);
}

TEST_F(ColmapModelTest, EveryTruncationOfABinaryFileIsRefused) {
  const ColmapModel model = SmallModel();
  for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"}) {
    WriteBinary(model, folder_.path());
    const std::string whole = base::ReadFile(folder_ / name);
    for (size_t length = 0; length < whole.size(); ++length) {
      std::ofstream(folder_ / name, std::ios::binary | std::ios::trunc) << whole.substr(0, length);
      ASSERT_THROW(ReadColmapModel(folder_.path()), base::InputError) << name << " cut to " << length;
    }
    std::ofstream(folder_ / name, std::ios::binary | std::ios::trunc) << whole + "x";
    EXPECT_THROW(ReadColmapModel(folder_.path()), base::InputError) << name << " with an extra byte";
  }
}

TEST_F(ColmapModelTest, HugeCountsAreRefusedBeforeAllocating) {
  for (const char* name : {"cameras.bin", "images.bin", "points3D.bin"}) {
    WriteBinary(SmallModel(), folder_.path());
    std::string content = base::ReadFile(folder_ / name);
    const uint64_t huge = std::numeric_limits<uint64_t>::max() / 2;
    content.replace(0, sizeof(huge), reinterpret_cast<const char*>(&huge), sizeof(huge));
    base::WriteFileAtomically(folder_ / name, content);
    EXPECT_NE(MessageOf(folder_.path()).find(name), std::string::npos);
  }
}

TEST_F(ColmapModelTest, NanInAPoseNamesThePhoto) {
  for (const bool binary : {true, false}) {
    const TemporaryFolder folder;
    ColmapModel model = SmallModel();
    model.images[1].cam_from_world.translation.y() = std::numeric_limits<double>::quiet_NaN();
    binary ? WriteBinary(model, folder.path()) : WriteColmapText(model, folder.path());
    EXPECT_NE(MessageOf(folder.path()).find("flight 2/b photo.jpg"), std::string::npos);
    model = SmallModel();
    model.images[0].cam_from_world.rotation.coeffs().setZero();
    binary ? WriteBinary(model, folder.path()) : WriteColmapText(model, folder.path());
    EXPECT_NE(MessageOf(folder.path()).find("a0.jpg"), std::string::npos);
  }
}

TEST_F(ColmapModelTest, ContradictionsAreRefused) {
  EXPECT_THROW(ReadColmapModel(folder_ / "absent"), base::InputError);
  EXPECT_THROW(ReadColmapModel(folder_.path()), base::InputError);
  ColmapModel model = SmallModel();
  model.images[2].camera_id = 99;
  WriteBinary(model, folder_.path());
  EXPECT_NE(MessageOf(folder_.path()).find("99"), std::string::npos);
  model = SmallModel();
  model.images[2].name = model.images[0].name;
  WriteBinary(model, folder_.path());
  EXPECT_NE(MessageOf(folder_.path()).find("twice"), std::string::npos);
  model = SmallModel();
  model.cameras[3].params[0] = -1.0;
  WriteBinary(model, folder_.path());
  EXPECT_NE(MessageOf(folder_.path()).find("camera 3"), std::string::npos);
}

TEST_F(ColmapModelTest, UnknownCameraModelsAreNamed) {
  WriteColmapText(SmallModel(), folder_.path());
  base::WriteFileAtomically(folder_ / "cameras.txt", "1 SPHERE 10 10 1 1 1 1 1 1 1 1 1 1 1 1\n");
  EXPECT_NE(MessageOf(folder_.path()).find("SPHERE"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::survey
