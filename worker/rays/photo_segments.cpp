#include "worker/rays/photo_segments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/ximgproc/segmentation.hpp>

namespace skyquilt::worker {
namespace {

// Felzenszwalb: blur in pixels, threshold, smallest segment in pixels.
constexpr double kBlur = 0.5;
constexpr float kThreshold = 200.0F;
constexpr int kSmallest = 40;
// A segment is left out when its mean excess green 2 g - r - b (shares of the sum of colours) is above the first, or its mean absolute step between
// neighbouring pixels (display values, 0..1) above the second. Pixels of other segments with a step above the third are left out.
constexpr double kMostGreen = 0.1, kMostTexture = 0.05, kLargestStep = 0.1;

struct SegmentSums {
  double green = 0.0, texture = 0.0;
  int64_t pixels = 0;
  bool Plain() const {
    const auto n = static_cast<double>(pixels);
    return pixels >= kSmallest && green < kMostGreen * n && texture < kMostTexture * n;
  }
};

double Grey(const uint8_t* rgb) {
  return (0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2]) / 255.0;
}

}  // namespace

image::BasicImage<uint16_t> SegmentPhoto(const image::Image8& rgb) {
  image::BasicImage<uint16_t> labels(rgb.width, rgb.height, 1, 0);
  cv::Mat found;
  cv::ximgproc::segmentation::createGraphSegmentation(kBlur, kThreshold, kSmallest)
      ->processImage(cv::Mat(rgb.height, rgb.width, CV_8UC3, const_cast<uint8_t*>(rgb.data.data())), found);
  double highest = 0.0;
  cv::minMaxLoc(found, nullptr, &highest);
  std::vector<SegmentSums> sums(static_cast<size_t>(highest) + 1);
  for (int y = 0; y < rgb.height; ++y) {
    for (int x = 0; x < rgb.width; ++x) {
      SegmentSums& sum = sums[static_cast<size_t>(found.at<int>(y, x))];
      const uint8_t* p = rgb.At(x, y);
      const double total = std::max(1.0, static_cast<double>(p[0]) + p[1] + p[2]);
      sum.green += (2.0 * p[1] - p[0] - p[2]) / total;
      const double grey = Grey(p);
      const double right = x + 1 < rgb.width ? std::abs(Grey(rgb.At(x + 1, y)) - grey) : 0.0;
      const double below = y + 1 < rgb.height ? std::abs(Grey(rgb.At(x, y + 1)) - grey) : 0.0;
      sum.texture += 0.5 * (right + below);
      ++sum.pixels;
    }
  }
  std::vector<uint16_t> name(sums.size(), 0);
  uint16_t next = 0;
  for (size_t i = 0; i < sums.size() && next < std::numeric_limits<uint16_t>::max(); ++i) {
    if (sums[i].Plain()) name[i] = ++next;
  }
  for (int y = 1; y + 1 < rgb.height; ++y) {
    for (int x = 1; x + 1 < rgb.width; ++x) {
      const int own = found.at<int>(y, x);
      const bool inside =
          found.at<int>(y, x - 1) == own && found.at<int>(y, x + 1) == own && found.at<int>(y - 1, x) == own && found.at<int>(y + 1, x) == own;
      const double grey = Grey(rgb.At(x, y));
      const auto even = [&](int u, int v) { return std::abs(Grey(rgb.At(u, v)) - grey) < kLargestStep; };
      if (inside && even(x - 1, y) && even(x + 1, y) && even(x, y - 1) && even(x, y + 1)) *labels.At(x, y) = name[static_cast<size_t>(own)];
    }
  }
  return labels;
}

PhotoSegments::PhotoSegments(const image::PixelCache& pixels, const std::vector<int>& photos, base::ThreadPool& threads) : labels_(pixels.size()) {
  threads.ParallelFor(static_cast<int64_t>(photos.size()), [&](int64_t task, int) {
    const auto photo = static_cast<size_t>(photos[static_cast<size_t>(task)]);
    image::Image8 rgb(pixels.Width(photo), pixels.Height(photo), 3);
    rgb.data = pixels.Copy(photo).rgb;
    const int width = std::min(kSegmentWidth, rgb.width);
    if (width < rgb.width) rgb = image::Resize(rgb, width, image::ScaledHeight(rgb.width, rgb.height, width));
    Labels& labels = labels_[photo];
    labels.image = SegmentPhoto(rgb);
    labels.per_pixel_x = static_cast<double>(rgb.width) / pixels.Width(photo);
    labels.per_pixel_y = static_cast<double>(rgb.height) / pixels.Height(photo);
  });
}

uint16_t PhotoSegments::At(int photo, int x, int y) const {
  const Labels& labels = labels_[static_cast<size_t>(photo)];
  if (labels.image.Empty()) return 0;
  const int column = std::min(static_cast<int>((x + 0.5) * labels.per_pixel_x), labels.image.width - 1);
  const int row = std::min(static_cast<int>((y + 0.5) * labels.per_pixel_y), labels.image.height - 1);
  return *labels.image.At(column, row);
}

}  // namespace skyquilt::worker
