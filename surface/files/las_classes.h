// Classes of a cloud that is already written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "surface/map_frame.h"
#include "surface/mesh.h"

namespace skyquilt::surface {

// Gives each point of cloud.las (or cloud_1.las, cloud_2.las, ...) in the folder the class code of the same position in `codes`; count and
// coordinates (to 2 mm) must agree with `positions`, else nothing is changed. Each file is written under another name and renamed. Throws
// base::InputError: no cloud, damaged, another cloud, disk full.
void RewriteLasClasses(const std::filesystem::path& folder, const MapFrame& frame, std::span<const Eigen::Vector3d> positions_enu,
                       std::span<const uint8_t> codes);

}  // namespace skyquilt::surface
