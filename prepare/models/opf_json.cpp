#include "prepare/models/opf_json.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <unordered_map>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/json_document.h"
#include "core/base/log.h"
#include "core/geo/crs.h"
#include "core/geo/enu_frame.h"
#include "core/linear/linear.h"
#include "prepare/models/opf_points.h"

namespace skyquilt::prepare::models {
namespace {

using base::JsonDocument;
using base::JsonValue;

namespace fs = std::filesystem;

constexpr const char* kOpfFix = "Export the project as OPF again";

// The files of a project by their format.
class OpfProject {
 public:
  explicit OpfProject(const fs::path& file) : document_(file, kOpfFix), folder_(file.parent_path()) {
    const JsonValue root = document_.Root();
    if (root.At("format").Text() != "application/opf-project+json") root.At("format").Fail("is not application/opf-project+json");
    const JsonValue items = root.At("items");
    for (size_t i = 0; i < items.Size(); ++i) {
      const std::string type = items.At(i).At("type").Text();
      const JsonValue resources = items.At(i).At("resources");
      for (size_t k = 0; k < resources.Size(); ++k) {
        const JsonValue resource = resources.At(k);
        const fs::path uri = LocalPath(resource.At("uri"));
        files_.emplace(type + " " + resource.At("format").Text(), uri);
      }
    }
  }
  // The first file of this item with this format.
  std::optional<fs::path> Find(const std::string& item, const std::string& format) const {
    const auto found = files_.find(item + " " + format);
    if (found == files_.end()) return std::nullopt;
    return folder_ / found->second;
  }
  fs::path At(const std::string& item, const std::string& format) const {
    const std::optional<fs::path> file = Find(item, format);
    if (!file) {
      document_.Root().At("items").Fail("have no " + item + " with the format " + format, "Export the project as OPF again, after the calibration");
    }
    return *file;
  }

 private:
  static fs::path LocalPath(const JsonValue& uri) {
    const std::string text = uri.Text();
    if (text.find("://") != std::string::npos && !text.starts_with("file://")) uri.Fail("is not a file on this computer: " + text);
    return text.starts_with("file://") ? text.substr(7) : text;
  }

  JsonDocument document_;
  fs::path folder_;
  std::unordered_map<std::string, fs::path> files_;
};

// Names of photos by the id of their camera.
std::unordered_map<uint64_t, std::string> ReadCameraList(const fs::path& file, const ModelPhotos& photos) {
  const JsonDocument document(file, kOpfFix);
  const JsonValue cameras = document.Root().At("cameras");
  std::unordered_map<uint64_t, std::string> names;
  for (size_t i = 0; i < cameras.Size(); ++i) {
    std::string uri = cameras.At(i).At("uri").Text();
    if (uri.starts_with("file://")) uri = uri.substr(7);
    uri = uri.substr(0, uri.find('#'));
    names[cameras.At(i).At("id").Id()] = photos.Resolve(uri, file.parent_path());
  }
  return names;
}

std::unordered_map<uint64_t, Eigen::Vector2i> ReadImageSizes(const fs::path& file) {
  const JsonDocument document(file, kOpfFix);
  const JsonValue sensors = document.Root().At("sensors");
  std::unordered_map<uint64_t, Eigen::Vector2i> sizes;
  for (size_t i = 0; i < sensors.Size(); ++i) {
    const JsonValue size = sensors.At(i).At("image_size_px");
    if (size.Size() != 2) size.Fail("must have 2 numbers");
    sizes[sensors.At(i).At("id").Id()] = {size.At(0).Pixels(), size.At(1).Pixels()};
  }
  return sizes;
}

camera::Camera LensOfSensor(const JsonValue& sensor, const Eigen::Vector2i& size) {
  const JsonValue internals = sensor.At("internals");
  const JsonValue type = internals.At("type");
  if (type.Text() != "perspective")
    type.Fail("is " + type.Text() + ", whose lens cannot be used here",
              "Export undistorted photos with their cameras, for instance in COLMAP's format");
  const double focal = internals.At("focal_length_px").Positive();
  const std::vector<double> centre = internals.At("principal_point_px").Numbers(2);
  const std::vector<double> radial = internals.At("radial_distortion").Numbers(3);
  const std::vector<double> tangential = internals.At("tangential_distortion").Numbers(2);
  return PerspectiveCamera(size.x(), size.y(), {focal, focal}, {centre[0], centre[1]}, radial[0], radial[1], radial[2], tangential[0], tangential[1]);
}

geo::Rigid3d PoseOfCamera(const JsonValue& camera) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  const Vector3d angles = Eigen::Vector3d(camera.At("orientation_deg").Numbers(3).data()) * (std::numbers::pi / 180.0);
  const Eigen::Matrix3d frame_from_image =
      (AngleAxisd(angles.x(), Vector3d::UnitX()) * AngleAxisd(angles.y(), Vector3d::UnitY()) * AngleAxisd(angles.z(), Vector3d::UnitZ()))
          .toRotationMatrix();
  // From right, top, back to right, down, forward.
  return PoseFromCentre(frame_from_image * Vector3d(1.0, -1.0, -1.0).asDiagonal(), Eigen::Vector3d(camera.At("position").Numbers(3).data()));
}

// The system in which the positions are, with heights above a geoid left out where the project has a constant for them, or PROJ no grid: without it
// they are taken as ellipsoidal, which is tens of metres off, but the place on the map is right.
geo::Crs UsableSystem(const fs::path& file, geo::Crs system, bool has_constant, const Eigen::Vector3d& somewhere) {
  if (system.heights() != geo::CrsHeights::kGravity) return system;
  if (!has_constant) {
    try {
      system.ToGeodetic(somewhere);
      return system;
    } catch (const std::invalid_argument& error) {
      base::LogWarning("{}: its heights are taken as ellipsoidal ({})", file.string(), error.what());
    }
  }
  return system.WithoutHeights();
}

// The similarity that is nearest to the frame's map projection around the cameras.
std::optional<ModelPlace> PlaceOf(const fs::path& file, const survey::ColmapModel& sfm) {
  const JsonDocument document(file, kOpfFix);
  const JsonValue crs = document.Root().At("crs");
  const JsonValue definition = crs.At("definition");
  if (!definition.json().is_string()) definition.Fail("must be a text");
  const auto& text = definition.json().get_ref<const std::string&>();
  const JsonValue transform = document.Root().At("base_to_canonical");
  const Eigen::Vector3d shift(transform.At("shift").Numbers(3).data());
  const Eigen::Vector3d scale(transform.At("scale").Numbers(3).data());
  const bool swap_xy = transform.At("swap_xy").Boolean();
  if (!(scale.cwiseAbs().minCoeff() > 1e-9)) transform.At("scale").Fail("must not have a 0");
  const double geoid_height = crs.NumberOr0("geoid_height");
  if (text.find("ENGCRS") != std::string::npos || text.find("ENGINEERINGCRS") != std::string::npos || text.find("LOCAL_CS") != std::string::npos) {
    base::LogInfo("{}: the project has a local coordinate system, so its place on Earth comes from the photos", file.string());
    return std::nullopt;
  }
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const survey::ColmapImage& image : sfm.images) middle += image.cam_from_world.OriginInSource() / static_cast<double>(sfm.images.size());
  try {
    const auto base_of = [&](const Eigen::Vector3d& x_in_frame) {
      Eigen::Vector3d base = x_in_frame - shift;
      if (swap_xy) std::swap(base.x(), base.y());
      base = base.cwiseQuotient(scale);
      base.z() += geoid_height;
      return base;
    };
    geo::Crs whole(text, geo::AxisOrder::kAsDefined);
    const double height_unit_m = whole.heights() == geo::CrsHeights::kGravity ? whole.vertical().unit_m : 1.0;
    const geo::Crs system = UsableSystem(file, std::move(whole), crs.Find("geoid_height").has_value(), base_of(middle));
    const auto geodetic = [&](const Eigen::Vector3d& x_in_frame) {
      Eigen::Vector3d base = base_of(x_in_frame);
      if (system.heights() == geo::CrsHeights::kNone) base.z() *= height_unit_m;
      return system.ToGeodetic(base);
    };
    ModelPlace place{file.string(), geodetic(middle), {}};
    const geo::EnuFrame frame(place.origin);
    Eigen::Matrix<double, 3, 6> in_frame, in_enu;
    for (int i = 0; i < 6; ++i) {
      in_frame.col(i) = middle + (i % 2 == 0 ? 100.0 : -100.0) * Eigen::Vector3d::Unit(i / 2);
      in_enu.col(i) = frame.EnuFromGeodetic(geodetic(in_frame.col(i)));
    }
    const Eigen::Matrix4d fit = linear::Similarity(in_frame, in_enu);
    const Eigen::Matrix3d turn = fit.topLeftCorner<3, 3>();
    const std::optional<Eigen::Matrix3d> rotation = RotationOf(turn);
    if (!rotation) return std::nullopt;
    place.enu_from_model = {std::cbrt(turn.determinant()), Eigen::Quaterniond(*rotation), fit.topRightCorner<3, 1>()};
    return place;
  } catch (const std::invalid_argument& error) {
    base::LogWarning("{}: the coordinate system cannot be used ({}), so the place on Earth comes from the photos", file.string(), error.what());
    return std::nullopt;
  }
}

}  // namespace

InputModel ReadOpf(const fs::path& file, const ModelPhotos& photos) {
  const OpfProject project(file);
  const auto names = ReadCameraList(project.At("camera_list", "application/opf-camera-list+json"), photos);
  const auto sizes = ReadImageSizes(project.At("input_cameras", "application/opf-input-cameras+json"));
  base::ThrowIfCancelled();
  InputModel model;
  model.format = ModelFormat::kOpf;
  SfmBuilder builder(model.sfm);
  const JsonDocument calibrated(project.At("calibration", "application/opf-calibrated-cameras+json"), kOpfFix);
  std::unordered_map<uint64_t, uint32_t> camera_of_sensor, image_of_camera;
  const JsonValue sensors = calibrated.Root().At("sensors");
  for (size_t i = 0; i < sensors.Size(); ++i) {
    const uint64_t id = sensors.At(i).At("id").Id();
    const auto size = sizes.find(id);
    if (size == sizes.end()) sensors.At(i).Fail("is not among the sensors of the input cameras");
    camera_of_sensor[id] = builder.AddCamera(LensOfSensor(sensors.At(i), size->second));
  }
  const JsonValue cameras = calibrated.Root().At("cameras");
  if (cameras.Size() == 0) cameras.Fail("is empty", "Calibrate the project, then export it as OPF again");
  for (size_t i = 0; i < cameras.Size(); ++i) {
    const JsonValue camera = cameras.At(i);
    const uint64_t id = camera.At("id").Id();
    const auto name = names.find(id);
    if (name == names.end()) camera.Fail("has an id that is not in the camera list");
    const auto sensor = camera_of_sensor.find(camera.At("sensor_id").Id());
    if (sensor == camera_of_sensor.end()) camera.Fail("has a sensor_id that is not among the sensors");
    if (image_of_camera.contains(id)) camera.Fail("has an id that occurs twice");
    image_of_camera[id] = builder.AddImage(name->second, sensor->second, PoseOfCamera(camera));
  }
  if (const std::optional<fs::path> points = project.Find("calibration", "model/gltf+json")) AddOpfPoints(*points, image_of_camera, builder);
  if (const std::optional<fs::path> frame = project.Find("scene_reference_frame", "application/opf-scene-reference-frame+json")) {
    model.place = PlaceOf(*frame, model.sfm);
  }
  return model;
}

}  // namespace skyquilt::prepare::models
