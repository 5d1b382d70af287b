#include "surface/refine/photo_picture.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::surface {
namespace {

// Grey of the photo at an image position, bilinear; 0 outside.
class GreyPhoto {
 public:
  GreyPhoto(const image::PixelCache& photos, size_t photo)
      : pixels_(photos.Copy(photo)), width_(photos.Width(photo)), height_(photos.Height(photo)) {}

  float At(double x, double y) const {
    if (!(x >= 0.0 && y >= 0.0 && x <= width_ && y <= height_)) return 0.0F;
    const double px = std::clamp(x - 0.5, 0.0, width_ - 1.0), py = std::clamp(y - 0.5, 0.0, height_ - 1.0);
    const int x0 = std::min(static_cast<int>(px), width_ - 2), y0 = std::min(static_cast<int>(py), height_ - 2);
    const auto fx = static_cast<float>(px - x0), fy = static_cast<float>(py - y0);
    const float upper = Pixel(x0, y0) * (1.0F - fx) + Pixel(x0 + 1, y0) * fx;
    const float lower = Pixel(x0, y0 + 1) * (1.0F - fx) + Pixel(x0 + 1, y0 + 1) * fx;
    return upper * (1.0F - fy) + lower * fy;
  }

 private:
  float Pixel(int x, int y) const {
    const size_t i = static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
    if (!pixels_.mask.empty() && pixels_.mask[i] == 0) return 0.0F;
    const uint8_t* p = pixels_.rgb.data() + 3 * i;
    return 0.299F * static_cast<float>(p[0]) + 0.587F * static_cast<float>(p[1]) + 0.114F * static_cast<float>(p[2]);
  }

  image::PixelCache::Photo pixels_;  // a copy: mapped pages of all photos together would take more memory than there is
  int width_, height_;
};

}  // namespace

kernel::MatchPicture PictureOf(const ViewPose& pose, const survey::Survey& survey, const image::PixelCache& photos, base::ThreadPool& threads) {
  const auto photo = static_cast<size_t>(pose.photo);
  const GreyPhoto grey(photos, photo);
  const camera::Camera camera = survey.cameras[static_cast<size_t>(survey.photos[photo].camera)].Resized(photos.Width(photo), photos.Height(photo));
  const int n = std::clamp(static_cast<int>(std::ceil(camera.FocalX() / pose.focal_px - 0.25)), 1, 8);
  std::vector<uint8_t> pixels(static_cast<size_t>(pose.width) * static_cast<size_t>(pose.height));
  threads.ParallelFor(pose.height, [&](int64_t row, int) {
    for (int x = 0; x < pose.width; ++x) {
      float sum = 0.0F;
      for (int k = 0; k < n * n; ++k) {
        const double u = x + (k % n + 0.5) / n, v = static_cast<double>(row) + (static_cast<double>(k / n) + 0.5) / n;
        const std::optional<Eigen::Vector2d> at = camera.ImgFromCam({(u - pose.cx) / pose.focal_px, (v - pose.cy) / pose.focal_px, 1.0});
        if (at) sum += grey.At(at->x(), at->y());
      }
      pixels[static_cast<size_t>(row) * static_cast<size_t>(pose.width) + static_cast<size_t>(x)] =
          static_cast<uint8_t>(std::lround(sum / static_cast<float>(n * n)));
    }
  });
  return {pixels, pose.width, pose.height};
}

}  // namespace skyquilt::surface
