#include "tour/format/glb_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tour/format/asset_check.h"

namespace skyquilt::tour {
namespace {

using base::Refused;
using Bytes = std::span<const uint8_t>;
using Json = nlohmann::json;

constexpr uint32_t kMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;
constexpr size_t kHeaderBytes = 12, kChunkHeadBytes = 8;
constexpr size_t kMaxJsonBytes = 4U << 20U;          // read into memory as a tree
constexpr uint64_t kMaxAccessorBytes = 256U << 20U;  // without a buffer view they are zeros that a viewer makes
constexpr uint64_t kMaxStride = 252;
constexpr uint64_t kMaxWhole = UINT32_MAX;

uint32_t LittleEndian(Bytes bytes, size_t at) {
  uint32_t value = 0;
  for (size_t i = 4; i-- > 0;) value = value << 8U | bytes[at + i];
  return value;
}

struct Chunks {
  std::string_view json;
  Bytes binary;
};

Chunks SplitChunks(Bytes bytes) {
  if (bytes.size() < kHeaderBytes || LittleEndian(bytes, 0) != kMagic) throw Refused("it is not a GLB model (binary glTF)");
  if (LittleEndian(bytes, 4) != 2) throw Refused("it is not of version 2 of glTF: export the model as glTF 2.0 binary (.glb)");
  if (LittleEndian(bytes, 8) < bytes.size()) throw Refused("it goes on after the end of the GLB model");
  if (LittleEndian(bytes, 8) > bytes.size()) throw Refused("it is a GLB model that ends early");
  Chunks chunks;
  Bytes rest = bytes.subspan(kHeaderBytes);
  for (size_t i = 0; !rest.empty(); ++i) {
    const bool whole = rest.size() >= kChunkHeadBytes && LittleEndian(rest, 0) <= rest.size() - kChunkHeadBytes;
    if (!whole || LittleEndian(rest, 0) % 4 != 0) throw Refused("it is a damaged GLB model: its parts do not fill it");
    const Bytes content = rest.subspan(kChunkHeadBytes, LittleEndian(rest, 0));
    const uint32_t type = LittleEndian(rest, 4);
    if (i == 0 && type == kJsonChunk) {
      chunks.json = {reinterpret_cast<const char*>(content.data()), content.size()};
    } else if (i == 1 && type == kBinaryChunk) {
      chunks.binary = content;
    } else {
      throw Refused("it is a GLB model with parts that are not known: export it without them");
    }
    rest = rest.subspan(kChunkHeadBytes + content.size());
  }
  if (chunks.json.empty()) throw Refused("it is a GLB model without content");
  return chunks;
}

// Models of the web come with notes about their origin in "extras", which nothing follows.
bool HasUri(const Json& json) {
  if (json.is_object()) {
    return std::any_of(json.items().begin(), json.items().end(),
                       [](const auto& member) { return member.key() == "uri" || (member.key() != "extras" && HasUri(member.value())); });
  }
  return json.is_array() && std::any_of(json.begin(), json.end(), HasUri);
}

bool IsUnderstood(const std::string& extension) {
  return extension.starts_with("KHR_materials_") || extension == "KHR_texture_transform" || extension == "KHR_mesh_quantization" ||
         extension == "KHR_lights_punctual";
}

const Json& Member(const Json& object, const char* key) {
  static const Json missing;
  if (!object.is_object()) return missing;
  const auto at = object.find(key);
  return at == object.end() ? missing : *at;
}

class Document {
 public:
  explicit Document(const Chunks& chunks) : json_(ParseDocumentOf(chunks.json)), binary_(chunks.binary) {
    if (!json_.is_object()) throw Refused("its description is not an object");
  }

  void Check() {
    const Json& version = Member(Member(json_, "asset"), "version");
    if (!version.is_string() || !version.get_ref<const std::string&>().starts_with("2.")) throw Refused("it does not say that it is glTF 2");
    if (HasUri(json_)) {
      throw Refused("it refers to other files or holds data as text (\"uri\"): export it with everything included, as one binary file");
    }
    CheckExtensions();
    CheckBuffer();
    Each("bufferViews", [this](const Json& view, const std::string& where) { CheckView(view, where); });
    Each("accessors", [this](const Json& accessor, const std::string& where) { CheckAccessor(accessor, where); });
    Each("images", [this](const Json& image, const std::string& where) { CheckImage(image, where); });
    Each("meshes", [this](const Json& mesh, const std::string& where) { CheckMesh(mesh, where); });
    if (Count("meshes") == 0 || Count("scenes") == 0) throw Refused("it has no meshes or no scene: there is nothing to show");
    CheckNodes();
  }

 private:
  static Json ParseDocumentOf(std::string_view text) {
    if (text.size() > kMaxJsonBytes) throw Refused("its description is longer than 4 MiB: simplify the model");
    try {
      return base::ParseDocument(text);
    } catch (const Refused& refused) {
      throw Refused(std::string("its description cannot be read: ") + refused.what());
    }
  }

  size_t Count(const char* key) const { return Member(json_, key).size(); }

  template <typename Visit>
  void Each(const char* key, const Visit& visit) const {
    const Json& list = Member(json_, key);
    if (list.is_null()) return;
    if (!list.is_array()) throw Refused(std::string(key) + " must be a list");
    for (size_t i = 0; i < list.size(); ++i) visit(list[i], std::string(key) + "[" + std::to_string(i) + "]");
  }

  // A whole number from 0, below 2^32; `otherwise` when it is missing.
  static uint64_t Whole(const Json& object, const char* key, const std::string& where, std::optional<uint64_t> otherwise = {}) {
    const Json& value = Member(object, key);
    if (value.is_null() && otherwise) return *otherwise;
    // Some programs write 1.0 for 1.
    const double number = value.is_number() ? value.get<double>() : -1.0;
    if (!(number >= 0.0 && number <= static_cast<double>(kMaxWhole)) || number != std::floor(number)) {
      throw Refused(where + "." + key + " must be a whole number");
    }
    return static_cast<uint64_t>(number);
  }

  // An index into a list of the document.
  const Json& At(const char* list, const Json& object, const char* key, const std::string& where) const {
    const uint64_t index = Whole(object, key, where);
    if (index >= Count(list)) throw Refused(where + "." + key + " leads to nothing in " + list);
    return Member(json_, list)[index];
  }

  void CheckExtensions() const {
    Each("extensionsRequired", [](const Json& extension, const std::string& where) {
      if (!extension.is_string()) throw Refused(where + " must be a text");
      const auto& name = extension.get_ref<const std::string&>();
      if (IsUnderstood(name)) return;
      std::string shown = name.substr(0, 60);
      std::erase_if(shown, [](char c) { return c < ' ' || c > '~'; });
      throw Refused("it needs " + shown + ", which the viewer does not understand: export it without compression and extensions");
    });
  }

  void CheckBuffer() const {
    if (Count("buffers") > 1) throw Refused("it has more than one buffer: export it as one binary file");
    Each("buffers", [this](const Json& buffer, const std::string& where) {
      const uint64_t bytes = Whole(buffer, "byteLength", where);
      // The chunk may be filled up to a multiple of 4.
      if (bytes > binary_.size() || binary_.size() - bytes > 3) throw Refused(where + ".byteLength is not the length of its data");
    });
    if (Count("buffers") == 0 && !binary_.empty()) throw Refused("it has data that nothing describes");
  }

  void CheckView(const Json& view, const std::string& where) const {
    const Json& buffer = At("buffers", view, "buffer", where);
    const uint64_t end = Whole(view, "byteOffset", where, 0) + Whole(view, "byteLength", where);
    if (end > Whole(buffer, "byteLength", where)) throw Refused(where + " goes beyond its buffer");
  }

  static uint64_t ComponentBytes(const Json& accessor, const std::string& where) {
    switch (Whole(accessor, "componentType", where)) {
      case 5120:
      case 5121:
        return 1;
      case 5122:
      case 5123:
        return 2;
      case 5125:
      case 5126:
        return 4;
      default:
        throw Refused(where + ".componentType is not known");
    }
  }

  static uint64_t ElementBytes(const Json& accessor, const std::string& where) {
    struct Shape {
      const char* name;
      uint64_t columns, rows;
    };
    static constexpr std::array<Shape, 7> kShapes = {
        {{"SCALAR", 1, 1}, {"VEC2", 1, 2}, {"VEC3", 1, 3}, {"VEC4", 1, 4}, {"MAT2", 2, 2}, {"MAT3", 3, 3}, {"MAT4", 4, 4}}};
    const uint64_t component = ComponentBytes(accessor, where);
    const Json& type = Member(accessor, "type");
    for (const Shape& shape : kShapes) {
      if (type != shape.name) continue;
      // Each column of a matrix begins at a multiple of 4 bytes.
      const uint64_t column = shape.rows * component;
      return shape.columns * (shape.columns > 1 ? (column + 3) / 4 * 4 : column);
    }
    throw Refused(where + ".type is not known");
  }

  void RequireInView(const Json& owner, uint64_t count, uint64_t element, const std::string& where) const {
    const Json& view = At("bufferViews", owner, "bufferView", where);
    const uint64_t stride = Whole(view, "byteStride", where, element);
    if (stride != element && (stride < element || stride > kMaxStride)) throw Refused(where + ": the stride of its bufferView is not allowed");
    const uint64_t used = count == 0 ? 0 : (count - 1) * stride + element;
    if (Whole(owner, "byteOffset", where, 0) + used > Whole(view, "byteLength", where)) throw Refused(where + " goes beyond its bufferView");
  }

  void CheckAccessor(const Json& accessor, const std::string& where) const {
    const uint64_t count = Whole(accessor, "count", where), element = ElementBytes(accessor, where);
    if (count * element > kMaxAccessorBytes) throw Refused(where + " is too large");
    if (!Member(accessor, "bufferView").is_null()) RequireInView(accessor, count, element, where);
    const Json& sparse = Member(accessor, "sparse");
    if (sparse.is_null()) return;
    const uint64_t changed = Whole(sparse, "count", where + ".sparse");
    if (changed > count) throw Refused(where + ".sparse.count is more than there are");
    const Json& indices = Member(sparse, "indices");
    RequireInView(indices, changed, ComponentBytes(indices, where + ".sparse.indices"), where + ".sparse.indices");
    RequireInView(Member(sparse, "values"), changed, element, where + ".sparse.values");
  }

  void CheckImage(const Json& image, const std::string& where) {
    const Json& view = At("bufferViews", image, "bufferView", where);
    const Json& type = Member(image, "mimeType");
    if (type != "image/png" && type != "image/jpeg") throw Refused(where + " must be a PNG or JPEG picture: export the model with such textures");
    const Bytes bytes = binary_.subspan(Whole(view, "byteOffset", where, 0), Whole(view, "byteLength", where));
    if (!checked_images_.insert({Whole(image, "bufferView", where), type == "image/png"}).second) return;
    // Views that overlap could have the same bytes checked for hours.
    image_bytes_ += bytes.size();
    if (image_bytes_ > binary_.size()) throw Refused("its pictures overlap");
    try {
      CheckAsset(type == "image/png" ? AssetType::kPng : AssetType::kJpg, bytes);
    } catch (const Refused& refused) {
      throw Refused(where + ": " + refused.what());
    }
  }

  void CheckMesh(const Json& mesh, const std::string& where) const {
    const Json& primitives = Member(mesh, "primitives");
    if (!primitives.is_array() || primitives.empty()) throw Refused(where + ".primitives must be a list");
    for (size_t i = 0; i < primitives.size(); ++i) {
      const std::string path = where + ".primitives[" + std::to_string(i) + "]";
      const Json& attributes = Member(primitives[i], "attributes");
      if (!attributes.is_object() || !attributes.contains("POSITION")) throw Refused(path + " has no positions");
      for (const auto& [name, ignored] : attributes.items()) At("accessors", attributes, name.c_str(), path + ".attributes");
      if (!Member(primitives[i], "indices").is_null()) At("accessors", primitives[i], "indices", path);
    }
  }

  // Whoever follows the children of nodes must come to an end.
  void CheckNodes() const {
    const size_t n = Count("nodes");
    std::vector<size_t> parent(n, n);
    Each("nodes", [&](const Json& node, const std::string& where) {
      if (!node.is_object()) throw Refused(where + " must be an object");
      if (!Member(node, "mesh").is_null()) At("meshes", node, "mesh", where);
      const Json& children = Member(node, "children");
      if (!children.is_null() && !children.is_array()) throw Refused(where + ".children must be a list");
      for (const Json& child : children) {
        const uint64_t index = Whole({{"child", child}}, "child", where);
        if (index >= n || parent[index] != n) throw Refused(where + ".children is no tree");
        parent[index] = IndexOf(node);
      }
    });
    // 1: leads to a root; 2: on the way that is followed now.
    std::vector<uint8_t> state(n, 0);
    for (size_t i = 0; i < n; ++i) {
      size_t at = i;
      while (at != n && state[at] == 0) {
        state[at] = 2;
        at = parent[at];
      }
      if (at != n && state[at] == 2) throw Refused("its nodes are their own children");
      for (at = i; at != n && state[at] == 2; at = parent[at]) state[at] = 1;
    }
  }

  size_t IndexOf(const Json& node) const { return static_cast<size_t>(&node - &Member(json_, "nodes")[0]); }

  const Json json_;
  const Bytes binary_;
  std::set<std::pair<uint64_t, bool>> checked_images_;  // view, whether as PNG
  uint64_t image_bytes_ = 0;
};

}  // namespace

void CheckGlb(Bytes bytes) {
  Document(SplitChunks(bytes)).Check();
}

}  // namespace skyquilt::tour
