// The two encodings of a COLMAP model, each read without judging the content; ReadColmapModel checks it.
#pragma once

#include <filesystem>

#include "core/survey/colmap_model.h"

namespace skyquilt::survey {

// Throw base::InputError: missing file, truncation, counts that the file's size cannot hold, unsupported camera model, lines that cannot be read.
ColmapModel ReadColmapBinary(const std::filesystem::path& folder);
ColmapModel ReadColmapTextFiles(const std::filesystem::path& folder);

}  // namespace skyquilt::survey
