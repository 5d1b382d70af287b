// The names of a tour's assets: models and pictures are stored as <SHA-256 of the bytes>.<type>, so that a name stands for one content.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace skyquilt::tour {

enum class AssetType { kGlb, kPng, kJpg };

struct AssetName {
  std::string digest;  // 64 lower-case hexadecimal digits
  AssetType type = AssetType::kGlb;

  // The file's name, made of its parts: never what a client sent.
  std::string File() const;
};

// Nothing for any other text, so that no name leads out of a folder.
std::optional<AssetName> ParseAssetName(std::string_view name);
// "glb", "png" or "jpg".
const char* Extension(AssetType type);
// "model/gltf-binary", "image/png" or "image/jpeg".
const char* ContentType(AssetType type);

}  // namespace skyquilt::tour
