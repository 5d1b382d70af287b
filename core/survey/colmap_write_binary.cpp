#include <unordered_map>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/survey/colmap_model.h"

namespace skyquilt::survey {
namespace {

// Values in the machine's order, which is little-endian on all machines that the readers support.
class BinaryText {
 public:
  template <typename T>
  void Add(T value) {
    const char* bytes = reinterpret_cast<const char*>(&value);
    text_.append(bytes, sizeof(T));
  }
  void AddName(const std::string& name) {
    text_ += name;
    text_ += '\0';
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string CamerasText(const ColmapModel& model) {
  BinaryText out;
  out.Add<uint64_t>(model.cameras.size());
  for (const auto& [id, camera] : model.cameras) {
    out.Add<uint32_t>(id);
    out.Add<int32_t>(static_cast<int32_t>(camera.model));
    out.Add<uint64_t>(static_cast<uint64_t>(camera.width));
    out.Add<uint64_t>(static_cast<uint64_t>(camera.height));
    for (const double parameter : camera.params) out.Add<double>(parameter);
  }
  return out.text();
}

std::string ImagesText(const ColmapModel& model, const ColmapObservations& observations) {
  BinaryText out;
  out.Add<uint64_t>(model.images.size());
  for (const ColmapImage& image : model.images) {
    const Eigen::Quaterniond& q = image.cam_from_world.rotation;
    out.Add<uint32_t>(image.id);
    for (const double value : {q.w(), q.x(), q.y(), q.z()}) out.Add<double>(value);
    for (int axis = 0; axis < 3; ++axis) out.Add<double>(image.cam_from_world.translation[axis]);
    out.Add<uint32_t>(image.camera_id);
    out.AddName(image.name);
    const auto list = observations.find(image.id);
    out.Add<uint64_t>(list == observations.end() ? 0 : list->second.size());
    if (list == observations.end()) continue;
    for (const ColmapObservation& observation : list->second) {
      out.Add<double>(observation.pixel.x());
      out.Add<double>(observation.pixel.y());
      out.Add<uint64_t>(observation.point_id);
    }
  }
  return out.text();
}

std::string PointsText(const ColmapModel& model, const ColmapObservations& observations) {
  // Where each image lists its observation of a point.
  std::unordered_map<uint32_t, std::unordered_map<uint64_t, uint32_t>> place;
  for (const auto& [image_id, list] : observations) {
    auto& of_image = place[image_id];
    for (uint32_t k = 0; k < list.size(); ++k) of_image.emplace(list[k].point_id, k);
  }
  BinaryText out;
  out.Add<uint64_t>(model.points.size());
  for (const ColmapPoint& point : model.points) {
    out.Add<uint64_t>(point.id);
    for (int axis = 0; axis < 3; ++axis) out.Add<double>(point.x_in_world[axis]);
    for (const uint8_t channel : point.rgb) out.Add<uint8_t>(channel);
    out.Add<double>(point.error_px);
    out.Add<uint64_t>(point.image_ids.size());
    for (const uint32_t image_id : point.image_ids) {
      const auto of_image = place.find(image_id);
      SKYQUILT_CHECK(of_image != place.end(), "track names image " + std::to_string(image_id));
      const auto at = of_image->second.find(point.id);
      SKYQUILT_CHECK(at != of_image->second.end(), "image " + std::to_string(image_id) + " does not observe point " + std::to_string(point.id));
      out.Add<uint32_t>(image_id);
      out.Add<uint32_t>(at->second);
    }
  }
  return out.text();
}

}  // namespace

void WriteColmapBinary(const ColmapModel& model, const ColmapObservations& observations, const std::filesystem::path& folder) {
  base::RequireWritableFolder(folder);
  base::WriteFileAtomically(folder / "cameras.bin", CamerasText(model));
  base::WriteFileAtomically(folder / "images.bin", ImagesText(model, observations));
  base::WriteFileAtomically(folder / "points3D.bin", PointsText(model, observations));
}

}  // namespace skyquilt::survey
