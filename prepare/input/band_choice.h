// Which bands of a photo become its colours.
#pragma once

#include <string>
#include <vector>

#include "core/image/pixel_format.h"

namespace skyquilt::prepare::input {

struct BandChoice {
  std::vector<int> bands;  // red, green, blue, or one for a grey picture; from 1
  std::string problem;     // not empty: no bands could be chosen; what was found and what to set
};

// `wanted`: prepare.bands, one or three numbers (from 1) or names, separated by commas; empty: the bands named red, green and blue, else the first
// three where the file says that they are, or has three besides alpha, or the only one. `names`: of the bands, as far as known. Names are compared
// without case, spaces and punctuation.
BandChoice ChooseBands(const image::PixelFormat& format, const std::vector<std::string>& names, const std::string& wanted);

// Throws base::UsageError when the text of the option cannot be right for any photo: neither one nor three parts, an empty part, 0.
void CheckBandsOption(const std::string& wanted);

}  // namespace skyquilt::prepare::input
