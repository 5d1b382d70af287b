// Transparent pictures over a background, as published results on synthetic scenes show them.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/image/image.h"

namespace skyquilt::image {

// As LoadRgb8, over a grey of `background`: stored value * alpha + background * (1 - alpha), rounded, in stored values and not in linear light, as
// NeRF's readers do. Files without alpha are as by LoadRgb8. Throws base::InputError.
Image8 LoadRgb8Over(const std::filesystem::path& file, uint8_t background);

}  // namespace skyquilt::image
