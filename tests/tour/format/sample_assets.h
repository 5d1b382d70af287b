// Small assets of a tour: a model of one triangle with a picture, and pictures.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/base/json_text.h"
#include "core/base/sha256.h"
#include "core/image/image.h"

namespace skyquilt::tour {

inline std::span<const uint8_t> BytesOf(const std::string& text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

inline std::string SamplePng(int width = 5, int height = 3) {
  return image::EncodePng(image::Image8(width, height, 3, 120), 6);
}

inline std::string SampleJpg(int width = 20, int height = 10) {
  const std::vector<uint8_t> bytes = image::EncodeJpeg(image::Image8(width, height, 3, 120), 90);
  return {bytes.begin(), bytes.end()};
}

inline std::string LittleEndianText(uint32_t value) {
  std::string text;
  for (unsigned shift = 0; shift < 32; shift += 8) text += static_cast<char>(static_cast<unsigned char>(value >> shift & 255U));
  return text;
}

inline std::string GlbChunk(const std::string& type, std::string content, char filler) {
  while (content.size() % 4 != 0) content += filler;
  return LittleEndianText(static_cast<uint32_t>(content.size())) + type + content;
}

// magic, version and the length of all that follows.
inline std::string GlbOfChunks(const std::string& chunks, uint32_t version = 2) {
  return "glTF" + LittleEndianText(version) + LittleEndianText(static_cast<uint32_t>(12 + chunks.size())) + chunks;
}

struct SampleModel {
  nlohmann::json json;
  std::string binary;

  SampleModel() {
    const std::string picture = SamplePng();
    binary = std::string(36, '\0') + std::string("\0\0\1\0\2\0\0\0", 8) + picture;
    json = base::ParseJson(R"({
      "asset": {"version": "2.0", "generator": "by hand", "extras": {"uri": "https://example.org/from"}},
      "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"children": [1, 2]}, {"mesh": 0}, {"name": "empty"}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
      "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
      "textures": [{"source": 0}], "images": [{"bufferView": 2, "mimeType": "image/png"}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 0]},
                    {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
      "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}]})");
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 44}, {"byteLength", picture.size()}});
    json["buffers"] = {{{"byteLength", binary.size()}}};
  }

  std::string Glb() const { return GlbOfChunks(GlbChunk("JSON", base::JsonText(json), ' ') + GlbChunk(std::string("BIN\0", 4), binary, '\0')); }
};

inline std::string SampleGlb(const std::function<void(nlohmann::json&)>& change = {}) {
  SampleModel model;
  if (change) change(model.json);
  return model.Glb();
}

// The name under which these bytes are stored.
inline std::string AssetNameOf(const std::string& bytes, const std::string& extension) {
  return base::Sha256Hex(bytes) + "." + extension;
}

}  // namespace skyquilt::tour
