#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/output_file.h"
#include "core/base/progress.h"
#include "core/survey/colmap_model.h"

namespace skyquilt::survey {
namespace {

namespace fs = std::filesystem;

// As the file has them, without gaps.
struct FileObservation {
  double x, y;
  uint64_t point_id;
};
struct FileTrackEntry {
  uint32_t image_id, observation;  // the observation's place in the list of its image
};
static_assert(sizeof(FileObservation) == 24 && sizeof(FileTrackEntry) == 8);

constexpr uint64_t kImageBytes = 4 + 56 + 4 + 1 + 8;  // without name and observations
constexpr uint64_t kPointBytes = 8 + 24 + 3 + 8 + 8;  // without track

// Values in the machine's order, which is little-endian on all machines that the readers support.
class BinaryFile {
 public:
  explicit BinaryFile(const fs::path& file) : file_(file) {}

  template <typename T>
  void Add(T value) {
    file_.Append(std::string_view(reinterpret_cast<const char*>(&value), sizeof(T)));
  }
  void AddName(const std::string& name) {
    file_.Append(name);
    Add('\0');
  }
  uint64_t size() const { return file_.size(); }

  // Between records, so that a large file goes to disk while it is made and not all at its end.
  void SyncIfLong() {
    constexpr uint64_t kPieceBytes = 64U << 20U;
    if (size() - synced_ < kPieceBytes) return;
    file_.Sync();
    synced_ = size();
  }
  void Complete() { file_.Complete(); }
  void Publish() { file_.Publish(); }

 private:
  base::OutputFile file_;
  uint64_t synced_ = 0;
};

// The three files of a model. None has its name before all are complete.
class BinaryFiles {
 public:
  explicit BinaryFiles(const fs::path& folder)
      : cameras(folder / "cameras.bin"), images(folder / "images.bin"), points(folder / "points3D.bin"), folder_(folder) {}

  void Publish() {
    for (BinaryFile* file : {&cameras, &images, &points}) file->Complete();
    for (BinaryFile* file : {&cameras, &images, &points}) file->Publish();
    base::SyncPath(folder_);
  }

  BinaryFile cameras, images, points;

 private:
  fs::path folder_;
};

void WriteCameras(const ColmapModel& model, BinaryFile& out) {
  out.Add<uint64_t>(model.cameras.size());
  for (const auto& [id, camera] : model.cameras) {
    out.Add<uint32_t>(id);
    out.Add<int32_t>(static_cast<int32_t>(camera.model));
    out.Add<uint64_t>(static_cast<uint64_t>(camera.width));
    out.Add<uint64_t>(static_cast<uint64_t>(camera.height));
    for (const double parameter : camera.params) out.Add<double>(parameter);
  }
}

// All of an image but its observations, which must follow.
void WriteImage(const ColmapImage& image, size_t n_observations, BinaryFile& out) {
  const Eigen::Quaterniond& q = image.cam_from_world.rotation;
  out.Add<uint32_t>(image.id);
  for (const double value : {q.w(), q.x(), q.y(), q.z()}) out.Add<double>(value);
  for (int axis = 0; axis < 3; ++axis) out.Add<double>(image.cam_from_world.translation[axis]);
  out.Add<uint32_t>(image.camera_id);
  out.AddName(image.name);
  out.Add<uint64_t>(n_observations);
}

// All of a point but its track, which must follow.
void WritePoint(const ColmapPoint& point, BinaryFile& out) {
  out.Add<uint64_t>(point.id);
  for (int axis = 0; axis < 3; ++axis) out.Add<double>(point.x_in_world[axis]);
  for (const uint8_t channel : point.rgb) out.Add<uint8_t>(channel);
  out.Add<double>(point.error_px);
  out.Add<uint64_t>(point.image_ids.size());
}

void WriteMeasuredImages(const ColmapModel& model, const ColmapObservations& observations, BinaryFile& out) {
  out.Add<uint64_t>(model.images.size());
  for (const ColmapImage& image : model.images) {
    const auto list = observations.find(image.id);
    WriteImage(image, list == observations.end() ? 0 : list->second.size(), out);
    if (list == observations.end()) continue;
    for (const ColmapObservation& seen : list->second) out.Add(FileObservation{seen.pixel.x(), seen.pixel.y(), seen.point_id});
  }
}

void WriteMeasuredPoints(const ColmapModel& model, const ColmapObservations& observations, BinaryFile& out) {
  // Where each image lists its observation of a point.
  std::unordered_map<uint32_t, std::unordered_map<uint64_t, uint32_t>> place;
  for (const auto& [image_id, list] : observations) {
    auto& of_image = place[image_id];
    for (uint32_t k = 0; k < list.size(); ++k) of_image.emplace(list[k].point_id, k);
  }
  out.Add<uint64_t>(model.points.size());
  for (const ColmapPoint& point : model.points) {
    WritePoint(point, out);
    for (const uint32_t image_id : point.image_ids) {
      const auto of_image = place.find(image_id);
      SKYQUILT_CHECK(of_image != place.end(), "track names image " + std::to_string(image_id));
      const auto at = of_image->second.find(point.id);
      SKYQUILT_CHECK(at != of_image->second.end(), "image " + std::to_string(image_id) + " does not observe point " + std::to_string(point.id));
      out.Add(FileTrackEntry{image_id, at->second});
    }
  }
}

// The points that each image observes, by the tracks, in the order of the model: 4 bytes per observation.
class PointsOfImages {
 public:
  explicit PointsOfImages(const ColmapModel& model) : first_(model.images.size() + 1, 0) {
    for (size_t i = 0; i < model.images.size(); ++i) index_.emplace(model.images[i].id, i);
    for (const ColmapPoint& point : model.points) {
      for (const uint32_t image_id : point.image_ids) ++first_[IndexOf(image_id) + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    points_.resize(first_.back());
    std::vector<size_t> next = first_;
    for (size_t i = 0; i < model.points.size(); ++i) {
      for (const uint32_t image_id : model.points[i].image_ids) points_[next[IndexOf(image_id)]++] = static_cast<uint32_t>(i);
    }
  }

  size_t size() const { return points_.size(); }
  size_t IndexOf(uint32_t image_id) const {
    const auto found = index_.find(image_id);
    SKYQUILT_CHECK(found != index_.end(), "track names image " + std::to_string(image_id));
    return found->second;
  }
  // Indices of points, for the index of an image.
  std::span<const uint32_t> Of(size_t image) const { return std::span(points_).subspan(first_[image], first_[image + 1] - first_[image]); }

 private:
  std::unordered_map<uint32_t, size_t> index_;
  std::vector<size_t> first_;
  std::vector<uint32_t> points_;
};

// Of images.bin and points3D.bin.
uint64_t BytesOf(const ColmapModel& model, size_t n_observations) {
  uint64_t bytes = 2 * sizeof(uint64_t) + model.images.size() * kImageBytes + model.points.size() * kPointBytes +
                   n_observations * (sizeof(FileObservation) + sizeof(FileTrackEntry));
  for (const ColmapImage& image : model.images) bytes += image.name.size();
  return bytes;
}

// Called after each record.
void AfterRecord(uint64_t bytes_before, BinaryFile& out, base::Progress& progress) {
  base::ThrowIfCancelled();
  out.SyncIfLong();
  progress.Update(static_cast<double>(bytes_before + out.size()));
}

void WriteProjectedImages(const ColmapModel& model, const PointsOfImages& seen, BinaryFile& out, base::Progress& progress) {
  out.Add<uint64_t>(model.images.size());
  for (size_t i = 0; i < model.images.size(); ++i) {
    const ColmapImage& image = model.images[i];
    const camera::Camera& camera = model.cameras.at(image.camera_id);
    WriteImage(image, seen.Of(i).size(), out);
    for (const uint32_t index : seen.Of(i)) {
      const ColmapPoint& point = model.points[index];
      const Eigen::Vector2d pixel = camera.ImgFromCam(image.cam_from_world * point.x_in_world).value_or(Eigen::Vector2d::Zero());
      out.Add(FileObservation{pixel.x(), pixel.y(), point.id});
    }
    AfterRecord(0, out, progress);
  }
}

void WriteProjectedPoints(const ColmapModel& model, const PointsOfImages& seen, uint64_t bytes_before, BinaryFile& out, base::Progress& progress) {
  std::vector<uint32_t> n_listed(model.images.size(), 0);
  out.Add<uint64_t>(model.points.size());
  for (const ColmapPoint& point : model.points) {
    WritePoint(point, out);
    for (const uint32_t image_id : point.image_ids) out.Add(FileTrackEntry{image_id, n_listed[seen.IndexOf(image_id)]++});
    AfterRecord(bytes_before, out, progress);
  }
}

}  // namespace

void WriteColmapBinary(const ColmapModel& model, const ColmapObservations& observations, const fs::path& folder) {
  base::RequireWritableFolder(folder);
  BinaryFiles files(folder);
  WriteCameras(model, files.cameras);
  WriteMeasuredImages(model, observations, files.images);
  WriteMeasuredPoints(model, observations, files.points);
  files.Publish();
}

void WriteProjectedColmapBinary(const ColmapModel& model, const fs::path& folder) {
  base::RequireWritableFolder(folder);
  const PointsOfImages seen(model);
  BinaryFiles files(folder);
  base::Progress progress("write camera model", static_cast<double>(BytesOf(model, seen.size())), "B");
  WriteCameras(model, files.cameras);
  WriteProjectedImages(model, seen, files.images, progress);
  WriteProjectedPoints(model, seen, files.images.size(), files.points, progress);
  files.Publish();
  progress.Finish();
}

}  // namespace skyquilt::survey
