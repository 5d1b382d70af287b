// Sparse points as a binary little-endian PLY: double x y z, uchar red green blue, float error, int track.
#pragma once

#include <filesystem>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::survey {

// Throw base::InputError: cannot be written, or not the file that WritePointsPly writes (header, size, coordinates that are not numbers).
void WritePointsPly(const std::vector<SparsePoint>& points, const std::filesystem::path& file);
std::vector<SparsePoint> ReadPointsPly(const std::filesystem::path& file);

}  // namespace skyquilt::survey
