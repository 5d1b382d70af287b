// A rendering at reference exposure as a photo would have recorded it, and the gains that would have fitted a photo best.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/brightness/response.h"
#include "core/camera/camera.h"
#include "core/image/image.h"
#include "core/metrics/psnr.h"
#include "core/scene/scene.h"

namespace skyquilt::evaluate {

// Gains of a photo as a whole (natural logarithm, linear light) and the vignetting of its camera.
struct Recording {
  std::array<float, 3> log_gain = {0.0F, 0.0F, 0.0F};
  std::array<float, 3> vignetting = {0.0F, 0.0F, 0.0F};  // as in brightness::Response
};

// `colors`: row-major, one per pixel of the camera, at reference exposure. Changes their colours.
void Record(const camera::Camera& camera, const Recording& recording, std::span<render::RayColor> colors, base::ThreadPool& threads);

// What changing a photo's three gains would gain. Fitted on the pixels of the left half, measured on those of the right half (the protocol of
// Martin-Brualla et al. 2021), so that a photo never judges what was fitted to it.
struct HalfScores {
  metrics::SquaredError right;                         // as recorded
  metrics::SquaredError right_fitted;                  // with the gains fitted on the left
  std::array<float, 3> log_gain = {0.0F, 0.0F, 0.0F};  // fitted, on top of what the rendering has; 0 where the left half says nothing
};
// render and photo: RGB of one size, display values as recorded; scored: one channel, 0 = leave out.
HalfScores ScoreHalves(const image::ImageF& render, const image::ImageF& photo, const image::Image8& scored);

}  // namespace skyquilt::evaluate
