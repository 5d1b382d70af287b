#include "prepare/models/metashape_xml.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <pugixml.hpp>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_document.h"
#include "core/base/log.h"
#include "core/geo/ecef.h"

namespace skyquilt::prepare::models {
namespace {

namespace fs = std::filesystem;

constexpr const char* kXmlFix = "Export the cameras of Metashape again (File > Export > Export Cameras, Agisoft XML)";
constexpr int kMaxNesting = 64;  // of groups of cameras

struct Aligned {
  pugi::xml_node camera;
  std::string component;
};

class MetashapeFile {
 public:
  MetashapeFile(const fs::path& file, const ModelPhotos& photos) : file_(file), photos_(&photos), text_(base::ReadFile(file)) {}

  InputModel Read() {
    const pugi::xml_parse_result result = document_.load_buffer(text_.data(), text_.size());
    if (!result)
      FailAt(static_cast<size_t>(std::max<std::ptrdiff_t>(result.offset, 0)), std::string("is not XML (") + result.description() + ")", kXmlFix);
    const pugi::xml_node root = document_.child("document");
    if (!root) throw base::InputError(file_, "line 1: has no <document>, as Metashape's XML has", kXmlFix);
    InputModel model;
    model.format = ModelFormat::kMetashape;
    const pugi::xml_node chunk = ChunkToRead(root);
    std::vector<Aligned> aligned = AlignedOf(chunk);
    const std::string component = KeepLargestComponent(aligned);
    SfmBuilder builder(model.sfm);
    ReadSensors(chunk);
    std::map<std::string, bool> seen;
    for (const Aligned& entry : aligned) {
      base::ThrowIfCancelled();
      AddImage(entry.camera, builder, seen);
    }
    model.place = Place(chunk, component, model.sfm);
    return model;
  }

 private:
  [[noreturn]] void FailAt(size_t offset, const std::string& found, const std::string& fix) const {
    throw base::InputError(file_, "line " + std::to_string(base::LineOf(text_, std::min(offset, text_.size()))) + ": " + found, fix);
  }
  [[noreturn]] void Fail(const pugi::xml_node& node, const std::string& found, const std::string& fix = kXmlFix) const {
    FailAt(static_cast<size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0)), std::string("<") + node.name() + "> " + found, fix);
  }

  pugi::xml_node Child(const pugi::xml_node& parent, const char* name) const {
    const pugi::xml_node child = parent.child(name);
    if (!child) Fail(parent, std::string("has no <") + name + ">");
    return child;
  }
  std::string Attribute(const pugi::xml_node& node, const char* name) const {
    const std::string value = node.attribute(name).value();
    if (value.empty() || value.size() > 4096) Fail(node, std::string("has no ") + name);
    return value;
  }
  int Pixels(const pugi::xml_node& node, const char* name) const {
    const std::string text = Attribute(node, name);
    int value = 0;
    const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
    if (result.ec != std::errc() || result.ptr != text.data() + text.size() || value < 1 || value > 1000000)
      Fail(node, std::string("has a ") + name + " of '" + text + "', which is not a number of pixels");
    return value;
  }
  std::vector<double> Numbers(const pugi::xml_node& node, size_t count) const {
    const std::string_view text = node.child_value();
    std::vector<double> numbers;
    size_t at = text.find_first_not_of(" \t\r\n");
    while (at < text.size() && numbers.size() <= count) {
      double value = 0.0;
      const auto result = std::from_chars(text.data() + at, text.data() + text.size(), value);
      if (result.ec != std::errc() || !(std::abs(value) <= 1e9)) Fail(node, "must have " + std::to_string(count) + " numbers up to 1e9");
      numbers.push_back(value);
      at = std::min(text.find_first_not_of(" \t\r\n", static_cast<size_t>(result.ptr - text.data())), text.size());
    }
    if (numbers.size() != count) Fail(node, "must have " + std::to_string(count) + (count == 1 ? " number" : " numbers"));
    return numbers;
  }
  double NumberOr0(const pugi::xml_node& calibration, const char* name) const {
    const pugi::xml_node child = calibration.child(name);
    return child ? Numbers(child, 1)[0] : 0.0;
  }

  // Groups hold cameras too.
  void CollectCameras(const pugi::xml_node& parent, int depth, std::vector<pugi::xml_node>& cameras) const {
    for (const pugi::xml_node& child : parent.children()) {
      const std::string_view name = child.name();
      if (name == "camera") cameras.push_back(child);
      if (name == "group" && depth < kMaxNesting) CollectCameras(child, depth + 1, cameras);
    }
  }
  std::vector<Aligned> AlignedOf(const pugi::xml_node& chunk) const {
    std::vector<pugi::xml_node> cameras;
    CollectCameras(chunk.child("cameras"), 0, cameras);
    std::vector<Aligned> aligned;
    for (const pugi::xml_node& camera : cameras) {
      if (camera.child("transform")) aligned.push_back({camera, camera.attribute("component_id").value()});
    }
    return aligned;
  }
  pugi::xml_node ChunkToRead(const pugi::xml_node& root) const {
    pugi::xml_node chosen;
    int others = 0;
    for (const pugi::xml_node& chunk : root.children("chunk")) {
      if (AlignedOf(chunk).empty()) continue;
      if (chosen) {
        ++others;
      } else {
        chosen = chunk;
      }
    }
    if (!chosen)
      Fail(root, "has no chunk with an aligned camera (no <camera> has a <transform>)", "Align the photos in Metashape, then export again");
    if (others > 0) base::LogWarning("{}: {} more chunks have aligned cameras; only the first is used", file_.string(), others);
    return chosen;
  }
  // Components are not in one frame.
  std::string KeepLargestComponent(std::vector<Aligned>& aligned) const {
    std::map<std::string, size_t> counts;
    for (const Aligned& entry : aligned) ++counts[entry.component];
    const auto largest = std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    if (counts.size() > 1)
      base::LogWarning("{}: the cameras form {} components that do not hang together; the largest is used, with {} of {}", file_.string(),
                       counts.size(), largest->second, aligned.size());
    std::erase_if(aligned, [&](const Aligned& entry) { return entry.component != largest->first; });
    return largest->first;
  }

  void ReadSensors(const pugi::xml_node& chunk) {
    for (const pugi::xml_node& sensor : Child(chunk, "sensors").children("sensor")) sensors_.emplace(Attribute(sensor, "id"), sensor);
  }
  camera::Camera LensOf(const pugi::xml_node& sensor) const {
    pugi::xml_node calibration = sensor.find_child_by_attribute("calibration", "class", "adjusted");
    if (!calibration) calibration = Child(sensor, "calibration");
    const pugi::xml_node resolution = calibration.child("resolution") ? calibration.child("resolution") : Child(sensor, "resolution");
    const int width = Pixels(resolution, "width");
    const int height = Pixels(resolution, "height");
    std::string type = calibration.attribute("type").value();
    if (type.empty()) type = sensor.attribute("type").value();
    const std::string undistort = "Export undistorted photos (Convert Images) and their cameras, or optimize the cameras without it and export again";
    if (type != "frame" && type != "fisheye") Fail(calibration, "is of type '" + type + "', which cannot be read", undistort);
    const double f = Numbers(Child(calibration, "f"), 1)[0];
    const Eigen::Vector2d focal(f + NumberOr0(calibration, "b1"), f);
    if (!(focal.minCoeff() > 0.0)) Fail(calibration, "has a focal length that is not more than 0");
    const Eigen::Vector2d centre(0.5 * width + NumberOr0(calibration, "cx"), 0.5 * height + NumberOr0(calibration, "cy"));
    const auto refuse = [&](const char* name, const char* meaning) {
      if (NumberOr0(calibration, name) != 0.0)
        Fail(calibration, std::string("has ") + name + ", " + meaning + ", which cannot be used here", undistort);
    };
    refuse("b2", "the skew of the axes");
    refuse("p3", "a higher tangential distortion");
    refuse("p4", "a higher tangential distortion");
    const auto number = [&](const char* name) { return NumberOr0(calibration, name); };
    if (type == "fisheye") {
      refuse("p1", "tangential distortion of a fisheye");
      refuse("p2", "tangential distortion of a fisheye");
      return FisheyeCamera(width, height, focal, centre, {number("k1"), number("k2"), number("k3"), number("k4")});
    }
    refuse("k4", "radius^8 of a frame camera");
    return PerspectiveCamera(width, height, focal, centre, number("k1"), number("k2"), number("k3"), number("p2"), number("p1"));
  }

  void AddImage(const pugi::xml_node& camera, SfmBuilder& builder, std::map<std::string, bool>& seen) {
    const std::string sensor_id = Attribute(camera, "sensor_id");
    if (!camera_ids_.contains(sensor_id)) {
      const auto sensor = sensors_.find(sensor_id);
      if (sensor == sensors_.end()) Fail(camera, "has sensor_id " + sensor_id + ", but there is no such <sensor>");
      if (sensor->second.child("rolling_shutter") || std::string_view(sensor->second.attribute("rolling_shutter").value()) == "true")
        base::LogWarning("{}: the rolling shutter of sensor {} is not used", file_.string(), sensor_id);
      camera_ids_[sensor_id] = builder.AddCamera(LensOf(sensor->second));
    }
    const std::string name = photos_->Resolve(Attribute(camera, "label"), file_.parent_path());
    if (!seen.emplace(name, true).second) Fail(camera, "is the second one for the photo " + name, "Give every photo one camera, then export again");
    const pugi::xml_node transform = camera.child("transform");
    const std::vector<double> numbers = Numbers(transform, 16);
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> chunk_from_cam =
        Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(numbers.data());
    const std::optional<Eigen::Matrix3d> rotation = RotationOf(chunk_from_cam.topLeftCorner<3, 3>());
    if (!rotation || !chunk_from_cam.row(3).isApprox(Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0))) Fail(transform, "is not a rotation with a position");
    builder.AddImage(name, camera_ids_[sensor_id], PoseFromCentre(*rotation, chunk_from_cam.col(3).head<3>()));
  }

  // Nothing for a chunk without a reference on Earth.
  std::optional<ModelPlace> Place(const pugi::xml_node& chunk, const std::string& component, const survey::ColmapModel& sfm) const {
    pugi::xml_node transform = chunk.child("components").find_child_by_attribute("component", "id", component.c_str()).child("transform");
    if (!transform) transform = chunk.child("transform");
    const std::string reference = chunk.child("reference").child_value();
    const bool on_earth = reference.find("GEOGCS") != std::string::npos || reference.find("PROJCS") != std::string::npos ||
                          reference.find("GEOCCS") != std::string::npos || reference.find("CRS[") != std::string::npos;
    if (!transform || !on_earth || reference.starts_with("LOCAL_CS")) return std::nullopt;
    if (!transform.child("rotation") || !transform.child("translation") || !transform.child("scale")) return std::nullopt;
    const std::vector<double> turn = Numbers(transform.child("rotation"), 9);
    const std::vector<double> shift = Numbers(transform.child("translation"), 3);
    const double scale = Numbers(transform.child("scale"), 1)[0];
    const std::optional<Eigen::Matrix3d> rotation = RotationOf(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(turn.data()));
    if (!rotation || !(scale > 0.0)) Fail(transform, "is not a rotation with a position and a scale");
    const geo::Similarity3d ecef_from_chunk{scale, Eigen::Quaterniond(*rotation), {shift[0], shift[1], shift[2]}};
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const survey::ColmapImage& image : sfm.images) middle += ecef_from_chunk * image.cam_from_world.OriginInSource();
    middle /= static_cast<double>(sfm.images.size());
    // A chunk that was never placed has no place near the surface.
    if (middle.norm() < 6.3e6 || middle.norm() > 6.5e6) return std::nullopt;
    if (reference.find("WGS") == std::string::npos)
      base::LogWarning("{}: its coordinates are read as WGS84, though the chunk's reference has another datum; they may be off by metres",
                       file_.string());
    ModelPlace place{file_.string(), geo::GeodeticFromEcef(middle), {}};
    const Eigen::Matrix4d ecef_from_enu = geo::EcefFromEnu(place.origin);
    const Eigen::Matrix3d enu_from_ecef = ecef_from_enu.topLeftCorner<3, 3>().transpose();
    place.enu_from_model = {scale, Eigen::Quaterniond(Eigen::Matrix3d(enu_from_ecef * *rotation)),
                            enu_from_ecef * (ecef_from_chunk.translation - ecef_from_enu.topRightCorner<3, 1>())};
    return place;
  }

  fs::path file_;
  const ModelPhotos* photos_;
  std::string text_;
  pugi::xml_document document_;
  std::map<std::string, pugi::xml_node> sensors_;
  std::map<std::string, uint32_t> camera_ids_;
};

}  // namespace

InputModel ReadMetashape(const fs::path& file, const ModelPhotos& photos) {
  return MetashapeFile(file, photos).Read();
}

bool LooksLikeMetashape(const fs::path& file) {
  const std::string text = base::ReadFile(file);
  const std::string_view start = std::string_view(text).substr(0, 4096);
  return start.find("<document") != std::string_view::npos && start.find("<chunk") != std::string_view::npos;
}

}  // namespace skyquilt::prepare::models
