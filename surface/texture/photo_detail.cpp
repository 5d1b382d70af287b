#include "surface/texture/photo_detail.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/cancel.h"

namespace skyquilt::surface {
namespace {

constexpr double kLeastDetailCosine = 0.5;  // 60 degrees
constexpr double kBlurTexels = 4.0;
constexpr float kMostDetail = 0.25F;
constexpr int kMostSharpSamples = 3;  // per axis, of the mean over a texel
constexpr int kMostBlurSamples = 8;
constexpr int64_t kDetailTexelsPerTask = 1024;

// A photo as it is in the cache.
class DetailPhoto {
 public:
  DetailPhoto(const survey::Survey& survey, const image::PixelCache& photos, size_t photo)
      : photos_(photos),
        photo_(photo),
        width_(photos.Width(photo)),
        height_(photos.Height(photo)),
        cam_from_enu_(survey.photos[photo].cam_from_enu),
        camera_(survey.cameras[static_cast<size_t>(survey.photos[photo].camera)].Resized(width_, height_)) {}

  // Nothing when the photo does not show the point or hides it with its mask.
  std::optional<Eigen::Vector3f> DetailAt(const Eigen::Vector3d& x_in_enu, double texel_m) const {
    const Eigen::Vector3d x = cam_from_enu_ * x_in_enu;
    const std::optional<Eigen::Vector2d> pixel = camera_.ImgFromCam(x);
    if (!pixel) return std::nullopt;
    const double texel_px = texel_m * camera_.FocalX() / x.norm();
    const std::optional<Eigen::Vector3f> sharp = Mean(*pixel, texel_px, kMostSharpSamples);
    if (!sharp) return std::nullopt;
    const std::optional<Eigen::Vector3f> blurred = Mean(*pixel, kBlurTexels * texel_px, kMostBlurSamples);
    if (!blurred) return std::nullopt;
    return Eigen::Vector3f((*sharp - *blurred).cwiseMax(-kMostDetail).cwiseMin(kMostDetail));
  }

 private:
  // Mean over a square, sampled at up to most x most places.
  std::optional<Eigen::Vector3f> Mean(const Eigen::Vector2d& middle, double width_px, int most) const {
    const int n = static_cast<int>(std::clamp(std::ceil(width_px), 1.0, static_cast<double>(most)));
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const Eigen::Vector2d offset((i + 0.5) / n - 0.5, (j + 0.5) / n - 0.5);
        const std::optional<Eigen::Vector3f> value = Interpolated(middle + width_px * offset);
        if (!value) return std::nullopt;
        sum += *value;
      }
    }
    return Eigen::Vector3f(sum / static_cast<float>(n * n));
  }

  // Bilinear; nothing outside the photo or where a mask hides one of the pixels.
  std::optional<Eigen::Vector3f> Interpolated(const Eigen::Vector2d& position) const {
    const Eigen::Vector2d p = position.array() - 0.5;
    if (!(p.x() >= 0.0 && p.y() >= 0.0 && p.x() <= width_ - 1 && p.y() <= height_ - 1)) return std::nullopt;
    const int x0 = static_cast<int>(p.x());
    const int y0 = static_cast<int>(p.y());
    const auto fx = static_cast<float>(p.x() - x0);
    const auto fy = static_cast<float>(p.y() - y0);
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (int corner = 0; corner < 4; ++corner) {
      const int dx = corner & 1;
      const int dy = corner >> 1;
      const float weight = (dx == 1 ? fx : 1.0F - fx) * (dy == 1 ? fy : 1.0F - fy);
      if (!(weight > 0.0F)) continue;
      uint8_t rgb[3];
      const size_t index = static_cast<size_t>(y0 + dy) * static_cast<size_t>(width_) + static_cast<size_t>(x0 + dx);
      if (!photos_.Pixel(photo_, index, rgb)) return std::nullopt;
      sum += weight / 255.0F * Eigen::Vector3f(static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2]));
    }
    return sum;
  }

  const image::PixelCache& photos_;
  size_t photo_;
  int width_, height_;
  geo::Rigid3d cam_from_enu_;
  camera::Camera camera_;
};

bool MayRead(const survey::Survey& survey, const image::PixelCache& photos, int photo) {
  if (photo < 0) return false;
  const auto p = static_cast<size_t>(photo);
  return p < survey.photos.size() && p < photos.size() && !survey.photos[p].is_test && photos.Width(p) > 0 && photos.Height(p) > 0;
}

}  // namespace

void AddPhotoDetail(const TileGeometry& geometry, const AtlasTexels& texels, std::span<const int32_t> view, std::span<const DepthView> views,
                    const survey::Survey& survey, const image::PixelCache& photos, double share, double texel_m, double tolerance_m,
                    base::ThreadPool& threads, TexelColors* colors) {
  if (!(share > 0.0)) return;
  std::vector<uint8_t> used(views.size(), 0);
  for (const int32_t v : view) {
    if (v >= 0) used[static_cast<size_t>(v)] = 1;
  }
  std::vector<std::optional<DetailPhoto>> source(views.size());
  for (size_t v = 0; v < views.size(); ++v) {
    const int photo = views[v].pose.photo;
    if (used[v] != 0 && MayRead(survey, photos, photo)) source[v].emplace(survey, photos, static_cast<size_t>(photo));
  }
  const auto add = [&](size_t i) {
    if (view[i] < 0 || colors->known[i] == 0) return;
    const auto v = static_cast<size_t>(view[i]);
    if (!source[v]) return;
    const Eigen::Vector3d x = texels.PositionOf(geometry, i);
    const Eigen::Vector3d to_view = views[v].pose.Centre() - x;
    if (!(to_view.dot(texels.NormalOf(geometry, i)) > kLeastDetailCosine * to_view.norm()) || !Sees(views[v], x, tolerance_m)) return;
    const std::optional<Eigen::Vector3f> detail = source[v]->DetailAt(x, texel_m);
    if (!detail) return;
    for (int channel = 0; channel < 3; ++channel) {
      float& value = colors->rgb_srgb[i][static_cast<size_t>(channel)];
      value = std::clamp(value + static_cast<float>(share) * (*detail)[channel], 0.0F, 1.0F);
    }
  };
  const auto n = static_cast<int64_t>(texels.texel.size());
  threads.ParallelFor((n + kDetailTexelsPerTask - 1) / kDetailTexelsPerTask, [&](int64_t task, int) {
    base::ThrowIfCancelled();
    for (int64_t i = task * kDetailTexelsPerTask; i < std::min(n, (task + 1) * kDetailTexelsPerTask); ++i) add(static_cast<size_t>(i));
  });
}

}  // namespace skyquilt::surface
