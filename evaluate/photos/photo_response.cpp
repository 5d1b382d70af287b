#include "evaluate/photos/photo_response.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/metrics/psnr.h"
#include "core/metrics/ssim.h"
#include "evaluate/photos/tile_fit.h"

namespace skyquilt::evaluate::photos {
namespace {

image::ImageF AsImage(std::span<const render::RayColor> colors, int width, int height) {
  image::ImageF image(width, height, 3);
  SKYQUILT_CHECK(3 * colors.size() == image.data.size(), "there must be one colour per pixel");
  for (size_t i = 0; i < colors.size(); ++i) {
    for (size_t c = 0; c < 3; ++c) {
      const float value = colors[i].rgb_srgb[c];
      image.data[3 * i + c] = std::isfinite(value) ? std::clamp(value, 0.0F, 1.0F) : 0.0F;
    }
  }
  return image;
}

}  // namespace

double TaggedGain(const survey::Photo& photo, double reference_exposure, bool exif_gain) {
  if (!exif_gain || !(reference_exposure > 0.0)) return 1.0;
  const auto exposure = brightness::ExifExposure(photo.exposure.time_s, photo.exposure.f_number, photo.exposure.iso);
  // Tags more than ten stops from the reference are wrong. Training limits gains in the same way.
  return exposure ? std::clamp(*exposure / reference_exposure, 0x1.0p-10, 0x1.0p10) : 1.0;
}

PhotoResponse TaggedResponse(const brightness::Response& response, int camera, double gain) {
  PhotoResponse recording;
  recording.log_gain.fill(static_cast<float>(std::log(gain)));
  const auto at = 3 * static_cast<size_t>(camera);
  if (at + 3 <= response.vignetting.size()) std::copy_n(response.vignetting.begin() + static_cast<ptrdiff_t>(at), 3, recording.vignetting.begin());
  return recording;
}

PhotoResponse PredictedResponse(const brightness::Response& response, size_t photo, PhotoResponse recording) {
  for (size_t c = 0; c < 3 && 3 * photo + c < response.log_gain.size(); ++c) recording.log_gain[c] += response.log_gain[3 * photo + c];
  return recording;
}

double PsnrWithResponse(const HeldOutPhoto& task, const PhotoResponse& recording, std::vector<render::RayColor> colors, const image::Image8& scored,
                        base::ThreadPool& threads) {
  ApplyResponse(task.camera, recording, colors, threads);
  return skyquilt::metrics::Psnr(AsImage(colors, task.photo.width, task.photo.height), image::ToImageF(task.photo), &scored);
}

NormalScore ScoreNormal(const std::filesystem::path& true_photo, std::span<const render::RayColor> normal, const image::Image8& scored) {
  image::Image8 truth = image::LoadRgb8(true_photo);
  if (truth.width != scored.width || truth.height != scored.height) {
    const int height = image::ScaledHeight(truth.width, truth.height, scored.width);
    if (height != scored.height) {
      throw base::InputError(true_photo, "has another aspect ratio than the photo of the same name",
                             "Set evaluate.normal_photos to a folder of the same photos");
    }
    truth = image::Resize(truth, scored.width, height);
  }
  const image::ImageF render = AsImage(normal, scored.width, scored.height), photo = image::ToImageF(truth);
  const TileScores tiles = ScoreAlternateTiles(render, photo, scored, {2, 2}, 1.0);
  return {skyquilt::metrics::Psnr(render, photo, &scored), skyquilt::metrics::Ssim(render, photo, &scored), skyquilt::metrics::PsnrOf(tiles.gains)};
}

}  // namespace skyquilt::evaluate::photos
