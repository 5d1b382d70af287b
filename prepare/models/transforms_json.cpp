#include "prepare/models/transforms_json.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include "core/base/cancel.h"
#include "core/base/json_document.h"
#include "core/base/log.h"
#include "core/base/pattern.h"
#include "prepare/models/ply_points.h"

namespace skyquilt::prepare::models {
namespace {

using base::JsonDocument;
using base::JsonValue;

constexpr const char* kFix = "Export the cameras again, for instance with 'ns-process-data'";

// A member of the frame, else of the whole file.
std::optional<JsonValue> FrameOrFile(const JsonValue& frame, const JsonValue& root, const std::string& key) {
  std::optional<JsonValue> value = frame.Find(key);
  return value ? value : root.Find(key);
}

double LensNumber(const JsonValue& frame, const JsonValue& root, const std::string& key) {
  const std::optional<JsonValue> value = FrameOrFile(frame, root, key);
  return value ? value->Number() : 0.0;
}

// From fl_<axis>, else from the angle of view.
std::optional<double> FocalLength(const JsonValue& frame, const JsonValue& root, const std::string& axis, int size) {
  if (const std::optional<JsonValue> focal = FrameOrFile(frame, root, "fl_" + axis)) return focal->Positive();
  const std::optional<JsonValue> angle = FrameOrFile(frame, root, "camera_angle_" + axis);
  if (!angle) return std::nullopt;
  if (!(angle->Number() > 0.0 && angle->Number() < std::numbers::pi))
    angle->Fail("must be an angle of view in radians, more than 0 and less than pi");
  return 0.5 * size / std::tan(0.5 * angle->Number());
}

Eigen::Vector2i SizeOfFrame(const JsonValue& frame, const JsonValue& root, const std::string& name, const ModelPhotos& photos) {
  const std::optional<JsonValue> width = FrameOrFile(frame, root, "w");
  const std::optional<JsonValue> height = FrameOrFile(frame, root, "h");
  if (width && height) return {width->Pixels(), height->Pixels()};
  const std::optional<Eigen::Vector2i> size = photos.SizeOf(name);
  // A size is needed only for photos that are there.
  return size.value_or(Eigen::Vector2i(1, 1));
}

camera::Camera LensOf(const JsonValue& frame, const JsonValue& root, const Eigen::Vector2i& size) {
  const std::optional<double> focal_x = FocalLength(frame, root, "x", size.x());
  if (!focal_x) frame.Fail("has neither fl_x nor camera_angle_x, nor has the whole file");
  const Eigen::Vector2d focal(*focal_x, FocalLength(frame, root, "y", size.y()).value_or(*focal_x));
  const std::optional<JsonValue> cx = FrameOrFile(frame, root, "cx");
  const std::optional<JsonValue> cy = FrameOrFile(frame, root, "cy");
  const Eigen::Vector2d centre(cx ? cx->Number() : 0.5 * size.x(), cy ? cy->Number() : 0.5 * size.y());
  const double k1 = LensNumber(frame, root, "k1");
  const double k2 = LensNumber(frame, root, "k2");
  const double k3 = LensNumber(frame, root, "k3");
  const double k4 = LensNumber(frame, root, "k4");
  const double p1 = LensNumber(frame, root, "p1");
  const double p2 = LensNumber(frame, root, "p2");
  const std::optional<JsonValue> model = FrameOrFile(frame, root, "camera_model");
  // instant-ngp's scripts name a fisheye so, and no model.
  const std::optional<JsonValue> fisheye = FrameOrFile(frame, root, "is_fisheye");
  const std::string name = model ? model->Text() : fisheye && fisheye->Boolean() ? "OPENCV_FISHEYE" : "OPENCV";
  const std::string undistort = "Undistort the photos, or export with camera model OPENCV or OPENCV_FISHEYE";
  if (name == "OPENCV_FISHEYE" || name == "RADIAL_FISHEYE" || name == "SIMPLE_RADIAL_FISHEYE") {
    if (p1 != 0.0 || p2 != 0.0) frame.Fail("has p1 or p2 with " + name + ", which has no tangential distortion", undistort);
    return FisheyeCamera(size.x(), size.y(), focal, centre, {k1, k2, k3, k4});
  }
  if (name != "OPENCV" && name != "PINHOLE" && name != "SIMPLE_PINHOLE" && name != "SIMPLE_RADIAL" && name != "RADIAL") {
    model->Fail("is " + name + ", which cannot be read", undistort);
  }
  if (k4 != 0.0) frame.Fail("has k4, radius^8 of a perspective lens, which cannot be used here", undistort);
  return PerspectiveCamera(size.x(), size.y(), focal, centre, k1, k2, k3, p1, p2);
}

// In place of transform_matrix, in MatrixCity's blocks.
constexpr const char* kScaledMatrix = "rot_mat";

geo::Rigid3d PoseOfFrame(const JsonValue& frame) {
  const std::optional<JsonValue> scaled = frame.Find(kScaledMatrix);
  const JsonValue matrix = scaled ? *scaled : frame.At("transform_matrix");
  if (matrix.Size() != 3 && matrix.Size() != 4) matrix.Fail("must have 4 rows");
  Eigen::Matrix<double, 3, 4> world_from_cam;
  for (size_t row = 0; row < 3; ++row) {
    const std::vector<double> numbers = matrix.At(row).Numbers(4);
    for (size_t column = 0; column < 4; ++column) world_from_cam(static_cast<int>(row), static_cast<int>(column)) = numbers[column];
  }
  if (matrix.Size() == 4 && matrix.At(3).Numbers(4) != std::vector<double>{0.0, 0.0, 0.0, 1.0}) matrix.At(3).Fail("must be 0, 0, 0, 1");
  const std::optional<Eigen::Matrix3d> rotation = RotationOf(world_from_cam.leftCols<3>());
  if (!rotation) matrix.Fail("is not a rotation with a position");
  // From y up and looking along -z to y down and looking along +z.
  return PoseFromCentre(*rotation * Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal(), world_from_cam.col(3));
}

// The name of a frame's photo. In a data set, parts of which have pictures of the same names, only its own path is it.
std::string NameOf(const JsonValue& frame, const ModelPhotos& photos, const std::filesystem::path& folder, bool in_set) {
  if (frame.Find(kScaledMatrix)) {
    const std::string file = fmt::format("{:04d}.png", frame.At("frame_index").Integer(0, 99'999'999));
    const std::optional<std::string> beside = photos.FindPath(file, folder);
    return beside ? *beside : photos.FindPath("rgb/" + file, folder).value_or(file);
  }
  const std::string path = frame.At("file_path").Text();
  return in_set ? photos.FindPath(path, folder).value_or(PhotoNames::Cleaned(path)) : photos.Resolve(path, folder);
}

// Names in nerfstudio's lists of photos per split.
void AddHeldOut(const JsonValue& root, const ModelPhotos& photos, const std::filesystem::path& folder, std::set<std::string>& test_photos) {
  for (const char* key : {"val_filenames", "test_filenames"}) {
    const std::optional<JsonValue> names = root.Find(key);
    if (!names) continue;
    for (size_t i = 0; i < names->Size(); ++i) test_photos.insert(photos.Resolve(names->At(i).Text(), folder));
  }
}

// A file that was read, with its part.
struct ReadPart {
  TransformsPart part = TransformsPart::kWhole;
  JsonDocument document;
};
using ReadParts = std::vector<std::unique_ptr<ReadPart>>;

bool Any(const ReadParts& parts, TransformsPart which) {
  return std::any_of(parts.begin(), parts.end(),
                     [which](const auto& one) { return one->part == which && one->document.Root().At("frames").Size() > 0; });
}

template <typename Condition>
bool EveryFrame(const ReadParts& parts, const Condition& condition) {
  size_t n = 0;
  for (const auto& one : parts) {
    const JsonValue frames = one->document.Root().At("frames");
    for (size_t i = 0; i < frames.Size(); ++i, ++n) {
      if (!condition(frames.At(i))) return false;
    }
  }
  return n > 0;
}

// By the names of its pictures: "../../train/block_1/0012.png".
bool IsMatrixCitySplit(const ReadParts& parts) {
  return EveryFrame(parts, [](const JsonValue& frame) {
    const std::optional<JsonValue> path = frame.Find("file_path");
    if (!path || !path->json().is_string()) return false;
    const std::string text = path->json().get<std::string>();
    return text.size() < 256 && base::MatchWhole(text, "\\.\\./\\.\\./(train|train_dense|test)/[^/]+/[0-9]+\\.png").has_value();
  });
}

// The set, its frame and which pictures are its own.
void RecogniseSet(const ReadParts& parts, InputModel& model) {
  const JsonValue root = parts.front()->document.Root();
  const bool split = parts.front()->part != TransformsPart::kWhole;
  if (EveryFrame(parts, [](const JsonValue& frame) { return frame.Find(kScaledMatrix).has_value(); })) {
    model.set = "MatrixCity";
    model.metres_per_unit = 1.0;
  } else if (split && IsMatrixCitySplit(parts)) {
    model.set = "MatrixCity";
    model.metres_per_unit = 100.0;
  } else if (split && root.Find("camera_angle_x") && !root.Find("fl_x")) {
    model.set = "Blender";
  }
  model.names_all_photos = !model.set.empty();
  if (!model.set.empty()) model.up = Eigen::Vector3d::UnitZ();
  if (const std::optional<JsonValue> up = root.Find("up")) {
    const std::vector<double> numbers = up->Numbers(3);
    const Eigen::Vector3d direction(numbers[0], numbers[1], numbers[2]);
    if (!(direction.norm() > 0.0)) up->Fail("must be a direction, not 0, 0, 0");
    model.up = direction.normalized();
  }
  if (const std::optional<JsonValue> unit = root.Find("metres_per_unit")) model.metres_per_unit = unit->Positive();
}

}  // namespace

InputModel ReadTransforms(const std::vector<TransformsFile>& files, const ModelPhotos& photos) {
  InputModel model;
  model.format = ModelFormat::kTransforms;
  ReadParts parts;
  for (const TransformsFile& one : files) {
    base::ThrowIfCancelled();
    parts.push_back(std::unique_ptr<ReadPart>(new ReadPart{one.part, JsonDocument(one.file, kFix)}));
  }
  RecogniseSet(parts, model);
  const bool without_val = model.set == "Blender" && Any(parts, TransformsPart::kTest) && Any(parts, TransformsPart::kVal);
  SfmBuilder builder(model.sfm);
  std::map<std::string, bool> seen;
  std::optional<std::filesystem::path> ply;
  for (const auto& one : parts) {
    base::ThrowIfCancelled();
    const JsonValue root = one->document.Root();
    const std::filesystem::path folder = one->document.file().parent_path();
    const JsonValue frames = root.At("frames");
    if (frames.Size() == 0 && files.size() == 1) frames.Fail("has no photos");
    if (const std::optional<JsonValue> file = root.Find("ply_file_path"); file && !ply) ply = folder / file->Text();
    if (one->part == TransformsPart::kVal && without_val) {
      base::LogInfo("{} is not used: published results neither train on its {} photos nor score them", one->document.file().string(), frames.Size());
      continue;
    }
    for (size_t i = 0; i < frames.Size(); ++i) {
      const JsonValue frame = frames.At(i);
      const std::string name = NameOf(frame, photos, folder, model.names_all_photos);
      if (model.names_all_photos && !photos.Has(name)) {
        frame.Fail("is of the picture " + name + ", which is not among the photos in " + photos.root().string(),
                   "Unpack all pictures of the data set where the file says, or remove the frame. survey/input.csv says which pictures were left out "
                   "and why");
      }
      if (!seen.emplace(name, true).second) frame.Fail("is the second one for the photo " + name, "Name every photo once");
      const uint32_t camera_id = builder.AddCamera(LensOf(frame, root, SizeOfFrame(frame, root, name, photos)));
      builder.AddImage(name, camera_id, PoseOfFrame(frame));
      if (one->part == TransformsPart::kVal || one->part == TransformsPart::kTest) model.test_photos.insert(name);
    }
    AddHeldOut(root, photos, folder, model.test_photos);
  }
  if (ply) {
    for (const PlyPoint& point : ReadPlyPoints(*ply)) builder.AddPoint(point.x, point.rgb, {});
  }
  return model;
}

}  // namespace skyquilt::prepare::models
