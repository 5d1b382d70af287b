#include <cstring>
#include <span>
#include <utility>

#include "core/base/errors.h"
#include "core/base/memory_map.h"
#include "core/survey/colmap_files.h"

namespace skyquilt::survey {
namespace {

static_assert(sizeof(double) == 8);

// Reads little-endian values in order and never past the end of the file.
class Cursor {
 public:
  explicit Cursor(const std::filesystem::path& file) : file_(file), map_(file), rest_(map_.bytes()) {}

  template <typename T>
  T Read(const char* what) {
    T value;
    Require(sizeof(T), what);
    std::memcpy(&value, rest_.data(), sizeof(T));
    rest_ = rest_.subspan(sizeof(T));
    return value;
  }

  // Reads a number of records of at least `min_bytes` each, and checks it against the file size before memory is allocated.
  size_t ReadCount(size_t min_bytes, const char* what) {
    const auto count = Read<uint64_t>(what);
    if (count > rest_.size() / min_bytes) {
      Fail("has a count of " + std::to_string(count) + " " + what + ", but only " + std::to_string(rest_.size()) + " bytes follow");
    }
    return static_cast<size_t>(count);
  }

  std::string ReadName() {
    const void* end = rest_.empty() ? nullptr : std::memchr(rest_.data(), 0, rest_.size());
    if (end == nullptr) Fail("ends inside a photo name");
    const auto length = static_cast<size_t>(static_cast<const uint8_t*>(end) - rest_.data());
    std::string name(length, '\0');
    std::memcpy(name.data(), rest_.data(), length);
    rest_ = rest_.subspan(length + 1);
    return name;
  }

  void Skip(size_t n_bytes, const char* what) {
    Require(n_bytes, what);
    rest_ = rest_.subspan(n_bytes);
  }

  void RequireEnd() {
    if (!rest_.empty()) Fail("has " + std::to_string(rest_.size()) + " bytes after its last record");
  }

  [[noreturn]] void Fail(const std::string& found) const {
    throw base::InputError(file_, found, "The file is truncated or not a COLMAP binary model; copy or export the model again");
  }

 private:
  void Require(size_t n_bytes, const char* what) {
    if (rest_.size() < n_bytes) Fail("ends inside " + std::string(what));
  }

  std::filesystem::path file_;
  base::MemoryMap map_;
  std::span<const uint8_t> rest_;
};

void ReadCameras(const std::filesystem::path& file, ColmapModel& model) {
  Cursor in(file);
  const size_t n_cameras = in.ReadCount(24, "cameras");
  for (size_t i = 0; i < n_cameras; ++i) {
    const auto id = in.Read<uint32_t>("a camera");
    const auto model_id = in.Read<int32_t>("a camera");
    const auto width = in.Read<uint64_t>("a camera");
    const auto height = in.Read<uint64_t>("a camera");
    const auto camera_model = camera::ModelFromId(model_id);
    if (!camera_model) {
      throw base::InputError(
          file, "camera " + std::to_string(id) + " has COLMAP's camera model number " + std::to_string(model_id) + ", which is not supported",
          "Use " + camera::ModelNames());
    }
    constexpr uint64_t kMaxSidePx = 1U << 20U;
    if (width > kMaxSidePx || height > kMaxSidePx) {
      in.Fail("camera " + std::to_string(id) + " is " + std::to_string(width) + "x" + std::to_string(height) + " pixels");
    }
    camera::Camera camera{*camera_model, static_cast<int>(width), static_cast<int>(height), {}};
    for (int p = 0; p < camera::ModelParamCount(*camera_model); ++p) camera.params.push_back(in.Read<double>("a camera"));
    if (!model.cameras.emplace(id, std::move(camera)).second) in.Fail("has camera " + std::to_string(id) + " twice");
  }
  in.RequireEnd();
}

std::vector<ColmapObservation> ReadObservations(Cursor& in, size_t n_features) {
  std::vector<ColmapObservation> observations;
  observations.reserve(n_features);
  for (size_t i = 0; i < n_features; ++i) {
    ColmapObservation observation;
    for (int axis = 0; axis < 2; ++axis) observation.pixel[axis] = in.Read<double>("an observation");
    observation.point_id = in.Read<uint64_t>("an observation");
    if (observation.point_id != kNoPoint) observations.push_back(observation);
  }
  // Most features belong to no point.
  observations.shrink_to_fit();
  return observations;
}

// Skips the observations when `observations` is null.
constexpr size_t kLeastImage_bytes = 4 + 56 + 4 + 1 + 8;

void ReadImages(const std::filesystem::path& file, ColmapModel& model, ColmapObservations* observations) {
  Cursor in(file);
  const size_t n_images = in.ReadCount(kLeastImage_bytes, "images");
  model.images.reserve(n_images);
  for (size_t i = 0; i < n_images; ++i) {
    ColmapImage image;
    image.id = in.Read<uint32_t>("an image");
    std::array<double, 7> pose{};
    for (double& value : pose) value = in.Read<double>("an image");
    image.cam_from_world = PoseOf(pose);
    image.camera_id = in.Read<uint32_t>("an image");
    image.name = in.ReadName();
    constexpr size_t kObservationBytes = 24;
    const size_t n_features = in.ReadCount(kObservationBytes, "observations");
    if (observations == nullptr) {
      in.Skip(n_features * kObservationBytes, "the observations of an image");
    } else if (!observations->emplace(image.id, ReadObservations(in, n_features)).second) {
      in.Fail("has image " + std::to_string(image.id) + " twice");
    }
    model.images.push_back(std::move(image));
  }
  in.RequireEnd();
}

void ReadPoints(const std::filesystem::path& file, ColmapModel& model) {
  Cursor in(file);
  const size_t n_points = in.ReadCount(8 + 24 + 3 + 8 + 8, "points");
  model.points.reserve(n_points);
  for (size_t i = 0; i < n_points; ++i) {
    ColmapPoint point;
    point.id = in.Read<uint64_t>("a point");
    for (int axis = 0; axis < 3; ++axis) point.x_in_world[axis] = in.Read<double>("a point");
    for (uint8_t& channel : point.rgb) channel = in.Read<uint8_t>("a point");
    point.error_px = in.Read<double>("a point");
    const size_t n_track = in.ReadCount(8, "track entries");
    point.image_ids.reserve(n_track);
    for (size_t k = 0; k < n_track; ++k) {
      point.image_ids.push_back(in.Read<uint32_t>("a track"));
      in.Skip(4, "a track");
    }
    model.points.push_back(std::move(point));
  }
  in.RequireEnd();
}

}  // namespace

ColmapModel ReadColmapBinary(const std::filesystem::path& folder) {
  ColmapModel model;
  ReadCameras(folder / "cameras.bin", model);
  ReadImages(folder / "images.bin", model, nullptr);
  ReadPoints(folder / "points3D.bin", model);
  return model;
}

ColmapObservations ReadObservationsBinary(const std::filesystem::path& folder) {
  ColmapModel model;
  ColmapObservations observations;
  ReadImages(folder / "images.bin", model, &observations);
  return observations;
}

size_t CountColmapImages(const std::filesystem::path& folder) {
  return Cursor(folder / "images.bin").ReadCount(kLeastImage_bytes, "images");
}

}  // namespace skyquilt::survey
