// Applies a photo's exposure and the camera's vignetting to a rendering at reference exposure, and finds the gains that would fit a photo best.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/brightness/response.h"
#include "core/camera/camera.h"
#include "core/image/image.h"
#include "core/metrics/psnr.h"
#include "core/scene/scene.h"

namespace skyquilt::evaluate::photos {

// Gains of a photo (natural logarithm, linear light; red, green, blue) and the vignetting of its camera.
struct PhotoResponse {
  std::array<float, 3> log_gain = {0.0F, 0.0F, 0.0F};
  std::array<float, 3> vignetting = {0.0F, 0.0F, 0.0F};  // as in brightness::Response
};

// Applies the recording in place. colors: row-major, one per pixel of the camera, at reference exposure.
void ApplyResponse(const camera::Camera& camera, const PhotoResponse& recording, std::span<render::RayColor> colors, base::ThreadPool& threads);

// Tells how much of the error is brightness: three gains are fitted on the left half of a photo and scored on the right half (the protocol of
// Martin-Brualla et al. 2021), so that no pixel is both fitted and scored.
struct HalfScores {
  skyquilt::metrics::SquaredError right;               // as recorded
  skyquilt::metrics::SquaredError right_fitted;        // with the gains fitted on the left
  std::array<float, 3> log_gain = {0.0F, 0.0F, 0.0F};  // fitted, in addition to the rendering's; 0 when the left half has no usable pixels
};
// render and photo: RGB of the same size, display values at the photo's brightness. scored: one channel, 0 = do not use.
HalfScores ScoreHalves(const image::ImageF& render, const image::ImageF& photo, const image::Image8& scored);

}  // namespace skyquilt::evaluate::photos
