// The sparse points of an OPF project: glTF with binary buffers beside it and the extension OPF_mesh_primitive_matches (opf-spec, "OPF-glTF point
// cloud"). Accessors are packed: no byteStride, no byteOffset of an accessor, no sparse ones.
#pragma once

#include <cstdint>
#include <filesystem>
#include <unordered_map>

#include "prepare/models/input_model.h"

namespace skyquilt::prepare::models {

// image_of_camera: our image ids by the ids of OPF's cameras; matches of other cameras are left out. Throws base::InputError.
void AddOpfPoints(const std::filesystem::path& gltf, const std::unordered_map<uint64_t, uint32_t>& image_of_camera, SfmBuilder& builder);

}  // namespace skyquilt::prepare::models
