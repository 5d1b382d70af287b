#include "prepare/models/opensfm_json.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <sstream>
#include <unordered_map>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_document.h"
#include "core/base/log.h"

namespace skyquilt::prepare::models {
namespace {

using base::JsonDocument;
using base::JsonValue;

namespace fs = std::filesystem;

constexpr const char* kOpensfmFix = "Run OpenSfM's 'reconstruct' or OpenDroneMap's stage opensfm again";

// Scaled to the photos where only the scale differs.
Eigen::Vector2i SizeInPixels(const JsonValue& camera, std::optional<Eigen::Vector2i> photo) {
  const Eigen::Vector2i stated(camera.At("width").Pixels(), camera.At("height").Pixels());
  if (!photo) return stated;
  const int64_t difference = int64_t{stated.x()} * photo->y() - int64_t{stated.y()} * photo->x();
  return std::abs(difference) <= std::max(stated.maxCoeff(), photo->maxCoeff()) ? *photo : stated;
}

camera::Camera ToCamera(const JsonValue& camera, const Eigen::Vector2i& size) {
  const std::string type = camera.At("projection_type").Text();
  const double unit = size.maxCoeff();
  const Eigen::Vector2d middle = 0.5 * size.cast<double>();
  const auto number = [&](const char* key) { return camera.NumberOr0(key); };
  if (type == "perspective" || type == "fisheye") {
    const Eigen::Vector2d focal = Eigen::Vector2d::Constant(unit * camera.At("focal").Positive());
    if (type == "fisheye") return FisheyeCamera(size.x(), size.y(), focal, middle, {number("k1"), number("k2"), 0.0, 0.0});
    return PerspectiveCamera(size.x(), size.y(), focal, middle, number("k1"), number("k2"), 0.0, 0.0, 0.0);
  }
  const bool fisheye = type == "fisheye_opencv";
  if (!fisheye && type != "brown" && type != "radial" && type != "simple_radial") {
    camera.At("projection_type")
        .Fail("is " + type + ", which cannot be read", "Run OpenSfM again with camera_projection_type BROWN (OpenDroneMap: --camera-lens brown)");
  }
  const double focal_x = camera.At("focal_x").Positive();
  const std::optional<JsonValue> focal_y = camera.Find("focal_y");
  const Eigen::Vector2d focal(unit * focal_x, unit * (focal_y ? focal_y->Positive() : focal_x));
  const Eigen::Vector2d centre = middle + unit * Eigen::Vector2d(number("c_x"), number("c_y"));
  if (fisheye) {
    for (const char* key : {"p1", "p2"}) {
      if (number(key) != 0.0)
        camera.Fail(std::string("has ") + key + " with fisheye_opencv, which cannot be used here",
                    "Undistort the photos with OpenSfM's 'undistort' and use their model, or run it with camera_projection_type FISHEYE");
    }
    return FisheyeCamera(size.x(), size.y(), focal, centre, {number("k1"), number("k2"), number("k3"), number("k4")});
  }
  return PerspectiveCamera(size.x(), size.y(), focal, centre, number("k1"), number("k2"), number("k3"), number("p1"), number("p2"));
}

geo::Rigid3d PoseOfShot(const JsonValue& shot) {
  const Eigen::Vector3d rotation(shot.At("rotation").Numbers(3).data());
  const double angle = rotation.norm();
  const Eigen::Quaterniond cam_from_world =
      angle > 0.0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation / angle)) : Eigen::Quaterniond::Identity();
  return {cam_from_world, Eigen::Vector3d(shot.At("translation").Numbers(3).data())};
}

JsonValue LargestReconstruction(const JsonDocument& document) {
  const JsonValue root = document.Root();
  if (root.Size() == 0) root.Fail("has no reconstruction");
  size_t best = 0, n_best = 0, n_all = 0;
  for (size_t i = 0; i < root.Size(); ++i) {
    const JsonValue shots = root.At(i).At("shots");
    if (!shots.IsObject()) shots.Fail("must be an object with a member per photo");
    const size_t n = shots.json().size();
    n_all += n;
    if (n <= n_best) continue;
    best = i;
    n_best = n;
  }
  if (n_best == 0) root.Fail("has no photos");
  if (root.Size() > 1) {
    base::LogWarning("{} has {} reconstructions that do not hang together; the largest is used, with {} of {} photos", document.file().string(),
                     root.Size(), n_best, n_all);
  }
  return root.At(best);
}

std::optional<ModelPlace> PlaceOf(const JsonValue& lla, const std::string& source) {
  const geo::Geodetic origin{lla.At("latitude").Number(), lla.At("longitude").Number(), lla.NumberOr0("altitude")};
  if (origin.latitude_deg == 0.0 && origin.longitude_deg == 0.0) return std::nullopt;  // written when no photo has GPS
  if (!geo::IsValid(origin)) lla.Fail("is not a latitude and a longitude");
  return ModelPlace{source, {origin.latitude_deg, geo::WrapLongitudeDeg(origin.longitude_deg), origin.height_m}, {}};
}

// OPENSFM_TRACKS_VERSION_v1 or v2: per line photo, track and more, separated by tabs.
std::unordered_map<std::string, std::vector<uint32_t>> ReadTracksTable(const fs::path& file, const std::map<std::string, uint32_t>& image_of_shot) {
  std::unordered_map<std::string, std::vector<uint32_t>> photos_of_track;
  std::istringstream lines(base::ReadFile(file));
  size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.empty() || line.starts_with("OPENSFM_TRACKS_VERSION")) continue;
    const size_t first = line.find('\t');
    const size_t second = first == std::string::npos ? first : line.find('\t', first + 1);
    if (second == std::string::npos)
      throw base::InputError(file, "line " + std::to_string(number) + ": is not a photo and a track, separated by tabs",
                             "Run OpenSfM's 'create_tracks' again, or move the file away to go on without tracks");
    const auto image = image_of_shot.find(line.substr(0, first));
    if (image != image_of_shot.end()) photos_of_track[line.substr(first + 1, second - first - 1)].push_back(image->second);
  }
  return photos_of_track;
}

void AddPoints(const JsonValue& points, const fs::path& tracks_file, const std::map<std::string, uint32_t>& image_of_shot, SfmBuilder& builder) {
  std::unordered_map<std::string, std::vector<uint32_t>> photos_of_track;
  if (fs::exists(tracks_file)) photos_of_track = ReadTracksTable(tracks_file, image_of_shot);
  for (const auto& [id, point] : points.Members()) {
    std::array<uint8_t, 3> rgb{};
    if (const std::optional<JsonValue> color = point.Find("color")) {
      const Eigen::Vector3d value(color->Numbers(3).data());
      for (int i = 0; i < 3; ++i) rgb[static_cast<size_t>(i)] = static_cast<uint8_t>(std::clamp(value[i], 0.0, 255.0));
    }
    const auto track = photos_of_track.find(id);
    builder.AddPoint(Eigen::Vector3d(point.At("coordinates").Numbers(3).data()), rgb,
                     track == photos_of_track.end() ? std::vector<uint32_t>{} : track->second);
  }
}

}  // namespace

InputModel ReadOpensfm(const fs::path& file, const ModelPhotos& photos) {
  const JsonDocument document(file, kOpensfmFix);
  const JsonValue reconstruction = LargestReconstruction(document);
  base::ThrowIfCancelled();
  InputModel model;
  model.format = ModelFormat::kOpensfm;
  SfmBuilder builder(model.sfm);
  const JsonValue cameras = reconstruction.At("cameras");
  const auto shots = reconstruction.At("shots").Members();
  // The size of a camera's photos is that of the first one that is there.
  std::map<std::string, std::optional<Eigen::Vector2i>> sizes;
  for (const auto& [shot_name, shot] : shots) {
    std::optional<Eigen::Vector2i>& size = sizes[shot.At("camera").Text()];
    if (!size) size = photos.SizeOf(photos.Resolve(shot_name, file.parent_path()));
  }
  std::map<std::string, uint32_t> camera_ids, image_of_shot;
  for (const auto& [camera_name, size] : sizes) {
    const JsonValue camera = cameras.At(camera_name);
    camera_ids[camera_name] = builder.AddCamera(ToCamera(camera, SizeInPixels(camera, size)));
  }
  for (const auto& [shot_name, shot] : shots) {
    const std::string name = photos.Resolve(shot_name, file.parent_path());
    image_of_shot[shot_name] = builder.AddImage(name, camera_ids[shot.At("camera").Text()], PoseOfShot(shot));
  }
  if (const std::optional<JsonValue> points = reconstruction.Find("points")) {
    AddPoints(*points, file.parent_path() / "tracks.csv", image_of_shot, builder);
  }
  const fs::path reference = file.parent_path() / "reference_lla.json";
  if (const std::optional<JsonValue> lla = reconstruction.Find("reference_lla")) {
    model.place = PlaceOf(*lla, file.string());
  } else if (fs::exists(reference)) {
    const JsonDocument lla_file(reference, kOpensfmFix);
    model.place = PlaceOf(lla_file.Root(), reference.string());
  }
  return model;
}

}  // namespace skyquilt::prepare::models
