// How bright a held-out photo is to be rendered, and scores that ask just that.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "core/survey/survey.h"
#include "evaluate/photo_scorer.h"
#include "evaluate/recorded.h"

namespace skyquilt::evaluate {

// Exposure over the survey's reference as the photo's tags have it; 1 without tags, reference (0) or exif_gain.
double TaggedGain(const survey::Photo& photo, double reference_exposure, bool exif_gain);
// How a photo records light as far as its tags and its camera say.
Recording TaggedRecording(const brightness::Response& response, int camera, double gain);
// The same with what training predicts for it from the photos before and after.
Recording PredictedRecording(const brightness::Response& response, size_t photo, Recording recording);

// PSNR over the scored pixels of a rendering at reference exposure, recorded like this.
double PsnrRecorded(const PhotoTask& task, const Recording& recording, std::vector<render::RayColor> colors, const image::Image8& scored,
                    base::ThreadPool& threads);

struct NormalScore {
  double psnr_db = kNotMeasured;
  double ssim = kNotMeasured;
};
// What the scene shows at normal brightness against a photo that was taken at it. Throws base::InputError.
NormalScore ScoreNormal(const std::filesystem::path& true_photo, std::span<const render::RayColor> normal, const image::Image8& scored);

}  // namespace skyquilt::evaluate
