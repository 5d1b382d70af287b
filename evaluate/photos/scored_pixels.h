// Which pixels of a held-out photo were scored, and their errors, as one grey picture. Studies keep these, so that scenes with different coverage can
// be compared on the pixels that all of them cover.
//   0        not scored
//   1 + k    scored; k = 254 * sqrt(e), where e is the root of the mean squared error over the colours, display values in [0, 1]
// The square root makes steps of small errors small. As rendering and errors are rounded, a PSNR from them is off by up to 0.05 dB at 40 dB and 0.1
// dB at 46 dB, and hardly at less.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "core/image/image.h"
#include "evaluate/photos/held_out_scorer.h"

namespace skyquilt::evaluate::photos {

// photo, render: RGB; scored: one channel of the same size, 0 = not scored.
image::Image8 ScoredPixels(const image::Image8& photo, const image::Image8& render, const image::Image8& scored);
// The mean squared error over the colours of a scored pixel; value: at least 1.
double SquaredErrorOf(uint8_t value);
// folder/NAME_OF_THE_PHOTO.png
std::filesystem::path ScoredPixelsFile(const std::filesystem::path& folder, const std::string& photo);
// Writes that file. Throws base::InputError.
void WriteScoredPixels(const ScoredPhoto& scored, const std::filesystem::path& folder);

}  // namespace skyquilt::evaluate::photos
