#include "surface/files/gltf_document.h"

#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "surface/files/file_writer.h"

namespace skyquilt::surface {
namespace {

using Json = nlohmann::ordered_json;

// Numbers of the glTF 2.0 specification.
constexpr uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinChunk = 0x004E4942;
constexpr int kFloat = 5126, kUint16 = 5123, kUint32 = 5125;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;
constexpr int kLinear = 9729, kClampToEdge = 33071;
// The greatest index of each type is reserved.
constexpr size_t kMaxShortVertices = 65535;
constexpr size_t kPositions = 0, kNormals = 1, kTexture = 2, kIndices = 3, kPicture = 4;

template <int kRows>
void PutVectors(std::vector<uint8_t>* bytes, std::span<const Eigen::Matrix<float, kRows, 1>> vectors) {
  for (const Eigen::Matrix<float, kRows, 1>& vector : vectors) {
    for (int row = 0; row < kRows; ++row) Put(bytes, vector[row]);
  }
}

Json Triple(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Json ExtrasOf(const GltfPlace& place) {
  return {{"crs", place.crs}, {"offset", Triple(place.offset)}, {"verticalDatum", place.vertical}};
}

}  // namespace

std::vector<uint8_t> GltfDocument::Add(const GltfPrimitive& primitive) {
  const size_t n = primitive.position.size();
  SKYQUILT_CHECK(n > 0 && primitive.normal.size() == n && primitive.uv.size() == n && !primitive.triangle.empty(), "an incomplete glTF primitive");
  Part part;
  part.name = primitive.name;
  part.vertices = n;
  part.triangles = primitive.triangle.size();
  part.short_indices = n <= kMaxShortVertices;
  part.min = part.max = primitive.position.front();
  for (const Eigen::Vector3f& position : primitive.position) {
    part.min = part.min.cwiseMin(position);
    part.max = part.max.cwiseMax(position);
  }
  std::vector<uint8_t> bytes;
  bytes.reserve(32 * n + 12 * primitive.triangle.size() + primitive.jpeg.size() + 8);
  // Each piece begins at a multiple of 4 bytes.
  size_t begin = 0;
  const auto end_piece = [&](size_t piece) {
    part.offset[piece] = binary_bytes_ + begin;
    part.bytes[piece] = bytes.size() - begin;
    while (bytes.size() % 4 != 0) bytes.push_back(0);
    begin = bytes.size();
  };
  PutVectors<3>(&bytes, primitive.position);
  end_piece(kPositions);
  PutVectors<3>(&bytes, primitive.normal);
  end_piece(kNormals);
  PutVectors<2>(&bytes, primitive.uv);
  end_piece(kTexture);
  for (const Triangle& triangle : primitive.triangle) {
    for (const uint32_t index : triangle) {
      if (part.short_indices) {
        Put(&bytes, static_cast<uint16_t>(index));
      } else {
        Put(&bytes, index);
      }
    }
  }
  end_piece(kIndices);
  bytes.insert(bytes.end(), primitive.jpeg.begin(), primitive.jpeg.end());
  end_piece(kPicture);
  binary_bytes_ += bytes.size();
  parts_.push_back(std::move(part));
  return bytes;
}

int64_t GltfDocument::triangles() const {
  int64_t sum = 0;
  for (const Part& part : parts_) sum += static_cast<int64_t>(part.triangles);
  return sum;
}

int64_t GltfDocument::textures() const {
  int64_t sum = 0;
  for (const Part& part : parts_) sum += part.bytes[kPicture] > 0 ? 1 : 0;
  return sum;
}

std::vector<uint8_t> GltfDocument::Head(const GltfPlace& place, const std::filesystem::path& file, uint64_t max_bytes) const {
  SKYQUILT_CHECK(!parts_.empty(), "a glTF file without primitives");
  Json views = Json::array(), accessors = Json::array(), materials = Json::array(), primitives = Json::array();
  Json images = Json::array(), textures = Json::array();
  const auto add_view = [&](const Part& part, size_t piece, int target) {
    Json view = {{"buffer", 0}, {"byteOffset", part.offset[piece]}, {"byteLength", part.bytes[piece]}};
    if (target != 0) view["target"] = target;
    views.push_back(std::move(view));
    return views.size() - 1;
  };
  const auto add_accessor = [&](size_t view, int component, uint64_t count, const char* type) {
    accessors.push_back({{"bufferView", view}, {"componentType", component}, {"count", count}, {"type", type}});
    return accessors.size() - 1;
  };
  for (const Part& part : parts_) {
    const size_t position = add_accessor(add_view(part, kPositions, kArrayBuffer), kFloat, part.vertices, "VEC3");
    accessors.back()["min"] = Triple(part.min.cast<double>());
    accessors.back()["max"] = Triple(part.max.cast<double>());
    const size_t normal = add_accessor(add_view(part, kNormals, kArrayBuffer), kFloat, part.vertices, "VEC3");
    const size_t uv = add_accessor(add_view(part, kTexture, kArrayBuffer), kFloat, part.vertices, "VEC2");
    const size_t indices =
        add_accessor(add_view(part, kIndices, kElementArrayBuffer), part.short_indices ? kUint16 : kUint32, 3 * part.triangles, "SCALAR");
    Json surface = {{"metallicFactor", 0.0}, {"roughnessFactor", 1.0}};
    Json attributes = {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_0", uv}};
    if (part.bytes[kPicture] > 0) {
      images.push_back({{"bufferView", add_view(part, kPicture, 0)}, {"mimeType", "image/jpeg"}, {"name", part.name}});
      textures.push_back({{"sampler", 0}, {"source", images.size() - 1}});
      surface["baseColorTexture"] = {{"index", textures.size() - 1}};
    } else {
      attributes.erase("TEXCOORD_0");
    }
    materials.push_back(
        {{"name", part.name}, {"pbrMetallicRoughness", surface}, {"doubleSided", true}, {"extensions", {{"KHR_materials_unlit", Json::object()}}}});
    primitives.push_back({{"attributes", attributes}, {"indices", indices}, {"material", materials.size() - 1}});
  }
  Json node = {{"name", "surface"}, {"mesh", 0}};
  if (!place.translation.isZero(0.0)) node["translation"] = Triple(place.translation);
  Json document;
  document["asset"] = {{"version", "2.0"}, {"generator", "Skyquilt"}, {"extras", ExtrasOf(place)}};
  document["extensionsUsed"] = Json::array({"KHR_materials_unlit"});
  document["scene"] = 0;
  document["scenes"] = Json::array({{{"nodes", Json::array({0})}, {"extras", ExtrasOf(place)}}});
  document["nodes"] = Json::array({node});
  document["meshes"] = Json::array({{{"name", "surface"}, {"primitives", primitives}}});
  document["materials"] = materials;
  if (!images.empty()) {
    document["textures"] = textures;
    document["images"] = images;
    // Without smaller copies of the texture (mipmaps), which would blend charts that are neighbours in the atlas only.
    document["samplers"] = Json::array({{{"magFilter", kLinear}, {"minFilter", kLinear}, {"wrapS", kClampToEdge}, {"wrapT", kClampToEdge}}});
  }
  document["accessors"] = accessors;
  document["bufferViews"] = views;
  document["buffers"] = Json::array({{{"byteLength", binary_bytes_}}});

  std::string json = base::JsonText(document);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  constexpr uint64_t kGlbHeaderBytes = 12, kChunkHeaderBytes = 8;
  const uint64_t total = kGlbHeaderBytes + kChunkHeaderBytes + json.size() + kChunkHeaderBytes + binary_bytes_;
  if (total > max_bytes) {
    throw base::InputError(file,
                           "would have " + std::to_string(total >> 20U) + " MiB; the format ends at " + std::to_string(max_bytes >> 20U) + " MiB",
                           "Turn it off with surface.glb = false and use tiles/tileset.json, or mesh.obj");
  }
  std::vector<uint8_t> head;
  head.reserve(static_cast<size_t>(total - binary_bytes_));
  Put(&head, kMagic);
  Put(&head, uint32_t{2});
  Put(&head, static_cast<uint32_t>(total));
  Put(&head, static_cast<uint32_t>(json.size()));
  Put(&head, kJsonChunk);
  PutText(&head, json, json.size());
  Put(&head, static_cast<uint32_t>(binary_bytes_));
  Put(&head, kBinChunk);
  return head;
}

}  // namespace skyquilt::surface
