#include "evaluate/photos/photo_scorer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/base/errors.h"
#include "core/metrics/depth_errors.h"
#include "core/metrics/flip.h"
#include "core/metrics/psnr.h"
#include "core/metrics/ssim.h"
#include "core/scene/depth_normals.h"
#include "evaluate/photos/apply_response.h"
#include "evaluate/photos/skyline.h"
#include "evaluate/photos/tile_fit.h"

namespace skyquilt::evaluate::photos {

namespace {

// Sums over the pixels of a photo.
struct PixelSums {
  skyquilt::metrics::SquaredError full, covered;
  SeamErrors seams;
  std::vector<skyquilt::metrics::SquaredError> per_block;
  int64_t used = 0;

  PixelSums& operator+=(const PixelSums& other) {
    full += other.full;
    covered += other.covered;
    seams += other.seams;
    for (size_t b = 0; b < per_block.size(); ++b) per_block[b] += other.per_block[b];
    used += other.used;
    return *this;
  }
};

// Compares photo and rendering pixel by pixel.
class FrameComparison {
 public:
  FrameComparison(const HeldOutPhoto& task, std::span<const render::RayColor> rendered, const TrainingViews& views, const SceneArea& area)
      : photo(image::ToImageF(task.photo)),
        render(task.camera.width, task.camera.height, 3),
        unclamped(task.camera.width, task.camera.height, 3),
        scored(task.camera.width, task.camera.height, 1, 0),
        z_depth(task.camera.width, task.camera.height, 1, std::numeric_limits<float>::quiet_NaN()),
        task_(task),
        rendered_(rendered),
        views_(views),
        area_(area),
        enu_from_cam_(task.cam_from_enu.Inverse()),
        origin_(task.cam_from_enu.OriginInSource()),
        order_(views.ByDistance(origin_)) {
    if (!area.points.empty()) skyline_.emplace(area.points, origin_);
  }

  // Fills the images below and returns the sums over all pixels, the same for any number of threads.
  PixelSums Compare(base::ThreadPool& threads) {
    PixelSums none;
    none.per_block.resize(area_.boxes.size());
    std::vector<PixelSums> rows(static_cast<size_t>(task_.camera.height), none);
    threads.ParallelFor(task_.camera.height, [&](int64_t row, int) {
      for (int x = 0; x < task_.camera.width; ++x) ComparePixel(x, static_cast<int>(row), &rows[static_cast<size_t>(row)]);
    });
    for (const PixelSums& row : rows) none += row;
    return none;
  }

  const image::ImageF photo;
  image::ImageF render;     // display values clamped to [0, 1]
  image::ImageF unclamped;  // may be brighter than white
  image::Image8 scored;     // as in PhotoResult
  image::ImageF z_depth;    // as in PhotoResult

 private:
  void ComparePixel(int x, int y, PixelSums* sums) {
    const size_t i = static_cast<size_t>(y) * static_cast<size_t>(task_.camera.width) + static_cast<size_t>(x);
    const render::RayColor& ray = rendered_[i];
    float* rgb = render.At(x, y);
    for (int c = 0; c < 3; ++c) {
      const float value = std::isfinite(ray.rgb_srgb[c]) ? std::max(ray.rgb_srgb[c], 0.0F) : 0.0F;
      unclamped.At(x, y)[c] = value;
      rgb[c] = std::min(value, 1.0F);
    }
    const Eigen::Vector3d direction_in_cam = task_.camera.RayFromImg({x + 0.5, y + 0.5});
    const double median_m = static_cast<double>(ray.depth_median);
    *z_depth.At(x, y) = static_cast<float>(median_m * direction_in_cam.z());
    if (!task_.mask.empty() && task_.mask[i] == 0) return;
    ++sums->used;
    AddPixel(rgb, photo.At(x, y), &sums->full);
    const Eigen::Vector3d direction = enu_from_cam_.rotation * direction_in_cam;
    if (ShowsSky(direction, median_m)) return;
    const auto surface = SurfacePoint(origin_, direction, median_m, area_.heights);
    if (!surface) return;
    const int block = BlockAt(*surface, area_.boxes);
    if (block < 0 || views_.Count(*surface, order_, 2) < 2) return;
    scored.data[i] = 1;
    AddCovered(x, y, block, ZoneAt(*surface, block, area_.boxes), sums);
  }

  // False for a ray that meets something within the heights, even where that is wrong.
  bool ShowsSky(const Eigen::Vector3d& direction, double depth_m) const {
    if (!skyline_ || origin_.z() + depth_m * direction.z() <= area_.heights.high_m) return false;  // NaN: met nothing
    return skyline_->IsAbove(direction);
  }

  void AddCovered(int x, int y, int block, Zone zone, PixelSums* sums) const {
    const float *rgb = render.At(x, y), *wanted = photo.At(x, y);
    AddPixel(rgb, wanted, &sums->covered);
    AddPixel(rgb, wanted, &sums->per_block[static_cast<size_t>(block)]);
    if (zone != Zone::kInterior && zone != Zone::kSeam) return;
    auto& group = zone == Zone::kSeam ? sums->seams.seam : sums->seams.interior;
    AddPixel(rgb, wanted, &group[static_cast<size_t>(TextureClass(photo, x, y))]);
  }

  const HeldOutPhoto& task_;
  const std::span<const render::RayColor> rendered_;
  const TrainingViews& views_;
  const SceneArea& area_;
  const geo::Rigid3d enu_from_cam_;
  const Eigen::Vector3d origin_;
  const std::vector<int> order_;
  std::optional<Skyline> skyline_;  // where photos look level
};

// Nearest pixel, because averaging would give wrong depths between roof and ground.
template <typename T>
image::BasicImage<T> ResizeNearest(const image::BasicImage<T>& image, int width, int height) {
  const auto scaled = [](int i, int n, int m) { return std::min(static_cast<int>((i + 0.5) * m / n), m - 1); };
  image::BasicImage<T> resized(width, height, image.channels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      std::copy_n(image.At(scaled(x, width, image.width), scaled(y, height, image.height)), image.channels, resized.At(x, y));
    }
  }
  return resized;
}

// Of photo and rendering averaged to the common width, over pixels that are covered all through. NaN for images that are narrower.
double PsnrAtCommonWidth(const image::Image8& photo, const image::ImageF& render, const image::Image8& covered) {
  if (photo.width < kCommonWidth) return kNotMeasured;
  const int height = image::ScaledHeight(photo.width, photo.height, kCommonWidth);
  image::Image8 mask = covered;
  for (uint8_t& value : mask.data) value = value != 0 ? 255 : 0;
  mask = image::ResizeMask(mask, kCommonWidth, height);
  const image::ImageF wanted = image::ToImageF(image::Resize(photo, kCommonWidth, height));
  const image::ImageF made = image::ToImageF(image::Resize(image::ToImage8(render), kCommonWidth, height));
  skyquilt::metrics::SquaredError error;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < kCommonWidth; ++x) {
      if (*mask.At(x, y) != 0) AddPixel(made.At(x, y), wanted.At(x, y), &error);
    }
  }
  return skyquilt::metrics::PsnrOf(error);
}

// Scores that are not sums over pixels. FLIP spreads its rows over the threads, the others are computed side by side.
void AddWholeFrameScores(const HeldOutPhoto& task, const FrameComparison& frame, const FittedShading& shading, base::ThreadPool& threads,
                         PhotoScore* score) {
  const image::Image8 used = task.UsedPixels();
  const image::Image8* unmasked = used.Empty() ? nullptr : &used;
  HalfScores halves;
  TileScores tiles;
  threads.ParallelFor(4, [&](int64_t which, int) {
    if (which == 0) score->ssim = skyquilt::metrics::Ssim(frame.render, frame.photo, &frame.scored);
    if (which == 1) score->ssim_full = skyquilt::metrics::Ssim(frame.render, frame.photo, unmasked);
    if (which == 2) halves = ScoreHalves(frame.unclamped, frame.photo, frame.scored);
    if (which == 3) tiles = ScoreAlternateTiles(frame.unclamped, frame.photo, frame.scored, shading.grid, static_cast<double>(shading.sigma));
  });
  score->flip = skyquilt::metrics::Flip(frame.render, frame.photo, &frame.scored, threads);
  score->flip_full = skyquilt::metrics::Flip(frame.render, frame.photo, unmasked, threads);
  score->right_half_db = skyquilt::metrics::PsnrOf(halves.right);
  score->right_half_fitted_db = skyquilt::metrics::PsnrOf(halves.right_fitted);
  score->tiles_db = skyquilt::metrics::PsnrOf(tiles.rendered);
  score->tiles_gains_db = skyquilt::metrics::PsnrOf(tiles.gains);
  score->tiles_shading_db = skyquilt::metrics::PsnrOf(tiles.shaded);
  for (size_t c = 0; c < 3; ++c) score->fitted_stops[c] = static_cast<double>(halves.log_gain[c]) / std::numbers::ln2;
}

}  // namespace

image::Image8 HeldOutPhoto::UsedPixels() const {
  image::Image8 used;
  if (mask.empty()) return used;
  used = image::Image8(photo.width, photo.height, 1);
  used.data = mask;
  return used;
}

PhotoResult ScorePhoto(const HeldOutPhoto& task, std::span<const render::RayColor> rendered, const TrainingViews& views, const SceneArea& area,
                       base::ThreadPool& threads) {
  const int width = task.camera.width;
  const int height = task.camera.height;
  const size_t n_pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  SKYQUILT_CHECK(task.photo.width == width && task.photo.height == height && task.photo.channels == 3,
                 "the photo must have the size of the camera's image");
  SKYQUILT_CHECK(rendered.size() == n_pixels, "there must be one rendered ray per pixel");
  SKYQUILT_CHECK(task.mask.empty() || task.mask.size() == n_pixels, "the mask must have the size of the camera's image");

  FrameComparison frame(task, rendered, views, area);
  PixelSums sums = frame.Compare(threads);
  PhotoResult findings;
  findings.seams = sums.seams;
  findings.per_block = std::move(sums.per_block);
  PhotoScore& score = findings.score;
  score.width = width;
  score.height = height;
  score.used_pixels = sums.used;
  score.covered_pixels = PixelsOf(sums.covered);
  score.psnr_db = skyquilt::metrics::PsnrOf(sums.covered);
  score.psnr_full_db = skyquilt::metrics::PsnrOf(sums.full);
  score.psnr_1000_db = PsnrAtCommonWidth(task.photo, frame.render, frame.scored);
  AddWholeFrameScores(task, frame, area.shading, threads, &score);
  findings.scored = std::move(frame.scored);
  findings.z_depth = std::move(frame.z_depth);
  findings.render = image::ToImage8(frame.render);
  if (!task.true_depth.Empty()) {
    findings.true_depth = ResizeNearest(task.true_depth, width, height);
    const skyquilt::metrics::DepthErrors errors = skyquilt::metrics::CompareDepth(findings.z_depth, findings.true_depth, &findings.scored);
    score.depth_rmse_m = errors.rmse_m;
    score.depth_median_abs_m = errors.median_abs_m;
  }
  if (!task.true_class.Empty()) findings.true_class = ResizeNearest(task.true_class, width, height);
  if (!task.true_normals.Empty()) {
    findings.true_normals = ResizeNearest(task.true_normals, width, height);
    findings.normals = scene::NormalsOfDepth(task.camera, task.cam_from_enu, findings.z_depth, {}, threads);
  }
  return findings;
}

}  // namespace skyquilt::evaluate::photos
