#include "evaluate/ortho/slanted_edge.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "core/base/errors.h"
#include "evaluate/measured.h"

namespace skyquilt::evaluate::ortho {
namespace {

constexpr int kSmallestPatch = 16;       // pixels
constexpr double kLeastContrast = 0.02;  // linear light, between the two sides
constexpr int kBinsPerPixel = 4;
constexpr double kMostEmptyBins = 0.2;  // of all: an edge along rows or columns fills only every fourth

image::ImageF Transposed(const image::ImageF& image) {
  image::ImageF turned(image.height, image.width, 1);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) *turned.At(y, x) = *image.At(x, y);
  }
  return turned;
}

// Change of brightness along rows and along columns, summed over the picture: the larger one crosses the edge.
bool EdgeIsUpright(const image::ImageF& image) {
  double along_rows = 0.0, along_columns = 0.0;
  for (int y = 0; y + 1 < image.height; ++y) {
    for (int x = 0; x + 1 < image.width; ++x) {
      const double here = static_cast<double>(*image.At(x, y));
      along_rows += std::abs(static_cast<double>(*image.At(x + 1, y)) - here);
      along_columns += std::abs(static_cast<double>(*image.At(x, y + 1)) - here);
    }
  }
  return along_rows >= along_columns;
}

// 1 in the middle, 0.08 at `half` from it and beyond.
double Hamming(double distance, double half) {
  return std::abs(distance) >= half ? 0.08 : 0.54 + 0.46 * std::cos(std::numbers::pi * distance / half);
}

// Where the edge crosses row y: at x = at_top + slope * y, in pixels from the first one's centre.
struct EdgeLine {
  double at_top = 0.0, slope = 0.0;
  double At(double y) const { return at_top + slope * y; }
};

// Through the centroids of the rows' derivatives, which count by their distance from the line known so far. Nothing when too few rows show an edge.
std::optional<EdgeLine> FitEdge(const image::ImageF& image, double sign, const EdgeLine& before) {
  double n = 0.0, sum_y = 0.0, sum_x = 0.0, sum_yy = 0.0, sum_xy = 0.0;
  for (int y = 0; y < image.height; ++y) {
    double weight = 0.0, moment = 0.0;
    for (int x = 1; x + 1 < image.width; ++x) {
      const double slope = 0.5 * sign * (static_cast<double>(*image.At(x + 1, y)) - static_cast<double>(*image.At(x - 1, y)));
      const double windowed = slope * Hamming(x - before.At(y), 0.5 * image.width);
      weight += windowed;
      moment += windowed * x;
    }
    if (weight < 0.5 * kLeastContrast) continue;
    const double centre = moment / weight;
    if (!(centre > 1.0 && centre < image.width - 2.0)) continue;
    n += 1.0;
    sum_y += y;
    sum_x += centre;
    sum_yy += 1.0 * y * y;
    sum_xy += centre * y;
  }
  const double spread = n * sum_yy - sum_y * sum_y;
  if (n < 0.8 * image.height || !(spread > 0.0)) return std::nullopt;
  EdgeLine line;
  line.slope = (n * sum_xy - sum_x * sum_y) / spread;
  line.at_top = (sum_x - line.slope * sum_y) / n;
  return line;
}

// Bright side minus dark side, with its sign: mean of the right third minus mean of the left one.
double ContrastAcross(const image::ImageF& image) {
  double left = 0.0, right = 0.0;
  const int third = image.width / 3;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < third; ++x) {
      left += static_cast<double>(*image.At(x, y));
      right += static_cast<double>(*image.At(image.width - 1 - x, y));
    }
  }
  return (right - left) / (1.0 * third * image.height);
}

// Brightness by distance from the edge in quarters of a pixel, the edge in the middle; empty when the distances leave gaps.
std::vector<double> EdgeSpread(const image::ImageF& image, const EdgeLine& edge) {
  const double across = 1.0 / std::sqrt(1.0 + edge.slope * edge.slope);
  // The distance that every row reaches on both sides.
  const double first = edge.At(0.0), last = edge.At(image.height - 1.0);
  const double reach = across * std::min(std::min(first, last), image.width - 1.0 - std::max(first, last));
  const int half_bins = static_cast<int>(std::floor(reach * kBinsPerPixel));
  if (half_bins < 4 * kBinsPerPixel) return {};
  std::vector<double> sum(static_cast<size_t>(2 * half_bins + 1), 0.0), count = sum;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const long bin = std::lround((x - edge.At(y)) * across * kBinsPerPixel) + half_bins;
      if (bin < 0 || bin > 2L * half_bins) continue;
      sum[static_cast<size_t>(bin)] += static_cast<double>(*image.At(x, y));
      count[static_cast<size_t>(bin)] += 1.0;
    }
  }
  size_t empty = 0, known = 0;  // known: the last bin with values
  for (size_t i = 0; i < sum.size(); ++i) {
    if (count[i] == 0.0) {
      ++empty;
      continue;
    }
    sum[i] /= count[i];
    for (size_t gap = known + 1; gap < i; ++gap) {
      const double share = static_cast<double>(gap - known) / static_cast<double>(i - known);
      sum[gap] = (1.0 - share) * sum[known] + share * sum[i];
    }
    known = i;
  }
  if (count.front() == 0.0 || count.back() == 0.0 || static_cast<double>(empty) > kMostEmptyBins * static_cast<double>(sum.size())) return {};
  return sum;
}

// First frequency with half of the contrast, from the edge's profile.
double HalfContrast(const std::vector<double>& spread) {
  const double middle = 0.5 * static_cast<double>(spread.size() - 1);
  std::vector<double> line(spread.size(), 0.0);  // derivative, windowed
  for (size_t i = 1; i + 1 < spread.size(); ++i) line[i] = 0.5 * (spread[i + 1] - spread[i - 1]) * Hamming(static_cast<double>(i) - middle, middle);
  const auto modulus = [&](double frequency) {
    double real = 0.0, imaginary = 0.0;
    for (size_t i = 0; i < line.size(); ++i) {
      const double phase = 2.0 * std::numbers::pi * frequency * (static_cast<double>(i) - middle) / kBinsPerPixel;
      real += line[i] * std::cos(phase);
      imaginary += line[i] * std::sin(phase);
    }
    // The difference of neighbours but one damps high frequencies.
    const double step = 2.0 * std::numbers::pi * frequency / kBinsPerPixel;
    return std::hypot(real, imaginary) / (step > 0.0 ? std::sin(step) / step : 1.0);
  };
  const double whole = modulus(0.0);
  if (!(whole > 0.0)) return kNotMeasured;
  constexpr double kStep = 0.005;
  double before = 1.0;
  for (int k = 1; k * kStep <= 1.0; ++k) {
    const double here = modulus(k * kStep) / whole;
    if (here < 0.5) return kStep * (k - 1 + (before - 0.5) / (before - here));
    before = here;
  }
  return kNotMeasured;
}

}  // namespace

double SlantedEdgeMtf50(const image::ImageF& luminance) {
  SKYQUILT_CHECK(luminance.channels == 1, "one channel");
  if (std::min(luminance.width, luminance.height) < kSmallestPatch) return kNotMeasured;
  if (!std::all_of(luminance.data.begin(), luminance.data.end(), [](float value) { return std::isfinite(value); })) return kNotMeasured;
  const image::ImageF& image = EdgeIsUpright(luminance) ? luminance : Transposed(luminance);
  const double contrast = ContrastAcross(image);
  if (std::abs(contrast) < kLeastContrast) return kNotMeasured;
  std::optional<EdgeLine> edge = EdgeLine{0.5 * (image.width - 1), 0.0};
  for (int pass = 0; pass < 3 && edge; ++pass) edge = FitEdge(image, contrast > 0.0 ? 1.0 : -1.0, *edge);
  if (!edge) return kNotMeasured;
  const std::vector<double> spread = EdgeSpread(image, *edge);
  return spread.empty() ? kNotMeasured : HalfContrast(spread);
}

}  // namespace skyquilt::evaluate::ortho
