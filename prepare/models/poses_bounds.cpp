#include "prepare/models/poses_bounds.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "prepare/models/npy_array.h"

namespace skyquilt::prepare::models {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

constexpr const char* kRowFix =
    "Make it again with LLFF's imgs2poses.py: a row has 17 numbers, a 3 x 5 matrix with height, width and focal length in its last column, and two "
    "depths";
constexpr size_t kColumns = 17;
// Positions of one camera in both models, as a part of the distance between cameras.
constexpr double kSameFrame = 1e-3;

// A size in pixels, which the array holds as a floating-point number.
int SizeOf(const fs::path& file, size_t row, const char* name, double value) {
  if (!(value >= 1.0 && value <= 1e6) || value != std::floor(value)) {
    throw base::InputError(file, fmt::format("row {} has the {} {:g}, which is no whole number of pixels", row, name, value), kRowFix);
  }
  return static_cast<int>(value);
}

geo::Rigid3d PoseOfRow(const fs::path& file, const NpyArray& rows, size_t row) {
  Eigen::Matrix3d down_right_back;
  Vector3d centre;
  for (int i = 0; i < 3; ++i) {
    const size_t begin = 5 * static_cast<size_t>(i);
    for (int j = 0; j < 3; ++j) down_right_back(i, j) = rows.At(row, begin + static_cast<size_t>(j));
    centre[i] = rows.At(row, begin + 3);
  }
  const std::optional<Eigen::Matrix3d> rotation = RotationOf(down_right_back);
  if (!rotation) throw base::InputError(file, fmt::format("row {} has no rotation in the first three columns of its matrix", row), kRowFix);
  Eigen::Matrix3d right_down_forward;
  right_down_forward << rotation->col(1), rotation->col(0), -rotation->col(2);
  return PoseFromCentre(right_down_forward, centre);
}

camera::Camera LensOfRow(const fs::path& file, const NpyArray& rows, size_t row) {
  const int height = SizeOf(file, row, "height", rows.At(row, 4)), width = SizeOf(file, row, "width", rows.At(row, 9));
  const double focal = rows.At(row, 14);
  if (!(focal > 0.0)) throw base::InputError(file, fmt::format("row {} has the focal length {:g}, which must be more than 0", row, focal), kRowFix);
  return PerspectiveCamera(width, height, {focal, focal}, {0.5 * width, 0.5 * height}, 0.0, 0.0, 0.0, 0.0, 0.0);
}

// The images of COLMAP's model in name order, which is that of the rows.
std::vector<const survey::ColmapImage*> ByName(const survey::ColmapModel& colmap) {
  std::vector<const survey::ColmapImage*> images;
  for (const survey::ColmapImage& image : colmap.images) images.push_back(&image);
  std::sort(images.begin(), images.end(), [](const auto* a, const auto* b) { return a->name < b->name; });
  return images;
}

bool InSameFrame(const std::vector<const survey::ColmapImage*>& images, const survey::ColmapModel& sfm) {
  double size = 0.0, apart = 0.0;
  const Vector3d first = sfm.images.front().cam_from_world.OriginInSource();
  for (size_t i = 0; i < images.size(); ++i) {
    const Vector3d here = sfm.images[i].cam_from_world.OriginInSource();
    size = std::max(size, (here - first).norm());
    apart = std::max(apart, (images[i]->cam_from_world.OriginInSource() - here).norm());
  }
  return apart <= kSameFrame * size;
}

// Points of the model that the file was made from.
void AddPointsBeside(const fs::path& file, SfmBuilder& builder, const survey::ColmapModel& sfm) {
  const fs::path folder = file.parent_path() / "sparse" / "0";
  if (!fs::exists(folder / "points3D.bin") && !fs::exists(folder / "points3D.txt")) return;
  const survey::ColmapModel colmap = survey::ReadColmapModel(folder);
  const std::vector<const survey::ColmapImage*> images = ByName(colmap);
  if (images.size() != sfm.images.size() || !InSameFrame(images, sfm)) {
    base::LogWarning("{}: the points in {} are not used, because its cameras are others", file.string(), folder.string());
    return;
  }
  std::map<uint32_t, uint32_t> own_id;
  for (size_t i = 0; i < images.size(); ++i) own_id.emplace(images[i]->id, sfm.images[i].id);
  for (const survey::ColmapPoint& point : colmap.points) {
    std::vector<uint32_t> seen_by;
    for (const uint32_t id : point.image_ids) {
      if (const auto own = own_id.find(id); own != own_id.end()) seen_by.push_back(own->second);
    }
    builder.AddPoint(point.x_in_world, point.rgb, std::move(seen_by));
  }
}

}  // namespace

InputModel ReadPosesBounds(const fs::path& file, const ModelPhotos& photos) {
  const NpyArray rows = ReadNpyArray(file, kRowFix);
  if (rows.columns != kColumns) throw base::InputError(file, fmt::format("has {} numbers in a row, not {}", rows.columns, kColumns), kRowFix);
  if (rows.rows == 0) throw base::InputError(file, "has no poses", kRowFix);
  const std::vector<std::string>& names = photos.names();
  if (rows.rows != names.size()) {
    throw base::InputError(file, fmt::format("has poses of {} pictures, but there are {} in {}", rows.rows, names.size(), photos.root().string()),
                           "Give the folder with all pictures of the scene in one size, such as images or images_4. survey/input.csv says which "
                           "pictures were left out and why; prepare.photos chooses others");
  }
  InputModel model;
  model.format = ModelFormat::kPosesBounds;
  model.set = "LLFF";
  SfmBuilder builder(model.sfm);
  for (size_t i = 0; i < rows.rows; ++i) {
    builder.AddImage(names[i], builder.AddCamera(LensOfRow(file, rows, i)), PoseOfRow(file, rows, i));
    if (i % kHoldOutEvery == 0) model.test_photos.insert(names[i]);
  }
  AddPointsBeside(file, builder, model.sfm);
  return model;
}

}  // namespace skyquilt::prepare::models
