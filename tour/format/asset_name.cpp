#include "tour/format/asset_name.h"

#include <algorithm>

namespace skyquilt::tour {
namespace {

constexpr size_t kDigestDigits = 64;

bool IsDigestDigit(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
}

}  // namespace

std::string AssetName::File() const {
  return digest + "." + Extension(type);
}

std::optional<AssetName> ParseAssetName(std::string_view name) {
  if (name.size() != kDigestDigits + 4 || name[kDigestDigits] != '.') return {};
  const std::string_view digest = name.substr(0, kDigestDigits), extension = name.substr(kDigestDigits + 1);
  if (!std::all_of(digest.begin(), digest.end(), IsDigestDigit)) return {};
  for (const AssetType type : {AssetType::kGlb, AssetType::kPng, AssetType::kJpg}) {
    if (extension == Extension(type)) return AssetName{.digest = std::string(digest), .type = type};
  }
  return {};
}

const char* Extension(AssetType type) {
  switch (type) {
    case AssetType::kGlb:
      return "glb";
    case AssetType::kPng:
      return "png";
    case AssetType::kJpg:
      break;
  }
  return "jpg";
}

const char* ContentType(AssetType type) {
  switch (type) {
    case AssetType::kGlb:
      return "model/gltf-binary";
    case AssetType::kPng:
      return "image/png";
    case AssetType::kJpg:
      break;
  }
  return "image/jpeg";
}

}  // namespace skyquilt::tour
