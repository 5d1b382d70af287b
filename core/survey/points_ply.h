// Stores sparse points in a file that any point-cloud viewer opens: binary little-endian PLY with double x y z, uchar red green blue, float error,
// int track.
#pragma once

#include <filesystem>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::survey {

// Throw base::InputError: cannot be written, or not a file from WritePointsPly (header, size, coordinates that are not finite).
void WritePointsPly(const std::vector<SparsePoint>& points, const std::filesystem::path& file);
std::vector<SparsePoint> ReadPointsPly(const std::filesystem::path& file);

}  // namespace skyquilt::survey
