#include "prepare/rigs/panorama_picture.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>

#include "core/base/cancel.h"
#include "core/image/srgb.h"

namespace skyquilt::prepare::rigs {
namespace {

constexpr int kMostSamples = 16;  // per axis: where a pixel of the view is as wide as the whole row, at a pole

const std::array<float, 256>& LinearTable() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> linear{};
    for (size_t i = 0; i < linear.size(); ++i) linear[i] = image::LinearFromSrgb(static_cast<float>(i) / 255.0F);
    return linear;
  }();
  return table;
}

uint8_t StoredOf(float linear) {
  constexpr size_t kSize = 1U << 15U;
  static const std::array<uint8_t, kSize + 1> table = [] {
    std::array<uint8_t, kSize + 1> stored{};
    for (size_t i = 0; i <= kSize; ++i) {
      stored[i] = static_cast<uint8_t>(std::lround(255.0F * image::SrgbFromLinear(static_cast<float>(i) / static_cast<float>(kSize))));
    }
    return stored;
  }();
  return table[static_cast<size_t>(std::lrint(std::clamp(linear, 0.0F, 1.0F) * static_cast<float>(kSize)))];
}

std::array<float, 4> CatmullRom(float t) {
  return {0.5F * t * (-1.0F + t * (2.0F - t)), 0.5F * (2.0F + t * t * (-5.0F + 3.0F * t)), 0.5F * t * (1.0F + t * (4.0F - 3.0F * t)),
          0.5F * t * t * (t - 1.0F)};
}

// Pixels of the picture, those beyond its edges by going on around the sphere.
class Sampler {
 public:
  Sampler(const image::Image8& picture, const SphereArea& area) : picture_(picture), area_(area), linear_(LinearTable()) {}

  // Adds the light at this place of the sphere. False when the picture does not show it.
  bool Add(const Eigen::Vector2d& at, float weight, std::array<float, 3>* sum) const {
    const double x = at.x() - area_.left, y = at.y() - area_.top;
    if (x < 0.0 || y < 0.0 || x > area_.width || y > area_.height) return false;
    const double column = std::floor(x - 0.5), row = std::floor(y - 0.5);
    const std::array<float, 4> by_x = CatmullRom(static_cast<float>(x - 0.5 - column)), by_y = CatmullRom(static_cast<float>(y - 0.5 - row));
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i) {
        const uint8_t* pixel = PixelAt(static_cast<int>(column) - 1 + i, static_cast<int>(row) - 1 + j);
        const float share = weight * by_x[static_cast<size_t>(i)] * by_y[static_cast<size_t>(j)];
        for (size_t c = 0; c < 3; ++c) (*sum)[c] += share * linear_[pixel[c]];
      }
    }
    return true;
  }

 private:
  const uint8_t* PixelAt(int x, int y) const {
    // Beyond a pole is the other side of the sphere.
    if (area_.IsWhole() && (y < 0 || y >= area_.height)) {
      y = y < 0 ? -1 - y : 2 * area_.height - 1 - y;
      x += area_.width / 2;
    }
    x = area_.GoesAround() ? ((x % area_.width) + area_.width) % area_.width : std::clamp(x, 0, area_.width - 1);
    return picture_.At(x, std::clamp(y, 0, area_.height - 1));
  }

  const image::Image8& picture_;
  const SphereArea& area_;
  const std::array<float, 256>& linear_;
};

// How many samples along x and y of a view's pixel are as near to each other as the panorama's pixels.
Eigen::Vector2i SamplesOf(const SphereArea& area, const camera::Camera& camera, const Eigen::Matrix3d& pano_from_cam, const Eigen::Vector2d& pixel) {
  const auto place = [&](double x, double y) { return area.sphere.ImgFromRay(pano_from_cam * camera.RayFromImg(pixel + Eigen::Vector2d(x, y))); };
  const auto samples = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    const double dx = std::remainder(b.x() - a.x(), static_cast<double>(area.sphere.width)), dy = b.y() - a.y();
    constexpr double kAsGood = 0.2;  // a fifth of a pixel more is no reason for another
    return std::clamp(static_cast<int>(std::ceil(std::hypot(dx, dy) - kAsGood)), 1, kMostSamples);
  };
  return {samples(place(-0.5, 0.0), place(0.5, 0.0)), samples(place(0.0, -0.5), place(0.0, 0.5))};
}

bool Shows(const SphereArea& area, const Eigen::Vector2d& at) {
  return at.x() >= area.left && at.y() >= area.top && at.x() <= area.left + area.width && at.y() <= area.top + area.height;
}

}  // namespace

SphereArea AreaOf(const input::PhotoFile& panorama) {
  SphereArea area{.sphere = {panorama.width, panorama.width / 2}, .width = panorama.width, .height = panorama.height};
  area.top = std::max(0, (area.sphere.height - panorama.height) / 2);
  if (panorama.height > area.sphere.height) area.sphere.height = panorama.height;
  const std::optional<survey::PanoramaTags>& tags = panorama.tags.panorama;
  if (!tags || tags->full_width <= 0 || tags->full_height <= 0) return area;
  const double scale = tags->area_width > 0 ? static_cast<double>(panorama.width) / tags->area_width
                                            : std::min(1.0, static_cast<double>(panorama.width) / tags->full_width);
  const auto pixels = [scale](int value) { return static_cast<int>(std::lround(scale * value)); };
  const SphereArea tagged{.sphere = {pixels(tags->full_width), pixels(tags->full_height)},
                          .left = pixels(tags->left),
                          .top = pixels(tags->top),
                          .width = panorama.width,
                          .height = panorama.height};
  // Tags of another picture say nothing of this one.
  const bool fits = tagged.left + tagged.width <= tagged.sphere.width + 1 && tagged.top + tagged.height <= tagged.sphere.height + 1;
  return fits ? tagged : area;
}

Eigen::Vector3d PanoramaRay(const camera::Camera& camera, const Eigen::Quaterniond& cam_from_pano, const Eigen::Vector2d& pixel) {
  return cam_from_pano.conjugate() * camera.RayFromImg(pixel);
}

image::Image8 RenderView(const image::Image8& panorama, const SphereArea& area, const camera::Camera& camera, const Eigen::Quaterniond& cam_from_pano,
                         base::ThreadPool& threads) {
  const Eigen::Matrix3d pano_from_cam = cam_from_pano.conjugate().toRotationMatrix();
  const Sampler sampler(panorama, area);
  image::Image8 view(camera.width, camera.height, 3);
  threads.ParallelFor(camera.height, [&](int64_t row, int /*thread*/) {
    base::ThrowIfCancelled();
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d middle(x + 0.5, static_cast<double>(row) + 0.5);
      const Eigen::Vector2i n = SamplesOf(area, camera, pano_from_cam, middle);
      const float weight = 1.0F / static_cast<float>(n.prod());
      std::array<float, 3> sum{};
      bool shown = true;
      for (int j = 0; j < n.y(); ++j) {
        for (int i = 0; i < n.x(); ++i) {
          const Eigen::Vector2d at(x + (i + 0.5) / n.x(), static_cast<double>(row) + (j + 0.5) / n.y());
          shown = sampler.Add(area.sphere.ImgFromRay(pano_from_cam * camera.RayFromImg(at)), weight, &sum) && shown;
        }
      }
      if (!shown) continue;
      uint8_t* pixel = view.At(x, static_cast<int>(row));
      for (size_t c = 0; c < 3; ++c) pixel[c] = StoredOf(sum[c]);
    }
  });
  return view;
}

image::Image8 MaskOfView(const image::Image8& panorama_mask, const SphereArea& area, const camera::Camera& camera,
                         const Eigen::Quaterniond& cam_from_pano, double nadir_deg, base::ThreadPool& threads) {
  const Eigen::Matrix3d pano_from_cam = cam_from_pano.conjugate().toRotationMatrix();
  const double least_down = std::cos(nadir_deg * std::numbers::pi / 180.0);
  image::Image8 mask(camera.width, camera.height, 1, 255);
  std::atomic<bool> any = false;
  threads.ParallelFor(camera.height, [&](int64_t row, int /*thread*/) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = pano_from_cam * camera.RayFromImg({x + 0.5, static_cast<double>(row) + 0.5});
      const Eigen::Vector2d at = area.sphere.ImgFromRay(ray);
      bool used = !(nadir_deg > 0.0 && ray.y() >= least_down) && Shows(area, at);
      if (used && !panorama_mask.Empty()) {
        const int column = std::clamp(static_cast<int>(at.x()) - area.left, 0, area.width - 1);
        used = *panorama_mask.At(column, std::clamp(static_cast<int>(at.y()) - area.top, 0, area.height - 1)) != 0;
      }
      if (used) continue;
      *mask.At(x, static_cast<int>(row)) = 0;
      any = true;
    }
  });
  return any ? mask : image::Image8();
}

}  // namespace skyquilt::prepare::rigs
