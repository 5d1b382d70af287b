#include "evaluate/photo_scorer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/errors.h"
#include "core/metrics/depth_errors.h"
#include "core/metrics/psnr.h"
#include "core/metrics/ssim.h"
#include "evaluate/recorded.h"

namespace skyquilt::evaluate {

namespace {

struct RowSums {
  metrics::SquaredError full, covered;
  SeamErrors seams;
  std::vector<metrics::SquaredError> per_block;
  int64_t used = 0;
};

// Averaging would invent depths between roof and ground.
image::ImageF ResizeNearest(const image::ImageF& image, int width, int height) {
  const auto scaled = [](int i, int n, int m) { return std::min(static_cast<int>((i + 0.5) * m / n), m - 1); };
  image::ImageF resized(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) *resized.At(x, y) = *image.At(scaled(x, width, image.width), scaled(y, height, image.height));
  }
  return resized;
}

}  // namespace

PhotoFindings ScorePhoto(const PhotoTask& task, std::span<const render::RayColor> rendered, const TrainingViews& views, const SceneArea& area,
                         base::ThreadPool& threads) {
  const int width = task.camera.width;
  const int height = task.camera.height;
  const size_t n_pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  SKYQUILT_CHECK(task.photo.width == width && task.photo.height == height && task.photo.channels == 3, "a photo of the camera's size");
  SKYQUILT_CHECK(rendered.size() == n_pixels, "one rendered ray per pixel");
  SKYQUILT_CHECK(task.mask.empty() || task.mask.size() == n_pixels, "a mask of the camera's size");

  const image::ImageF photo = image::ToImageF(task.photo);
  image::ImageF render(width, height, 3);
  image::ImageF unclamped(width, height, 3);
  PhotoFindings findings;
  findings.scored = image::Image8(width, height, 1, 0);
  findings.z_depth = image::ImageF(width, height, 1, std::numeric_limits<float>::quiet_NaN());

  const geo::Rigid3d enu_from_cam = task.cam_from_enu.Inverse();
  const Eigen::Vector3d origin = task.cam_from_enu.OriginInSource();
  const std::vector<int> order = views.ByDistance(origin);
  std::vector<RowSums> rows(static_cast<size_t>(height));
  threads.ParallelFor(height, [&](int64_t row, int) {
    const int y = static_cast<int>(row);
    RowSums& sums = rows[static_cast<size_t>(y)];
    sums.per_block.resize(area.boxes.size());
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      const render::RayColor& ray = rendered[i];
      float* rgb = render.At(x, y);
      for (int c = 0; c < 3; ++c) {
        const float value = std::isfinite(ray.rgb_srgb[c]) ? std::max(ray.rgb_srgb[c], 0.0F) : 0.0F;
        unclamped.At(x, y)[c] = value;
        rgb[c] = std::min(value, 1.0F);
      }
      const Eigen::Vector3d direction_in_cam = task.camera.RayFromImg({x + 0.5, y + 0.5});
      const double median_m = static_cast<double>(ray.depth_median);
      *findings.z_depth.At(x, y) = static_cast<float>(median_m * direction_in_cam.z());
      if (!task.mask.empty() && task.mask[i] == 0) continue;
      ++sums.used;
      AddPixel(rgb, photo.At(x, y), &sums.full);
      const auto surface = SurfacePoint(origin, enu_from_cam.rotation * direction_in_cam, median_m, area.heights);
      if (!surface) continue;
      const int block = BlockAt(*surface, area.boxes);
      if (block < 0 || views.Count(*surface, order, 2) < 2) continue;
      findings.scored.data[i] = 1;
      AddPixel(rgb, photo.At(x, y), &sums.covered);
      AddPixel(rgb, photo.At(x, y), &sums.per_block[static_cast<size_t>(block)]);
      const Zone zone = ZoneAt(*surface, block, area.boxes);
      if (zone != Zone::kInterior && zone != Zone::kSeam) continue;
      auto& group = zone == Zone::kSeam ? sums.seams.seam : sums.seams.interior;
      AddPixel(rgb, photo.At(x, y), &group[static_cast<size_t>(TextureClass(photo, x, y))]);
    }
  });

  metrics::SquaredError full, covered;
  findings.per_block.resize(area.boxes.size());
  PhotoScore& score = findings.score;
  for (const RowSums& sums : rows) {
    full += sums.full;
    covered += sums.covered;
    findings.seams += sums.seams;
    for (size_t b = 0; b < area.boxes.size(); ++b) findings.per_block[b] += sums.per_block[b];
    score.used_pixels += sums.used;
  }
  score.width = width;
  score.height = height;
  score.covered_pixels = PixelsOf(covered);
  score.psnr_db = metrics::PsnrOf(covered);
  score.psnr_full_db = metrics::PsnrOf(full);

  image::Image8 used;
  if (!task.mask.empty()) {
    used = image::Image8(width, height, 1);
    used.data = task.mask;
  }
  HalfScores halves;
  threads.ParallelFor(3, [&](int64_t which, int) {
    if (which == 0) score.ssim = metrics::Ssim(render, photo, &findings.scored);
    if (which == 1) score.ssim_full = metrics::Ssim(render, photo, used.Empty() ? nullptr : &used);
    if (which == 2) halves = ScoreHalves(unclamped, photo, findings.scored);
  });
  score.right_half_db = metrics::PsnrOf(halves.right);
  score.right_half_fitted_db = metrics::PsnrOf(halves.right_fitted);
  for (size_t c = 0; c < 3; ++c) score.fitted_stops[c] = static_cast<double>(halves.log_gain[c]) / std::numbers::ln2;

  if (!task.true_depth.Empty()) {
    findings.true_depth = ResizeNearest(task.true_depth, width, height);
    const metrics::DepthErrors errors = metrics::CompareDepth(findings.z_depth, findings.true_depth, &findings.scored);
    score.depth_rmse_m = errors.rmse_m;
    score.depth_median_abs_m = errors.median_abs_m;
  }
  findings.render = image::ToImage8(render);
  return findings;
}

}  // namespace skyquilt::evaluate
