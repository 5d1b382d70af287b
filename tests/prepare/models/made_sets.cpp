#include "tests/prepare/models/made_sets.h"

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/image/image.h"
#include "core/survey/colmap_model.h"
#include "tests/prepare/models/made_models.h"

namespace skyquilt::test {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using nlohmann::json;
using Pose = Eigen::Matrix<double, 3, 4>;

constexpr int kPictures = 17;

void WritePicture(const fs::path& file, int i, int times = 1) {
  fs::create_directories(file.parent_path());
  image::SavePng(image::Image8(kSetWidth * times, kSetHeight * times, 3, static_cast<uint8_t>(10 + 5 * i)), file);
}

void WriteText(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  base::WriteFileAtomically(file, text);
}

json Rows(const Pose& pose, double scale_of_rotation = 1.0) {
  json rows = json::array();
  for (int row = 0; row < 3; ++row) {
    rows.push_back({scale_of_rotation * pose(row, 0), scale_of_rotation * pose(row, 1), scale_of_rotation * pose(row, 2), pose(row, 3)});
  }
  rows.push_back({0.0, 0.0, 0.0, 1.0});
  return rows;
}

// NeRF (load_blender.py, run_nerf_helpers.py get_rays), at the pixel's middle: focal = .5 W / tan(.5 camera_angle_x),
// direction = R ((i - W/2) / focal, -(j - H/2) / focal, -1).
SetRay NerfRay(const Pose& c2w, double focal, double width, double height, double i, double j) {
  const Vector3d in_cam((i - 0.5 * width) / focal, -(j - 0.5 * height) / focal, -1.0);
  return {c2w.col(3), (c2w.leftCols<3>() * in_cam).normalized()};
}

constexpr double kAngle = 0.69;

double FocalOfAngle() {
  return 0.5 * kSetWidth / std::tan(0.5 * kAngle);
}

// One row of poses_bounds.npy: LLFF's axes are down, right, back.
std::vector<double> LlffRow(const Pose& c2w, double height, double width, double focal) {
  const double last[3] = {height, width, focal};
  std::vector<double> row;
  for (int r = 0; r < 3; ++r) {
    for (const double value : {-c2w(r, 1), c2w(r, 0), c2w(r, 2), c2w(r, 3), last[r]}) row.push_back(value);
  }
  row.push_back(1.5);
  row.push_back(99.0);
  return row;
}

std::string Number(int i, const std::string& before, const std::string& after) {
  std::string digits = std::to_string(i);
  return before + std::string(3 - digits.size(), '0') + digits + after;
}

}  // namespace

Pose SetPose(int i) {
  const Matrix3d turn = (Eigen::AngleAxisd(0.9 * i + 0.2, Vector3d::UnitZ()) * Eigen::AngleAxisd(1.0 - 0.07 * i, Vector3d::UnitX()) *
                         Eigen::AngleAxisd(0.1 * i, Vector3d::UnitY()))
                            .toRotationMatrix();
  Pose pose;
  pose.leftCols<3>() = turn;
  pose.col(3) = 4.0 * turn.col(2) + Vector3d(0.1 * i, 0.05, 0.3);
  return pose;
}

MadeSet MakeBlender(const fs::path& folder) {
  MadeSet set{.photo_root = folder, .model = folder};
  std::map<std::string, int> index;
  int next = 0;
  for (const auto& [part, n] : std::vector<std::pair<std::string, int>>{{"test", 2}, {"train", 4}, {"val", 2}}) {
    json file = {{"camera_angle_x", kAngle}, {"frames", json::array()}};
    for (int i = 0; i < n; ++i, ++next) {
      const std::string stem = part + "/r_" + std::to_string(i);
      WritePicture(folder / (stem + ".png"), next);
      file["frames"].push_back({{"file_path", "./" + stem}, {"rotation", 0.0125}, {"transform_matrix", Rows(SetPose(next))}});
      if (part == "test") WritePicture(folder / (stem + "_depth_0001.png"), 0);
      if (part == "val") continue;
      index.emplace(stem + ".png", next);
      set.names.push_back(stem + ".png");
      if (part == "test") set.test.push_back(stem + ".png");
    }
    WriteText(folder / ("transforms_" + part + ".json"), base::JsonText(file, 1));
  }
  set.ray = [index](const std::string& name, int i, int j) {
    return NerfRay(SetPose(index.at(name)), FocalOfAngle(), kSetWidth, kSetHeight, i + 0.5, j + 0.5);
  };
  return set;
}

MadeSet MakeLlff(const fs::path& folder) {
  constexpr double kFullFocal = 131.0, kTimes = 4.0;
  MadeSet set{.photo_root = folder / "images_4", .model = folder / "poses_bounds.npy"};
  std::vector<double> values;
  for (int i = 0; i < kPictures; ++i) {
    const std::string name = Number(i, "image", ".png");
    WritePicture(folder / "images_4" / name, i);
    WritePicture(folder / "images" / Number(i, "IMG_4", ".png"), i, 4);
    set.names.push_back(name);
    if (i % 8 == 0) set.test.push_back(name);
    const std::vector<double> row = LlffRow(SetPose(i), kTimes * kSetHeight, kTimes * kSetWidth, kFullFocal);
    values.insert(values.end(), row.begin(), row.end());
  }
  WriteText(folder / "poses_bounds.npy", NpyOfDoubles(kPictures, 17, values));
  // load_llff.py: columns [1, -0, 2] of the stored matrix are right, up, back; focal length over the factor.
  set.ray = [values](const std::string& name, int i, int j) {
    const size_t row = 17 * static_cast<size_t>(std::stoi(name.substr(5, 3)));
    Pose c2w;
    for (int r = 0; r < 3; ++r) {
      const double* const stored = values.data() + row + 5 * static_cast<size_t>(r);
      c2w.row(r) << stored[1], -stored[0], stored[2], stored[3];
    }
    return NerfRay(c2w, kFullFocal / kTimes, kSetWidth, kSetHeight, i + 0.5, j + 0.5);
  };
  return set;
}

MadeSet MakeMip360(const fs::path& folder) {
  constexpr double kFx = 150.0, kFy = 148.0, kCx = 78.0, kCy = 61.0;
  MadeSet set{.photo_root = folder / "images_4", .model = folder};
  survey::ColmapModel colmap;
  colmap.cameras[1] = {camera::CameraModel::kPinhole, 4 * kSetWidth, 4 * kSetHeight, {kFx, kFy, kCx, kCy}};
  for (int i = 0; i < kPictures; ++i) {
    const std::string name = Number(i, "_DSC8", ".png");
    WritePicture(folder / "images_4" / name, i);
    set.names.push_back(name);
    if (i % 8 == 0) set.test.push_back(name);
    // COLMAP's axes are right, down, forward.
    const Pose pose = SetPose(i);
    const Matrix3d world_from_cam = pose.leftCols<3>() * Vector3d(1.0, -1.0, -1.0).asDiagonal();
    const Eigen::Quaterniond cam_from_world(Matrix3d(world_from_cam.transpose()));
    colmap.images.push_back({static_cast<uint32_t>(100 - i), 1, name, geo::Rigid3d{cam_from_world, -(cam_from_world * Vector3d(pose.col(3)))}});
  }
  for (int i = 0; i < 5; ++i) colmap.points.push_back({static_cast<uint64_t>(i + 1), Vector3d(0.1 * i, 0.2, -0.1 * i), {9, 8, 7}, 0.5, {100U, 99U}});
  survey::ColmapObservations observations;
  for (const survey::ColmapImage& image : colmap.images) observations[image.id] = {};
  for (const survey::ColmapPoint& point : colmap.points) {
    for (const uint32_t id : point.image_ids) observations[id].push_back({point.id, Eigen::Vector2d(20.0, 10.0)});
  }
  survey::WriteColmapBinary(colmap, observations, folder / "sparse" / "0");
  // multinerf (internal/datasets.py, camera_utils.py): direction = R inv(K) diag(factor, factor, 1) (i + .5, j + .5, 1) in COLMAP's axes.
  set.ray = [](const std::string& name, int i, int j) {
    const Pose pose = SetPose(std::stoi(name.substr(5, 3)));
    const Vector3d in_cam((4.0 * (i + 0.5) - kCx) / kFx, (4.0 * (j + 0.5) - kCy) / kFy, 1.0);
    return SetRay{pose.col(3), (pose.leftCols<3>() * Vector3d(in_cam.x(), -in_cam.y(), -in_cam.z())).normalized()};
  };
  return set;
}

MadeSet MakeMatrixCitySplit(const fs::path& folder) {
  const fs::path aerial = folder / "aerial";
  MadeSet set{.photo_root = aerial, .model = aerial / "pose" / "block_A"};
  std::map<std::string, int> index;
  int next = 0;
  for (const auto& [part, block] : std::vector<std::pair<std::string, std::string>>{{"test", "block_1_test"}, {"train", "block_1"}}) {
    // scripts/load_aerial.py writes these.
    json file = {{"camera_angle_x", kAngle},
                 {"fl_x", FocalOfAngle()},
                 {"fl_y", FocalOfAngle()},
                 {"k1", 0},
                 {"k2", 0},
                 {"k3", 0},
                 {"k4", 0},
                 {"p1", 0},
                 {"p2", 0},
                 {"cx", 0.5 * kSetWidth},
                 {"cy", 0.5 * kSetHeight},
                 {"w", 1.0 * kSetWidth},
                 {"h", 1.0 * kSetHeight}};
    for (int i = 0; i < 4; ++i, ++next) {
      const std::string name = part + "/" + block + "/000" + std::to_string(i) + ".png";
      WritePicture(aerial / name, next);
      file["frames"].push_back({{"file_path", "../../" + name}, {"transform_matrix", Rows(SetPose(next))}});
      index.emplace(name, next);
      set.names.push_back(name);
      if (part == "test") set.test.push_back(name);
    }
    WriteText(set.model / ("transforms_" + part + ".json"), base::JsonText(file, 2));
  }
  WritePicture(aerial / "train/block_2/0000.png", 0);
  WriteText(aerial / "train/block_1/transforms.json", "{}");  // the block's own, which the split does not need
  set.ray = [index](const std::string& name, int i, int j) {
    return NerfRay(SetPose(index.at(name)), FocalOfAngle(), kSetWidth, kSetHeight, i + 0.5, j + 0.5);
  };
  return set;
}

MadeSet MakeMatrixCityBlock(const fs::path& folder) {
  MadeSet set{.photo_root = folder, .model = folder / "transforms.json"};
  json file = {{"camera_angle_x", kAngle}};
  // The unit of position is m, and the rotation matrix needs to be multiplied by 100 to normalize it (README.md).
  for (int i = 0; i < 4; ++i) {
    const std::string name = "000" + std::to_string(i) + ".png";
    WritePicture(folder / "rgb" / name, i);
    file["frames"].push_back({{"frame_index", i}, {"rot_mat", Rows(SetPose(i), 0.01)}, {"euler", {0.0, 0.1, 0.2}}});
    set.names.push_back("rgb/" + name);
  }
  WriteText(set.model, base::JsonText(file, 1));
  set.ray = [](const std::string& name, int i, int j) {
    return NerfRay(SetPose(std::stoi(name.substr(4, 4))), FocalOfAngle(), kSetWidth, kSetHeight, i + 0.5, j + 0.5);
  };
  return set;
}

std::string NpyBytes(const std::string& dictionary, const std::vector<double>& values) {
  std::string header = dictionary;
  while ((10 + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::string bytes = "\x93NUMPY";
  bytes += '\x01';
  bytes += '\0';
  bytes += static_cast<char>(header.size() % 256);
  bytes += static_cast<char>(header.size() / 256);
  bytes += header;
  bytes.append(reinterpret_cast<const char*>(values.data()), sizeof(double) * values.size());
  return bytes;
}

std::string NpyOfDoubles(size_t rows, size_t columns, const std::vector<double>& values) {
  return NpyBytes("{'descr': '<f8', 'fortran_order': False, 'shape': (" + std::to_string(rows) + ", " + std::to_string(columns) + "), }", values);
}

Files PosesBoundsFiles(const MadeModel& survey) {
  std::vector<double> values;
  for (const MadePhoto& photo : survey.photos) {
    Pose c2w;
    c2w << photo.axes.col(0), -photo.axes.col(1), -photo.axes.col(2), photo.centre;
    const std::vector<double> row = LlffRow(c2w, survey.lens.height, survey.lens.width, survey.lens.fx);
    values.insert(values.end(), row.begin(), row.end());
  }
  return {{"poses_bounds.npy", NpyOfDoubles(survey.photos.size(), 17, values)}};
}

}  // namespace skyquilt::test
