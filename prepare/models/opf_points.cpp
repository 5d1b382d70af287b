#include "prepare/models/opf_points.h"

#include <cstring>
#include <map>

#include "core/base/cancel.h"
#include "core/base/file.h"
#include "core/base/json_document.h"

namespace skyquilt::prepare::models {
namespace {

using base::JsonDocument;
using base::JsonValue;

namespace fs = std::filesystem;

constexpr const char* kGltfFix = "Export the project as OPF again";
constexpr int kFloat = 5126;
constexpr int kUnsignedInt = 5125;
constexpr int kUnsignedByte = 5121;

class OpfGltf {
 public:
  explicit OpfGltf(const fs::path& file) : document_(file, kGltfFix), folder_(file.parent_path()) {}

  JsonValue Root() const { return document_.Root(); }

  struct Packed {
    const char* data = nullptr;
    size_t count = 0;
  };
  // The bytes of an accessor with this type, checked against its buffer. component: glTF's number, width: its bytes times the entries of type.
  Packed At(const JsonValue& number, const std::string& type, int component, size_t width) {
    const JsonValue accessor = Root().At("accessors").At(number.Id());
    if (accessor.At("type").Text() != type || accessor.At("componentType").Number() != component)
      accessor.Fail("must be " + type + " of component type " + std::to_string(component));
    if (accessor.Find("byteOffset") || accessor.Find("sparse")) accessor.Fail("has byteOffset or sparse, which OPF does not allow");
    const uint64_t count = accessor.At("count").Id();
    const JsonValue view = Root().At("bufferViews").At(accessor.At("bufferView").Id());
    if (view.Find("byteStride")) view.Fail("has a byteStride, which OPF does not allow");
    const std::string& bytes = Buffer(Root().At("buffers").At(view.At("buffer").Id()));
    const std::optional<JsonValue> offset_value = view.Find("byteOffset");
    const uint64_t offset = offset_value ? offset_value->Id() : 0;
    const uint64_t length = view.At("byteLength").Id();
    if (offset > bytes.size() || length > bytes.size() - offset)
      view.Fail("is longer than its buffer, which has " + std::to_string(bytes.size()) + " bytes");
    if (count > length / width) accessor.Fail("has more entries than its buffer view");
    return {bytes.data() + offset, static_cast<size_t>(count)};
  }

 private:
  const std::string& Buffer(const JsonValue& buffer) {
    const JsonValue uri = buffer.At("uri");
    const std::string name = uri.Text();
    const fs::path path(name);
    if (path.is_absolute() || name.find("://") != std::string::npos || name.starts_with("data:")) uri.Fail("must be a file beside this one");
    const auto known = buffers_.find(name);
    if (known != buffers_.end()) return known->second;
    return buffers_.emplace(name, base::ReadFile(folder_ / path)).first->second;
  }

  JsonDocument document_;
  fs::path folder_;
  std::map<std::string, std::string> buffers_;
};

template <typename T>
T EntryAt(const char* data, size_t index) {
  T value;
  std::memcpy(&value, data + index * sizeof(T), sizeof(T));
  return value;
}

// The transform of a node; glTF stores it by columns.
Eigen::Matrix4d MatrixOf(const JsonValue& node) {
  for (const char* key : {"rotation", "translation", "scale"}) {
    if (node.Find(key)) node.Fail(std::string("has a ") + key + " beside its matrix, which OPF does not allow");
  }
  const std::optional<JsonValue> matrix = node.Find("matrix");
  if (!matrix) return Eigen::Matrix4d::Identity();
  const std::vector<double> numbers = matrix->Numbers(16);
  return Eigen::Map<const Eigen::Matrix4d>(numbers.data());
}

// Which images saw each point.
std::vector<std::vector<uint32_t>> TracksOf(OpfGltf& gltf, const JsonValue& matches, size_t n_points,
                                            const std::unordered_map<uint64_t, uint32_t>& image_of_camera) {
  const JsonValue uids = matches.At("cameraUids");
  std::vector<std::optional<uint32_t>> image_of_index;
  for (size_t i = 0; i < uids.Size(); ++i) {
    const auto image = image_of_camera.find(uids.At(i).Id());
    image_of_index.push_back(image == image_of_camera.end() ? std::nullopt : std::optional<uint32_t>(image->second));
  }
  const OpfGltf::Packed cameras = gltf.At(matches.At("cameraIds"), "SCALAR", kUnsignedInt, 4);
  const OpfGltf::Packed ranges = gltf.At(matches.At("pointIndexRanges"), "VEC2", kUnsignedInt, 8);
  if (ranges.count != n_points)
    matches.At("pointIndexRanges").Fail("has " + std::to_string(ranges.count) + " entries for " + std::to_string(n_points) + " points");
  std::vector<std::vector<uint32_t>> tracks(n_points);
  uint64_t n_matches = 0;
  for (size_t i = 0; i < n_points; ++i) {
    // 40 bits of offset, then 24 bits of length.
    const auto packed = EntryAt<uint64_t>(ranges.data, i);
    const uint64_t begin = packed & ((uint64_t{1} << 40U) - 1);
    const uint64_t length = packed >> 40U;
    n_matches += length;
    if (n_matches > cameras.count) matches.At("pointIndexRanges").Fail("uses matches twice");
    if (begin > cameras.count || length > cameras.count - begin) matches.At("pointIndexRanges").Fail("leads beyond the last match");
    for (uint64_t k = begin; k < begin + length; ++k) {
      const auto index = EntryAt<uint32_t>(cameras.data, static_cast<size_t>(k));
      if (index >= image_of_index.size()) matches.At("cameraIds").Fail("names a camera that is not in cameraUids");
      if (image_of_index[index]) tracks[i].push_back(*image_of_index[index]);
    }
  }
  return tracks;
}

void AddPrimitive(OpfGltf& gltf, const JsonValue& primitive, const Eigen::Matrix4d& scene_from_mesh,
                  const std::unordered_map<uint64_t, uint32_t>& image_of_camera, SfmBuilder& builder) {
  const JsonValue attributes = primitive.At("attributes");
  const OpfGltf::Packed positions = gltf.At(attributes.At("POSITION"), "VEC3", kFloat, 12);
  const std::optional<JsonValue> color_number = attributes.Find("COLOR_0");
  OpfGltf::Packed colors;
  if (color_number) colors = gltf.At(*color_number, "VEC4", kUnsignedByte, 4);
  if (color_number && colors.count != positions.count) color_number->Fail("has another number of entries than POSITION");
  std::vector<std::vector<uint32_t>> tracks(positions.count);
  if (const std::optional<JsonValue> extensions = primitive.Find("extensions")) {
    if (const std::optional<JsonValue> matches = extensions->Find("OPF_mesh_primitive_matches")) {
      tracks = TracksOf(gltf, *matches, positions.count, image_of_camera);
    }
  }
  for (size_t i = 0; i < positions.count; ++i) {
    if (i % 65536 == 0) base::ThrowIfCancelled();
    const Eigen::Vector3d x_in_mesh(static_cast<double>(EntryAt<float>(positions.data, 3 * i)),
                                    static_cast<double>(EntryAt<float>(positions.data, 3 * i + 1)),
                                    static_cast<double>(EntryAt<float>(positions.data, 3 * i + 2)));
    const Eigen::Vector3d x_in_scene = (scene_from_mesh * x_in_mesh.homogeneous()).head<3>();
    if (!x_in_scene.allFinite()) attributes.At("POSITION").Fail("has a point that is not finite");
    std::array<uint8_t, 3> rgb{};
    for (size_t c = 0; color_number && c < 3; ++c) rgb[c] = EntryAt<uint8_t>(colors.data, 4 * i + c);
    builder.AddPoint({x_in_scene.x(), -x_in_scene.z(), x_in_scene.y()}, rgb, std::move(tracks[i]));
  }
}

}  // namespace

void AddOpfPoints(const fs::path& file, const std::unordered_map<uint64_t, uint32_t>& image_of_camera, SfmBuilder& builder) {
  OpfGltf gltf(file);
  const JsonValue root = gltf.Root();
  const JsonValue scene_nodes = root.At("scenes").At(root.At("scene").Id()).At("nodes");
  for (size_t i = 0; i < scene_nodes.Size(); ++i) {
    const JsonValue node = root.At("nodes").At(scene_nodes.At(i).Id());
    const std::optional<JsonValue> mesh = node.Find("mesh");
    if (!mesh) continue;
    const JsonValue primitives = root.At("meshes").At(mesh->Id()).At("primitives");
    if (primitives.Size() != 1) primitives.Fail("must be one, as OPF says");
    AddPrimitive(gltf, primitives.At(0), MatrixOf(node), image_of_camera, builder);
  }
}

}  // namespace skyquilt::prepare::models
