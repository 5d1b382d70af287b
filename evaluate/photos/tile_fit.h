// How well a rendering fits a photo when the photo's light were known: gains and shading are fitted on alternate tiles of the photo and scored on the
// others, so that no pixel is both fitted and scored. For photos over which shadows of clouds pass, three gains (ScoreHalves) are not enough.
#pragma once

#include <array>
#include <vector>

#include "core/brightness/shading.h"
#include "core/image/image.h"
#include "core/metrics/psnr.h"

namespace skyquilt::evaluate::photos {

struct TileScores {
  // Over the scored pixels of the tiles that are not fitted: as rendered, with gains per colour, and with gains and shading.
  skyquilt::metrics::SquaredError rendered, gains, shaded;
  std::array<float, 3> log_gain = {0.0F, 0.0F, 0.0F};  // with shading
  std::vector<float> log_shading;                      // [row][column]
};

// render and photo: RGB of the same size, display values at the photo's brightness; those of the rendering may be above 1. scored: one channel, 0 =
// do not use. sigma: of log shading, as in brightness::ShadingOptions. Gauss and Newton on the squared differences of display values.
TileScores ScoreAlternateTiles(const image::ImageF& render, const image::ImageF& photo, const image::Image8& scored,
                               const brightness::ShadingGrid& grid, double sigma);

}  // namespace skyquilt::evaluate::photos
