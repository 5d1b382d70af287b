#include "tour/pictures/picture_request.h"

#include <array>
#include <charconv>
#include <type_traits>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "products/camera_path.h"

namespace skyquilt::tour {
namespace {

// Grows when the same request gives another picture or another file.
constexpr int kPictureVersion = 2;

template <typename T>
void AppendValue(const T& value, std::string* text) {
  static_assert(std::is_arithmetic_v<T>);
  text->append(reinterpret_cast<const char*>(&value), sizeof(value));
}

}  // namespace

PictureRequest PanoramaAt(const Eigen::Vector3d& eye_enu, int width, const std::string& exposure) {
  if (width < 2 || width % 2 != 0 || width > kMaxPanoramaWidth) {
    throw base::UsageError("a panorama " + std::to_string(width) + " pixels wide is not possible: the width must be even, from 2 to " +
                           std::to_string(kMaxPanoramaWidth));
  }
  PictureRequest request;
  request.kind = PictureKind::kPanorama;
  request.eye_enu = eye_enu;
  request.width = width;
  request.height = width / 2;
  request.exposure = exposure;
  return request;
}

PictureRequest StillAt(const Eigen::Vector3d& eye_enu, const Eigen::Quaterniond& cam_from_enu, double fovy_deg, int width, int height,
                       const std::string& exposure) {
  SKYQUILT_CHECK(width > 0 && height > 0 && fovy_deg > 0.0 && fovy_deg < 180.0, std::to_string(fovy_deg));
  PictureRequest request;
  request.kind = PictureKind::kStill;
  request.eye_enu = eye_enu;
  request.cam_from_enu = cam_from_enu;
  request.fovy_deg = fovy_deg;
  request.width = width;
  request.height = height;
  request.exposure = exposure;
  return request;
}

products::View ViewOfStill(const PictureRequest& still) {
  products::View view;
  view.camera = products::PinholeCamera(still.width, still.height, products::FovAcrossWidth(still.fovy_deg, still.width, still.height));
  view.cam_from_enu.rotation = still.cam_from_enu;
  view.cam_from_enu.translation = -(still.cam_from_enu * still.eye_enu);
  return view;
}

std::string ExposureText(std::optional<double> stops, const std::string& otherwise) {
  if (!stops) return otherwise;
  std::array<char, 32> text;
  const auto written = std::to_chars(text.data(), text.data() + text.size(), *stops);
  return {text.data(), written.ptr};
}

std::string KeyOf(const PictureRequest& request, const std::string& identity) {
  std::string text = identity;
  AppendValue(kPictureVersion, &text);
  AppendValue(static_cast<uint8_t>(request.kind), &text);
  AppendValue(request.width, &text);
  AppendValue(request.height, &text);
  for (const double value : request.eye_enu) AppendValue(value, &text);
  if (request.kind == PictureKind::kStill) {
    for (const double value : request.cam_from_enu.coeffs()) AppendValue(value, &text);
    AppendValue(request.fovy_deg, &text);
  }
  text.append(request.exposure);
  return base::HashHex(text);
}

}  // namespace skyquilt::tour
