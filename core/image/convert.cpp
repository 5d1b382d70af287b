#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/base/errors.h"
#include "core/image/image.h"

namespace skyquilt::image {
namespace {

struct SourceRange {
  int begin = 0;
  int end = 0;
};

// The source pixels that the reduced pixel `at` overlaps, in exact integer arithmetic.
SourceRange Under(int at, int source_size, int reduced_size) {
  const int64_t begin = static_cast<int64_t>(at) * source_size / reduced_size;
  const int64_t end = (static_cast<int64_t>(at + 1) * source_size + reduced_size - 1) / reduced_size;
  return {static_cast<int>(begin), static_cast<int>(end)};
}

}  // namespace

Image8 Resize(const Image8& image, int width, int height) {
  SKYQUILT_CHECK(width > 0 && height > 0, "a resized image needs a size");
  SKYQUILT_CHECK(!image.Empty(), "an empty image cannot be resized");
  if (width == image.width && height == image.height) return image;
  Image8 result(width, height, image.channels);
  const cv::Mat source(image.height, image.width, CV_MAKETYPE(CV_8U, image.channels), const_cast<uint8_t*>(image.data.data()));
  cv::Mat target(height, width, CV_MAKETYPE(CV_8U, image.channels), result.data.data());
  const bool shrinks = width <= image.width && height <= image.height;
  cv::resize(source, target, target.size(), 0.0, 0.0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
  return result;
}

Image8 ResizeMask(const Image8& mask, int width, int height) {
  SKYQUILT_CHECK(width > 0 && height > 0, "a resized mask needs a size");
  SKYQUILT_CHECK(mask.channels == 1 && !mask.Empty(), "a mask has one channel and at least one pixel");
  Image8 rows(width, mask.height, 1);
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < width; ++x) {
      const SourceRange range = Under(x, mask.width, width);
      const bool use = std::all_of(mask.At(range.begin, y), mask.At(range.begin, y) + (range.end - range.begin), [](uint8_t v) { return v != 0; });
      *rows.At(x, y) = use ? 255 : 0;
    }
  }
  Image8 result(width, height, 1, 255);
  for (int y = 0; y < height; ++y) {
    const SourceRange range = Under(y, mask.height, height);
    for (int source_y = range.begin; source_y < range.end; ++source_y) {
      for (int x = 0; x < width; ++x) *result.At(x, y) = std::min(*result.At(x, y), *rows.At(x, source_y));
    }
  }
  return result;
}

int ScaledHeight(int width, int height, int new_width) {
  SKYQUILT_CHECK(width > 0 && height > 0 && new_width > 0, "sizes must be positive");
  return std::max(1, static_cast<int>(std::lround(static_cast<double>(height) * new_width / width)));
}

Image8 ToImage8(const ImageF& image) {
  Image8 result(image.width, image.height, image.channels);
  std::transform(image.data.begin(), image.data.end(), result.data.begin(), [](float value) -> uint8_t {
    if (!(value > 0.0F)) return 0;  // also NaN
    return static_cast<uint8_t>(std::min(value, 1.0F) * 255.0F + 0.5F);
  });
  return result;
}

ImageF ToImageF(const Image8& image) {
  ImageF result(image.width, image.height, image.channels);
  std::transform(image.data.begin(), image.data.end(), result.data.begin(), [](uint8_t value) { return static_cast<float>(value) / 255.0F; });
  return result;
}

Image8 Colorize(const ImageF& image, float low, float high) {
  SKYQUILT_CHECK(image.channels == 1, "only one channel can be colorized");
  cv::Mat ramp(1, 256, CV_8UC1);
  for (int i = 0; i < 256; ++i) ramp.at<uint8_t>(0, i) = static_cast<uint8_t>(i);
  cv::Mat bgr;
  cv::applyColorMap(ramp, bgr, cv::COLORMAP_VIRIDIS);
  Image8 result(image.width, image.height, 3);
  const float range = high - low;
  for (size_t i = 0; i < image.data.size(); ++i) {
    const float value = image.data[i];
    if (!std::isfinite(value)) continue;
    const float share = range > 0.0F ? std::clamp((value - low) / range, 0.0F, 1.0F) : 0.5F;
    const auto& colour = bgr.at<cv::Vec3b>(0, static_cast<int>(share * 255.0F + 0.5F));
    for (int c = 0; c < 3; ++c) result.data[3 * i + static_cast<size_t>(c)] = colour[2 - c];
  }
  return result;
}

}  // namespace skyquilt::image
