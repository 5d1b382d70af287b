#include "core/image/area_mean.h"

#include <algorithm>

#include "core/base/errors.h"

namespace skyquilt::image {
namespace {

struct Part {
  int first = 0;
  std::vector<double> weights;  // of the pixels from `first` on, with sum 1
};

// What each of n pixels covers of a row or column of `size` pixels.
std::vector<Part> PartsOf(int size, int n) {
  std::vector<Part> parts(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) {
    // In units of 1 / n pixel all borders are whole numbers.
    const int64_t begin = static_cast<int64_t>(i) * size, end = begin + size;
    Part& part = parts[static_cast<size_t>(i)];
    part.first = static_cast<int>(begin / n);
    for (int64_t pixel = part.first; pixel * n < end; ++pixel) {
      const int64_t covered = std::min(end, (pixel + 1) * n) - std::max(begin, pixel * n);
      part.weights.push_back(static_cast<double>(covered) / size);
    }
  }
  return parts;
}

}  // namespace

ImageF AreaMean(const ImageF& image, int width, int height) {
  SKYQUILT_CHECK(width >= 1 && height >= 1 && width <= image.width && height <= image.height, "an area mean only makes images smaller");
  const std::vector<Part> columns = PartsOf(image.width, width), rows = PartsOf(image.height, height);
  ImageF reduced(width, height, image.channels);
  std::vector<double> sum(static_cast<size_t>(image.channels));
  for (int y = 0; y < height; ++y) {
    const Part& row = rows[static_cast<size_t>(y)];
    for (int x = 0; x < width; ++x) {
      const Part& column = columns[static_cast<size_t>(x)];
      std::fill(sum.begin(), sum.end(), 0.0);
      for (size_t v = 0; v < row.weights.size(); ++v) {
        for (size_t u = 0; u < column.weights.size(); ++u) {
          const float* pixel = image.At(column.first + static_cast<int>(u), row.first + static_cast<int>(v));
          const double weight = row.weights[v] * column.weights[u];
          for (size_t c = 0; c < sum.size(); ++c) sum[c] += weight * static_cast<double>(pixel[c]);
        }
      }
      std::transform(sum.begin(), sum.end(), reduced.At(x, y), [](double mean) { return static_cast<float>(mean); });
    }
  }
  return reduced;
}

}  // namespace skyquilt::image
