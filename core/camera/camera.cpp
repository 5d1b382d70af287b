#include "core/camera/camera.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/base/errors.h"
#include "core/camera/distortion.h"

namespace skyquilt::camera {
namespace {

struct ModelInfo {
  CameraModel model;
  const char* name;
  int n_params;
  bool one_focal_length;
  bool is_fisheye = false;
};

// In the order of COLMAP's ids.
constexpr std::array<ModelInfo, 12> kModels = {{{CameraModel::kSimplePinhole, "SIMPLE_PINHOLE", 3, true},
                                                {CameraModel::kPinhole, "PINHOLE", 4, false},
                                                {CameraModel::kSimpleRadial, "SIMPLE_RADIAL", 4, true},
                                                {CameraModel::kRadial, "RADIAL", 5, true},
                                                {CameraModel::kOpencv, "OPENCV", 8, false},
                                                {CameraModel::kOpencvFisheye, "OPENCV_FISHEYE", 8, false, true},
                                                {CameraModel::kFullOpencv, "FULL_OPENCV", 12, false},
                                                {CameraModel::kFov, "FOV", 5, false},
                                                {CameraModel::kSimpleRadialFisheye, "SIMPLE_RADIAL_FISHEYE", 4, true, true},
                                                {CameraModel::kRadialFisheye, "RADIAL_FISHEYE", 5, true, true},
                                                {CameraModel::kThinPrismFisheye, "THIN_PRISM_FISHEYE", 12, false, true},
                                                {CameraModel::kRadTanThinPrismFisheye, "RAD_TAN_THIN_PRISM_FISHEYE", 16, false, true}}};

const ModelInfo& Info(CameraModel model) {
  const auto index = static_cast<size_t>(model);
  SKYQUILT_CHECK(index < kModels.size(), "unknown camera model " + std::to_string(index));
  return kModels[index];
}

// Checks the number of parameters, so that none is read past the end of the list.
const ModelInfo& CheckedInfo(const Camera& camera) {
  const ModelInfo& info = Info(camera.model);
  SKYQUILT_CHECK(camera.params.size() == static_cast<size_t>(info.n_params),
                 std::string(info.name) + " with " + std::to_string(camera.params.size()) + " parameters");
  return info;
}

// The same lens written with two focal lengths.
Camera WithTwoFocalLengths(const Camera& camera) {
  const std::vector<double>& p = camera.params;
  Camera wide = camera;
  switch (camera.model) {
    case CameraModel::kSimplePinhole:
      wide.model = CameraModel::kPinhole;
      wide.params = {p[0], p[0], p[1], p[2]};
      break;
    case CameraModel::kSimpleRadial:
      wide.model = CameraModel::kOpencv;
      wide.params = {p[0], p[0], p[1], p[2], p[3], 0.0, 0.0, 0.0};
      break;
    case CameraModel::kRadial:
      wide.model = CameraModel::kOpencv;
      wide.params = {p[0], p[0], p[1], p[2], p[3], p[4], 0.0, 0.0};
      break;
    case CameraModel::kSimpleRadialFisheye:
      wide.model = CameraModel::kOpencvFisheye;
      wide.params = {p[0], p[0], p[1], p[2], p[3], 0.0, 0.0, 0.0};
      break;
    case CameraModel::kRadialFisheye:
      wide.model = CameraModel::kOpencvFisheye;
      wide.params = {p[0], p[0], p[1], p[2], p[3], p[4], 0.0, 0.0};
      break;
    default:
      break;
  }
  return wide;
}

}  // namespace

std::string ModelName(CameraModel model) {
  return Info(model).name;
}

int ModelParamCount(CameraModel model) {
  return Info(model).n_params;
}

std::optional<CameraModel> ModelFromName(const std::string& name) {
  for (const ModelInfo& info : kModels) {
    if (name == info.name) return info.model;
  }
  return std::nullopt;
}

std::optional<CameraModel> ModelFromId(int colmap_id) {
  if (colmap_id < 0 || colmap_id >= static_cast<int>(kModels.size())) return std::nullopt;
  return kModels[static_cast<size_t>(colmap_id)].model;
}

std::string ModelNames() {
  std::string names;
  for (size_t i = 0; i < kModels.size(); ++i) names += (i == 0 ? "" : i + 1 < kModels.size() ? ", " : " or ") + std::string(kModels[i].name);
  return names;
}

bool HasOneFocalLength(CameraModel model) {
  return Info(model).one_focal_length;
}

bool IsFisheye(CameraModel model) {
  return Info(model).is_fisheye;
}

std::string Camera::Problem() const {
  const auto index = static_cast<size_t>(model);
  if (index >= kModels.size()) return "unknown camera model " + std::to_string(index);
  const ModelInfo& info = kModels[index];
  if (width <= 0 || height <= 0) return "image size " + std::to_string(width) + " x " + std::to_string(height) + " px is not positive";
  if (params.size() != static_cast<size_t>(info.n_params)) {
    return std::string(info.name) + " needs " + std::to_string(info.n_params) + " parameters, found " + std::to_string(params.size());
  }
  for (size_t i = 0; i < params.size(); ++i) {
    if (!std::isfinite(params[i])) return "camera parameter " + std::to_string(i + 1) + " is not finite";
  }
  for (const double focal : {FocalX(), FocalY()}) {
    if (!(focal > 0.0)) return "focal length " + std::to_string(focal) + " px is not positive";
  }
  if (model == CameraModel::kFov && !(std::abs(params[4]) < std::numbers::pi)) {
    return "FOV's omega of " + std::to_string(params[4]) + " is not between -pi and pi";
  }
  return "";
}

double Camera::FocalX() const {
  CheckedInfo(*this);
  return params[0];
}

double Camera::FocalY() const {
  return params[CheckedInfo(*this).one_focal_length ? 0 : 1];
}

Eigen::Vector2d Camera::PrincipalPoint() const {
  const size_t first = CheckedInfo(*this).one_focal_length ? 1 : 2;
  return {params[first], params[first + 1]};
}

double Camera::MaxImageRadius() const {
  const Eigen::Vector2d middle = PrincipalPoint();
  return middle.cwiseAbs().cwiseMax((Eigen::Vector2d(width, height) - middle).cwiseAbs()).norm();
}

std::optional<Eigen::Vector2d> Camera::ImgFromCam(const Eigen::Vector3d& x_in_cam) const {
  if (!x_in_cam.allFinite() || !(x_in_cam.z() > 0.0)) return std::nullopt;
  const Eigen::Vector2d focal(FocalX(), FocalY());
  const std::optional<Eigen::Vector2d> distorted = DistortionOf(*this).Distort(x_in_cam);
  if (!distorted) return std::nullopt;
  const Eigen::Vector2d pixel = distorted->cwiseProduct(focal) + PrincipalPoint();
  // Overflow for points very close to the camera plane.
  if (!pixel.allFinite()) return std::nullopt;
  return pixel;
}

Eigen::Vector3d Camera::RayFromImg(const Eigen::Vector2d& pixel) const {
  return Lens(*this).RayFromImg(pixel);
}

Camera Camera::Resized(int new_width, int new_height) const {
  SKYQUILT_CHECK(width > 0 && height > 0 && new_width > 0 && new_height > 0,
                 std::to_string(width) + " x " + std::to_string(height) + " to " + std::to_string(new_width) + " x " + std::to_string(new_height));
  const double scale_x = static_cast<double>(new_width) / width;
  const double scale_y = static_cast<double>(new_height) / height;
  const bool one_focal_length = CheckedInfo(*this).one_focal_length;
  // Rounded sizes rarely keep the aspect ratio exactly; both axes then need their own focal length.
  const bool splits = one_focal_length && static_cast<int64_t>(new_width) * height != static_cast<int64_t>(new_height) * width;
  Camera resized = splits ? WithTwoFocalLengths(*this) : *this;
  resized.width = new_width;
  resized.height = new_height;
  if (one_focal_length && !splits) {
    resized.params[0] *= scale_x;
    resized.params[1] *= scale_x;
    resized.params[2] *= scale_y;
  } else {
    resized.params[0] *= scale_x;
    resized.params[1] *= scale_y;
    resized.params[2] *= scale_x;
    resized.params[3] *= scale_y;
  }
  return resized;
}

Distortion DistortionOf(const Camera& camera) {
  CheckedInfo(camera);
  const std::vector<double>& p = camera.params;
  switch (camera.model) {
    case CameraModel::kSimplePinhole:
    case CameraModel::kPinhole:
      break;
    case CameraModel::kSimpleRadial:
      return Distortion::Perspective({p[3]}, 0.0, 0.0);
    case CameraModel::kRadial:
      return Distortion::Perspective({p[3], p[4]}, 0.0, 0.0);
    case CameraModel::kOpencv:
      return Distortion::Perspective({p[4], p[5]}, p[6], p[7]);
    case CameraModel::kOpencvFisheye:
      return Distortion::Fisheye({p[4], p[5], p[6], p[7]});
    case CameraModel::kFullOpencv:
      return Distortion::Perspective({p[4], p[5], p[8], p[9], p[10], p[11]}, p[6], p[7]);
    case CameraModel::kFov:
      return Distortion::FieldOfView(p[4]);
    case CameraModel::kSimpleRadialFisheye:
      return Distortion::Fisheye({p[3]});
    case CameraModel::kRadialFisheye:
      return Distortion::Fisheye({p[3], p[4]});
    case CameraModel::kThinPrismFisheye:
      return Distortion::Fisheye({p[4], p[5], p[8], p[9]}, {.p1 = p[6], .p2 = p[7], .prism = {p[10], 0.0, p[11], 0.0}, .sequential = false});
    case CameraModel::kRadTanThinPrismFisheye:
      // Its p0 stands where OpenCV's p2 does.
      return Distortion::Fisheye({p[4], p[5], p[6], p[7], p[8], p[9]},
                                 {.p1 = p[11], .p2 = p[10], .prism = {p[12], p[13], p[14], p[15]}, .sequential = true});
  }
  return Distortion::Perspective({}, 0.0, 0.0);
}

double GroundSamplingDistance(const Camera& camera, double agl_m) {
  return agl_m / std::sqrt(camera.FocalX() * camera.FocalY());
}

}  // namespace skyquilt::camera
