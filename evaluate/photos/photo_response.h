// Brightness at which a held-out photo is rendered so that it can be compared with the real one, and scores of brightness.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "core/survey/survey.h"
#include "evaluate/photos/apply_response.h"
#include "evaluate/photos/photo_scorer.h"

namespace skyquilt::evaluate::photos {

// Factor on linear light: the exposure of the photo's tags divided by the survey's reference exposure. 1 without tags, if reference_exposure is 0, or
// if exif_gain is false.
double TaggedGain(const survey::Photo& photo, double reference_exposure, bool exif_gain);
// The recording by the gain of the tags and the vignetting of the camera.
PhotoResponse TaggedResponse(const brightness::Response& response, int camera, double gain);
// `recording` with the gain that training predicts for the photo from the photos before and after.
PhotoResponse PredictedResponse(const brightness::Response& response, size_t photo, PhotoResponse recording);

// PSNR over the scored pixels of a rendering at reference exposure, after applying the recording to it.
double PsnrWithResponse(const HeldOutPhoto& task, const PhotoResponse& recording, std::vector<render::RayColor> colors, const image::Image8& scored,
                        base::ThreadPool& threads);

struct NormalScore {
  double psnr_db = kNotMeasured;
  double ssim = kNotMeasured;
  double psnr_fitted_db = kNotMeasured;  // on the tiles that are not fitted, with gains per colour fitted on the others (alternate_tiles.h)
};
// Compares a rendering at normal brightness with a photo taken at normal brightness. Throws base::InputError for a photo that cannot be used.
NormalScore ScoreNormal(const std::filesystem::path& true_photo, std::span<const render::RayColor> normal, const image::Image8& scored);

}  // namespace skyquilt::evaluate::photos
