#include "prepare/models/input_model.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/base/errors.h"
#include "core/image/image.h"

namespace skyquilt::prepare::models {

namespace fs = std::filesystem;

std::string FormatName(ModelFormat format) {
  switch (format) {
    case ModelFormat::kColmap:
      return "a COLMAP model";
    case ModelFormat::kTransforms:
      return "a transforms.json (nerfstudio, Blender)";
    case ModelFormat::kOpensfm:
      return "a reconstruction.json (OpenSfM, OpenDroneMap)";
    case ModelFormat::kMetashape:
      return "a Metashape cameras.xml";
    case ModelFormat::kOpf:
      return "a Pix4D project (OPF)";
    case ModelFormat::kPosesBounds:
      return "a poses_bounds.npy (LLFF)";
  }
  return "";
}

ModelPhotos::ModelPhotos(fs::path root, const std::vector<std::string>& names) : root_(std::move(root)), names_(names), finder_(names) {}

std::optional<std::string> ModelPhotos::FindPath(const std::string& label, const fs::path& model_folder) const {
  const std::string clean = PhotoNames::Cleaned(label);
  if (finder_.FindPath(clean)) return clean;
  std::error_code ignored;
  const fs::path below = fs::relative(model_folder / clean, root_, ignored);
  if (!ignored) {
    for (const char* extension : {"", ".png", ".jpg", ".jpeg", ".JPG", ".tif"}) {
      const std::string name = below.generic_string() + extension;
      if (finder_.FindPath(name)) return name;
    }
  }
  return std::nullopt;
}

std::string ModelPhotos::Resolve(const std::string& label, const fs::path& model_folder) const {
  if (std::optional<std::string> found = FindPath(label, model_folder)) return *std::move(found);
  const std::string clean = PhotoNames::Cleaned(label);
  const std::optional<size_t> same = finder_.FindFileName(clean);
  return same ? names_[*same] : clean;
}

std::optional<Eigen::Vector2i> ModelPhotos::SizeOf(const std::string& name) const {
  if (!finder_.FindPath(name)) return std::nullopt;
  try {
    Eigen::Vector2i size;
    image::ReadImageSize(root_ / name, &size.x(), &size.y());
    return size;
  } catch (const base::InputError&) {
    return std::nullopt;  // left out with a warning when the photos are read
  }
}

uint32_t SfmBuilder::AddCamera(const camera::Camera& camera) {
  for (const auto& [id, known] : sfm_->cameras) {
    if (known.model == camera.model && known.width == camera.width && known.height == camera.height && known.params == camera.params) return id;
  }
  const auto id = static_cast<uint32_t>(sfm_->cameras.size() + 1);
  sfm_->cameras.emplace(id, camera);
  return id;
}

uint32_t SfmBuilder::AddImage(const std::string& name, uint32_t camera_id, const geo::Rigid3d& cam_from_world) {
  const auto id = static_cast<uint32_t>(sfm_->images.size() + 1);
  sfm_->images.push_back({id, camera_id, name, cam_from_world});
  return id;
}

void SfmBuilder::AddPoint(const Eigen::Vector3d& x_in_world, const std::array<uint8_t, 3>& rgb, std::vector<uint32_t> image_ids) {
  sfm_->points.push_back({sfm_->points.size() + 1, x_in_world, rgb, 0.0, std::move(image_ids)});
}

std::optional<Eigen::Matrix3d> RotationOf(const Eigen::Matrix3d& matrix) {
  constexpr double kTolerance = 1e-3;
  const double scale = std::cbrt(matrix.determinant());
  if (!matrix.allFinite() || !(scale > 1e-9)) return std::nullopt;
  const Eigen::Matrix3d rotation = matrix / scale;
  if (!(rotation.transpose() * rotation).isIdentity(kTolerance)) return std::nullopt;
  return Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
}

geo::Rigid3d PoseFromCentre(const Eigen::Matrix3d& world_from_cam, const Eigen::Vector3d& centre_in_world) {
  const Eigen::Quaterniond cam_from_world(Eigen::Matrix3d(world_from_cam.transpose()));
  return {cam_from_world, -(cam_from_world * centre_in_world)};
}

camera::Camera PerspectiveCamera(int width, int height, const Eigen::Vector2d& focal, const Eigen::Vector2d& centre, double k1, double k2, double k3,
                                 double p1, double p2) {
  using camera::CameraModel;
  if (k3 != 0.0) return {CameraModel::kFullOpencv, width, height, {focal.x(), focal.y(), centre.x(), centre.y(), k1, k2, p1, p2, k3, 0.0, 0.0, 0.0}};
  if (k1 == 0.0 && k2 == 0.0 && p1 == 0.0 && p2 == 0.0) return {CameraModel::kPinhole, width, height, {focal.x(), focal.y(), centre.x(), centre.y()}};
  return {CameraModel::kOpencv, width, height, {focal.x(), focal.y(), centre.x(), centre.y(), k1, k2, p1, p2}};
}

camera::Camera FisheyeCamera(int width, int height, const Eigen::Vector2d& focal, const Eigen::Vector2d& centre, const std::array<double, 4>& k) {
  return {camera::CameraModel::kOpencvFisheye, width, height, {focal.x(), focal.y(), centre.x(), centre.y(), k[0], k[1], k[2], k[3]}};
}

}  // namespace skyquilt::prepare::models
