// Whether an uploaded file is what its name says, by its content.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/checked_json.h"
#include "tour/format/asset_name.h"

namespace skyquilt::tour {

constexpr size_t kMaxAssetBytes = 50U << 20U;
constexpr int kMaxPictureSide = 16384;

// PNG: all chunks are whole, with their checksums, up to the end of the file. JPEG: of a kind that browsers show, whole; cameras write previews after
// its end. Both: at most 16384 pixels wide and high. GLB: see CheckGlb. Pixels and vertices are not decoded. Throws base::Refused with the reason.
void CheckAsset(AssetType type, std::span<const uint8_t> bytes);

}  // namespace skyquilt::tour
