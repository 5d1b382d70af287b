// Whether bytes are a binary glTF 2.0 file that a viewer can show without reading anything else.
// Source: Khronos Group, glTF 2.0 Specification, 2.0.1, 2021.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/checked_json.h"

namespace skyquilt::tour {

// The header's length is that of the file; a JSON chunk of at most 4 MiB and at most one binary chunk fill it. No address ("uri") anywhere but in
// "extras": the file holds all its buffers, and PNG and JPEG pictures in buffer views, which are checked like assets. Views, accessors and the tree
// of nodes stay within bounds. Extensions that must be understood are those of materials, texture coordinates, lights and quantised vertices. Throws
// base::Refused with the reason.
void CheckGlb(std::span<const uint8_t> bytes);

}  // namespace skyquilt::tour
