#include "odm/report/shots.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/json_text.h"
#include "core/base/text.h"
#include "core/geo/enu_frame.h"

namespace skyquilt::odm {
namespace {

using Json = nlohmann::ordered_json;
using camera::CameraModel;

// Programs ask for photos by their names without folders.
std::string FileName(const std::string& photo) {
  return std::filesystem::path(photo).filename().string();
}

double LongerSide(const camera::Camera& camera) {
  return std::max(camera.width, camera.height);
}

bool IsCentred(const camera::Camera& camera) {
  return (camera.PrincipalPoint() - 0.5 * Eigen::Vector2d(camera.width, camera.height)).norm() < 1e-6 * LongerSide(camera);
}

// Distortion of COLMAP's models, by OpenSfM's names.
struct Lens {
  std::string projection;
  std::vector<std::pair<const char*, double>> terms;
};

Lens LensOf(const camera::Camera& camera) {
  const std::vector<double>& p = camera.params;
  const auto at = [&p](size_t i) { return p.at(i); };
  switch (camera.model) {
    case CameraModel::kSimplePinhole:
    case CameraModel::kPinhole:
      return {"brown", {{"k1", 0.0}, {"k2", 0.0}, {"p1", 0.0}, {"p2", 0.0}, {"k3", 0.0}}};
    case CameraModel::kSimpleRadial:
      if (IsCentred(camera)) return {"perspective", {{"k1", at(3)}, {"k2", 0.0}}};
      return {"brown", {{"k1", at(3)}, {"k2", 0.0}, {"p1", 0.0}, {"p2", 0.0}, {"k3", 0.0}}};
    case CameraModel::kRadial:
      if (IsCentred(camera)) return {"perspective", {{"k1", at(3)}, {"k2", at(4)}}};
      return {"brown", {{"k1", at(3)}, {"k2", at(4)}, {"p1", 0.0}, {"p2", 0.0}, {"k3", 0.0}}};
    case CameraModel::kOpencv:
      return {"brown", {{"k1", at(4)}, {"k2", at(5)}, {"p1", at(6)}, {"p2", at(7)}, {"k3", 0.0}}};
    case CameraModel::kFullOpencv:
      if (at(9) == 0.0 && at(10) == 0.0 && at(11) == 0.0) {
        return {"brown", {{"k1", at(4)}, {"k2", at(5)}, {"p1", at(6)}, {"p2", at(7)}, {"k3", at(8)}}};
      }
      break;
    case CameraModel::kOpencvFisheye:
      return {"fisheye_opencv", {{"k1", at(4)}, {"k2", at(5)}, {"k3", at(6)}, {"k4", at(7)}}};
    case CameraModel::kSimpleRadialFisheye:
      return {"fisheye_opencv", {{"k1", at(3)}, {"k2", 0.0}, {"k3", 0.0}, {"k4", 0.0}}};
    case CameraModel::kRadialFisheye:
      return {"fisheye_opencv", {{"k1", at(3)}, {"k2", at(4)}, {"k3", 0.0}, {"k4", 0.0}}};
    case CameraModel::kFov:
    case CameraModel::kThinPrismFisheye:
    case CameraModel::kRadTanThinPrismFisheye:
      break;
  }
  return {base::LowerCase(camera::ModelName(camera.model)), {}};
}

Json CameraJson(const camera::Camera& camera) {
  const Lens lens = LensOf(camera);
  const double unit = LongerSide(camera);
  Json json = {{"projection_type", lens.projection}, {"width", camera.width}, {"height", camera.height}};
  if (lens.projection == "perspective") {
    json["focal"] = camera.FocalX() / unit;
  } else {
    json["focal_x"] = camera.FocalX() / unit;
    json["focal_y"] = camera.FocalY() / unit;
    json["c_x"] = (camera.PrincipalPoint().x() - 0.5 * camera.width) / unit;
    json["c_y"] = (camera.PrincipalPoint().y() - 0.5 * camera.height) / unit;
  }
  for (const auto& [name, value] : lens.terms) json[name] = value;
  if (lens.terms.empty()) json["params"] = camera.params;
  return json;
}

Json PointJson(const survey::Survey& survey, const surface::MapFrame& frame, const Eigen::Vector3d& x_in_enu) {
  const geo::EnuFrame enu(survey.origin);
  const geo::Geodetic place = enu.GeodeticFromEnu(x_in_enu);
  const double height = frame.MapFromEnu(x_in_enu).z();
  return {{"type", "Point"}, {"coordinates", {place.longitude_deg, place.latitude_deg, height}}};
}

Json Triple(const Eigen::Vector3d& values) {
  return Json::array({base::NumberOrNull(values.x()), base::NumberOrNull(values.y()), base::NumberOrNull(values.z())});
}

Json OrNull(const std::optional<double>& value) {
  return value ? base::NumberOrNull(*value) : Json(nullptr);
}

Json Collection(Json features) {
  return {{"type", "FeatureCollection"}, {"features", std::move(features)}};
}

// Null members are filled from the tags as far as these know.
Json ImageRow(const std::string& name, const survey::PhotoTags* tags) {
  Json row = {{"filename", FileName(name)}, {"path", name}, {"width", nullptr}, {"height", nullptr}};
  for (const char* key : {"camera_make", "camera_model", "latitude", "longitude", "altitude", "utc_time", "fnumber", "exposure_time", "iso_speed"}) {
    row[key] = nullptr;
  }
  row["has_pose"] = false;
  if (tags == nullptr) return row;
  row["camera_make"] = tags->make;
  row["camera_model"] = tags->model;
  if (tags->gps) {
    row["latitude"] = tags->gps->latitude_deg;
    row["longitude"] = tags->gps->longitude_deg;
    row["altitude"] = base::NumberOrNull(tags->gps->height_m);
  }
  if (tags->capture_time_s) row["utc_time"] = 1000.0 * *tags->capture_time_s;  // milliseconds
  row["fnumber"] = OrNull(tags->exposure.f_number);
  row["exposure_time"] = OrNull(tags->exposure.time_s);
  row["iso_speed"] = OrNull(tags->exposure.iso);
  return row;
}

}  // namespace

surface::MapFrame FrameOf(const survey::Survey& survey, geo::Vertical vertical) {
  scene::SceneInfo info;
  info.origin = survey.origin;
  info.georeferenced = survey.georeferenced;
  info.accuracy = survey.fit.accuracy;
  info.height_reference = survey.height_reference;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const survey::Photo& photo : survey.photos) sum += photo.cam_from_enu.OriginInSource();
  info.min_enu = info.max_enu = sum / std::max<double>(1.0, static_cast<double>(survey.photos.size()));
  return surface::MapFrame(info, vertical);
}

std::string CameraKey(const survey::Survey& survey, int index) {
  const camera::Camera& camera = survey.cameras.at(static_cast<size_t>(index));
  std::string name = base::LowerCase(survey.checks.camera_name);
  if (name.empty() || survey.cameras.size() > 1) name = "camera " + std::to_string(index);
  return fmt::format("v2 {} {} {} {} {:.4f}", name, camera.width, camera.height, LensOf(camera).projection, camera.FocalX() / LongerSide(camera));
}

Json CamerasJson(const survey::Survey& survey) {
  std::set<int> used;
  for (const survey::Photo& photo : survey.photos) used.insert(photo.camera);
  Json cameras = Json::object();
  for (const int index : used) cameras[CameraKey(survey, index)] = CameraJson(survey.cameras.at(static_cast<size_t>(index)));
  return cameras;
}

Json ShotsJson(const survey::Survey& survey, const surface::MapFrame& frame, const std::vector<survey::PhotoTags>& tags) {
  Json features = Json::array();
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const survey::Photo& photo = survey.photos[i];
    const camera::Camera& camera = survey.cameras.at(static_cast<size_t>(photo.camera));
    const Eigen::Vector3d centre = photo.cam_from_enu.OriginInSource();
    const Eigen::Matrix3d cam_from_map = photo.cam_from_enu.rotation.toRotationMatrix() * frame.map_from_enu().transpose();
    const Eigen::AngleAxisd turn(Eigen::Quaterniond(cam_from_map).normalized());
    const double time_s = i < tags.size() && tags[i].capture_time_s ? *tags[i].capture_time_s : 0.0;
    features.push_back({{"type", "Feature"},
                        {"properties",
                         {{"filename", FileName(photo.name)},
                          {"camera", CameraKey(survey, photo.camera)},
                          {"focal", camera.FocalX() / LongerSide(camera)},
                          {"width", camera.width},
                          {"height", camera.height},
                          {"capture_time", time_s},
                          {"translation", Triple(frame.MapFromEnu(centre))},
                          {"rotation", Triple(turn.angle() * turn.axis())}}},
                        {"geometry", PointJson(survey, frame, centre)}});
  }
  return Collection(std::move(features));
}

Json ImagesJson(const survey::Survey& survey, const std::vector<survey::PhotoTags>& tags) {
  Json rows = Json::array();
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const survey::Photo& photo = survey.photos[i];
    const camera::Camera& camera = survey.cameras.at(static_cast<size_t>(photo.camera));
    Json row = ImageRow(photo.name, i < tags.size() ? &tags[i] : nullptr);
    row["width"] = camera.width;
    row["height"] = camera.height;
    row["has_pose"] = true;
    rows.push_back(std::move(row));
  }
  for (const std::string& name : survey.unregistered) rows.push_back(ImageRow(name, nullptr));
  return rows;
}

Json ControlPointsJson(const survey::Survey& survey, const surface::MapFrame& frame) {
  Json features = Json::array();
  for (const survey::ControlPointFit& point : survey.control.points) {
    Eigen::Vector3d given = point.given_in_enu;
    if (std::isnan(given.z())) given.z() = 0.0;
    const Eigen::Vector3d estimated = point.given_in_enu + point.error_m;
    Json observations = Json::array();
    for (const survey::ControlMarkFit& mark : point.marks) {
      const auto photo =
          std::find_if(survey.photos.begin(), survey.photos.end(), [&mark](const survey::Photo& one) { return one.name == mark.photo; });
      if (photo == survey.photos.end() || !estimated.allFinite()) continue;
      const camera::Camera& camera = survey.cameras.at(static_cast<size_t>(photo->camera));
      const std::optional<Eigen::Vector2d> pixel = camera.ImgFromCam(photo->cam_from_enu * estimated);
      if (!pixel) continue;
      const auto share = [&camera](const Eigen::Vector2d& at) { return Json::array({at.x() / camera.width, at.y() / camera.height}); };
      observations.push_back(
          {{"shot_id", FileName(mark.photo)}, {"annotated", share(mark.pixel)}, {"reprojected", share(*pixel)}, {"used", mark.used}});
    }
    const bool check = point.use == survey::ControlUse::kCheck;
    Json properties = {{"id", (check ? "CHK-" : "") + point.label}, {"use", survey::NameOf(point.use)}, {"error", Triple(point.error_m)}};
    // WebODM opens the first of them.
    if (!observations.empty()) properties["observations"] = std::move(observations);
    features.push_back({{"type", "Feature"}, {"properties", std::move(properties)}, {"geometry", PointJson(survey, frame, given)}});
  }
  return Collection(std::move(features));
}

}  // namespace skyquilt::odm
