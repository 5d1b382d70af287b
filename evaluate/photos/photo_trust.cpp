#include "evaluate/photos/photo_trust.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/metrics/psnr.h"
#include "core/scene/camera_rays.h"

namespace skyquilt::evaluate::photos {
namespace {

constexpr size_t kSamplePixels = 4000;

float MeanSquaredError(const render::RayColor& color, const uint8_t* photo) {
  float sum = 0.0F;
  for (size_t c = 0; c < 3; ++c) {
    const float value = std::isfinite(color.rgb_srgb[c]) ? std::clamp(color.rgb_srgb[c], 0.0F, 1.0F) : 0.0F;
    const float error = value - static_cast<float>(photo[c]) / 255.0F;
    sum += error * error / 3.0F;
  }
  return sum;
}

}  // namespace

std::vector<skyquilt::trust::PixelFacts> FactsOfPhoto(const skyquilt::trust::Trust& trust, const HeldOutPhoto& task, bool cones,
                                                      std::span<const render::RayColor> rendered, base::ThreadPool& threads) {
  const scene::CameraRays camera(task.camera, task.cam_from_enu, cones);
  const skyquilt::trust::RowRays rays = [&](int row, std::span<render::Ray> of_row) { camera.MakeRow(row, of_row); };
  return skyquilt::trust::FactsOf(trust.evidence, task.camera.width, task.camera.height, rendered, rays, threads);
}

PhotoTrust CompareTrust(const skyquilt::trust::Trust& trust, const std::vector<skyquilt::trust::PixelFacts>& facts, const HeldOutPhoto& task,
                        std::span<const render::RayColor> recorded, const image::Image8& scored, base::ThreadPool& threads) {
  PhotoTrust result;
  result.expected = skyquilt::trust::PictureOf(trust.model, task.camera.width, task.camera.height, recorded, facts, threads);
  double squares = 0.0;
  std::vector<size_t> covered;
  for (size_t i = 0; i < facts.size(); ++i) {
    const float error = result.expected.error.data[i];
    if (scored.data[i] == 0 || !std::isfinite(error)) continue;
    squares += static_cast<double>(error) * static_cast<double>(error);
    covered.push_back(i);
  }
  if (covered.empty()) return result;
  result.expected_psnr_db = -10.0 * std::log10(squares / static_cast<double>(covered.size()));
  const size_t taken = std::min(covered.size(), kSamplePixels);
  for (size_t k = 0; k < taken; ++k) {
    const size_t i = covered[k * covered.size() / taken];
    result.sample.squared_error.push_back(MeanSquaredError(recorded[i], task.photo.data.data() + 3 * i));
    result.sample.expected.push_back(result.expected.error.data[i]);
    result.sample.photos.push_back(facts[i].evidence.photos);
    result.sample.gradient.push_back(facts[i].gradient);
    result.sample.opacity.push_back(facts[i].opacity);
  }
  return result;
}

}  // namespace skyquilt::evaluate::photos
