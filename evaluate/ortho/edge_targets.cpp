#include "evaluate/ortho/edge_targets.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/image/srgb.h"
#include "evaluate/ortho/slanted_edge.h"
#include "evaluate/ortho/true_map.h"
#include "evaluate/surface/true_surface.h"

namespace skyquilt::evaluate::ortho {
namespace {

// Part of a target's side that is used: its rim, and what is beside it, is blurred into it, and the geo-reference may be off.
constexpr double kUsedPart = 0.75;
constexpr size_t kPhotosTried = 4;

float Luminance(const float* rgb) {
  return 0.2126F * image::LinearFromSrgb(rgb[0]) + 0.7152F * image::LinearFromSrgb(rgb[1]) + 0.0722F * image::LinearFromSrgb(rgb[2]);
}

// Half the side, rounded down, of the upright square inside a square whose sides have this length and stand at this angle.
int InnerHalf(double side, double angle_rad) {
  return static_cast<int>(std::floor(kUsedPart * 0.5 * side / (std::abs(std::cos(angle_rad)) + std::abs(std::sin(angle_rad)))));
}

double InMap(const EdgeTarget& target, const gis::MapReader& map, const skyquilt::surface::MapFrame& frame) {
  const Eigen::Vector3d along_edge(std::cos(target.yaw_rad), std::sin(target.yaw_rad), 0.0);
  const Eigen::Vector2d centre = map.grid().CellOf(frame.MapFromEnu(target.centre_enu).head<2>());
  const Eigen::Vector2d end = map.grid().CellOf(frame.MapFromEnu(target.centre_enu + along_edge).head<2>());
  if (!centre.allFinite() || centre.cwiseAbs().maxCoeff() > 1e8) return kNotMeasured;
  const int half = InnerHalf(target.side_m / map.grid().resolution_m, std::atan2(end.y() - centre.y(), end.x() - centre.x()));
  if (half < 1) return kNotMeasured;
  const int x = static_cast<int>(std::lround(centre.x())) - half, y = static_cast<int>(std::lround(centre.y())) - half;
  const MapPart part = ReadPart(map, x, y, 2 * half + 1, 2 * half + 1);
  if (std::count(part.known.data.begin(), part.known.data.end(), 0) > 0) return kNotMeasured;
  image::ImageF luminance(part.rgb.width, part.rgb.height, 1);
  for (size_t i = 0; i < luminance.data.size(); ++i) luminance.data[i] = Luminance(&part.rgb.data[3 * i]);
  return SlantedEdgeMtf50(luminance);
}

// Training photos that show the target, the one most nearly above it first.
std::vector<size_t> PhotosAbove(const EdgeTarget& target, const survey::Survey& survey) {
  std::vector<std::pair<double, size_t>> found;  // tangent of the angle from the vertical
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const survey::Photo& photo = survey.photos[i];
    if (photo.is_test) continue;
    const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
    const std::optional<Eigen::Vector2d> pixel = camera.ImgFromCam(photo.cam_from_enu * target.centre_enu);
    if (!pixel || !(pixel->minCoeff() >= 0.0) || pixel->x() > camera.width || pixel->y() > camera.height) continue;
    const Eigen::Vector3d to_camera = photo.cam_from_enu.OriginInSource() - target.centre_enu;
    if (to_camera.z() > 0.0) found.emplace_back(to_camera.head<2>().norm() / to_camera.z(), i);
  }
  std::sort(found.begin(), found.end());
  std::vector<size_t> photos;
  for (const auto& [slant, photo] : found) photos.push_back(photo);
  return photos;
}

struct PhotoSharpness {
  double per_px = kNotMeasured, per_m = kNotMeasured;
};

PhotoSharpness InPhoto(const EdgeTarget& target, const survey::Survey& survey, const survey::Photo& photo) {
  const std::filesystem::path file = survey.photo_root / photo.name;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return {};
  const image::Image8 pixels = image::LoadRgb8(file);
  const camera::Camera camera = survey.cameras[static_cast<size_t>(photo.camera)].Resized(pixels.width, pixels.height);
  const auto seen = [&](double east, double north) {
    return camera.ImgFromCam(photo.cam_from_enu * (target.centre_enu + Eigen::Vector3d(east, north, 0.0)));
  };
  const double half_m = 0.5 * target.side_m, along_x = std::cos(target.yaw_rad), along_y = std::sin(target.yaw_rad);
  const auto centre = seen(0.0, 0.0), end = seen(half_m * along_x, half_m * along_y), beside = seen(-half_m * along_y, half_m * along_x);
  if (!centre || !end || !beside) return {};
  const Eigen::Vector2d edge = *end - *centre;
  const double across_px = 2.0 * (*beside - *centre).norm();
  const int half = InnerHalf(std::min(across_px, 2.0 * edge.norm()), std::atan2(edge.y(), edge.x()));
  const int left = static_cast<int>(std::floor(centre->x())) - half, top = static_cast<int>(std::floor(centre->y())) - half, size = 2 * half + 1;
  if (half < 1 || left < 0 || top < 0 || left + size > pixels.width || top + size > pixels.height) return {};
  image::ImageF luminance(size, size, 1);
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const uint8_t* const rgb = pixels.At(left + x, top + y);
      const float display[3] = {static_cast<float>(rgb[0]) / 255.0F, static_cast<float>(rgb[1]) / 255.0F, static_cast<float>(rgb[2]) / 255.0F};
      *luminance.At(x, y) = Luminance(display);
    }
  }
  const double per_px = SlantedEdgeMtf50(luminance);
  return {per_px, per_px * across_px / target.side_m};
}

}  // namespace

std::vector<EdgeTarget> ReadEdgeTargets(const std::filesystem::path& edge_targets_json, const geo::Geodetic& survey_origin,
                                        const Eigen::Vector2d& shift_m) {
  const geo::Rigid3d survey_from_truth =
      evaluate::surface::SurveyFromTruth(edge_targets_json.parent_path().parent_path() / "simulate.json", survey_origin);
  std::vector<EdgeTarget> targets;
  try {
    const nlohmann::json json = base::ParseJson(base::ReadFile(edge_targets_json));
    for (const nlohmann::json& one : json.at("targets")) {
      const nlohmann::json& centre = one.at("centre_enu");
      EdgeTarget& target = targets.emplace_back();
      target.centre_enu = survey_from_truth * Eigen::Vector3d(centre.at(0).get<double>(), centre.at(1).get<double>(), centre.at(2).get<double>());
      target.centre_enu.head<2>() += shift_m;
      target.side_m = one.at("side_m").get<double>();
      target.yaw_rad = one.at("yaw_deg").get<double>() * std::numbers::pi / 180.0;
    }
  } catch (const nlohmann::json::exception& error) {
    throw base::InputError(edge_targets_json, std::string("is damaged (") + error.what() + ")", "Run 'skyquilt simulate' again");
  }
  return targets;
}

EdgeSharpness MeasureSharpness(const std::vector<EdgeTarget>& targets, const gis::MapReader& map, const survey::Survey& survey,
                               const skyquilt::surface::MapFrame& frame) {
  EdgeSharpness sharpness;
  std::vector<double> in_map, per_px, per_m;
  for (const EdgeTarget& target : targets) {
    in_map.push_back(InMap(target, map, frame));
    if (std::isfinite(in_map.back())) ++sharpness.targets;
    std::vector<size_t> photos = PhotosAbove(target, survey);
    if (photos.size() > kPhotosTried) photos.resize(kPhotosTried);
    for (const size_t photo : photos) {
      const PhotoSharpness in_photo = InPhoto(target, survey, survey.photos[photo]);
      if (!std::isfinite(in_photo.per_px)) continue;
      per_px.push_back(in_photo.per_px);
      per_m.push_back(in_photo.per_m);
      break;
    }
  }
  sharpness.map_per_cell = MedianOfMeasured(in_map);
  sharpness.map_per_m = sharpness.map_per_cell / map.grid().resolution_m;
  sharpness.photo_per_px = MedianOfMeasured(per_px);
  sharpness.photo_per_m = MedianOfMeasured(per_m);
  return sharpness;
}

}  // namespace skyquilt::evaluate::ortho
