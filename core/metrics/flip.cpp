#include "core/metrics/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/metrics/check_shapes.h"
#include "core/metrics/flip_color.h"
#include "core/metrics/flip_filters.h"

namespace skyquilt::metrics {
namespace {

constexpr float kColorExponent = 0.7F;  // q_c of the paper
constexpr float kKnee = 0.4F;           // p_c: errors of colour below this share of the largest one
constexpr float kKneeTarget = 0.95F;    // p_t: become 0 to this, the rest is squeezed above it
constexpr float kIgnored = 0.5F;        // display value of pixels that do not count
constexpr int kBandRows = 64;           // rows per task

// A part of an image with a value per pixel.
struct Plane {
  size_t width = 0;
  std::vector<float> data;

  Plane() = default;
  Plane(int w, int h) : width(static_cast<size_t>(w)), data(static_cast<size_t>(w) * static_cast<size_t>(h)) {}
  float* Row(int y) { return data.data() + static_cast<size_t>(y) * width; }
  const float* Row(int y) const { return data.data() + static_cast<size_t>(y) * width; }
};

void AddScaled(float weight, const float* in, size_t n, float* out) {
  for (size_t i = 0; i < n; ++i) out[i] += weight * in[i];
}

// padded: rows with the taps' radius before and after out's columns, or more by `extra` columns on each side.
void FilterRows(const Plane& padded, const Taps& taps, int extra, int rows, Plane* out) {
  std::fill(out->data.begin(), out->data.end(), 0.0F);
  for (int y = 0; y < rows; ++y) {
    for (size_t k = 0; k < taps.size(); ++k) AddScaled(taps[k], padded.Row(y) + static_cast<size_t>(extra) + k, out->width, out->Row(y));
  }
}

// One filtered row; `top`: the row of `in` below the first tap.
void FilterColumns(const Plane& in, const Taps& taps, int top, std::vector<float>* out) {
  std::fill(out->begin(), out->end(), 0.0F);
  for (size_t k = 0; k < taps.size(); ++k) AddScaled(taps[k], in.Row(top + static_cast<int>(k)), in.width, out->data());
}

// What the eye sees of some rows of one image.
struct SeenBand {
  std::vector<Triple> lab;    // blurred colours, CIELab with Hunt adjustment
  std::vector<float> edges;   // 0..1
  std::vector<float> points;  // 0..1
};

class Eye {
 public:
  Eye(const image::ImageF& image, const image::Image8* mask) : image_(image), mask_(mask) {}

  // Rows [first, last) of the image.
  SeenBand See(int first, int last) const {
    const FlipFilters& filters = FiltersOfFlip();
    const int radius = std::max(filters.color_radius, filters.feature_radius);
    const int rows = last - first + 2 * radius;
    const std::array<Plane, 3> opponent = Opponent(first - radius, rows, radius);

    const auto filtered = [&](const Plane& in, const Taps& taps, int taps_radius) {
      Plane out(image_.width, rows);
      FilterRows(in, taps, radius - taps_radius, rows, &out);
      return out;
    };
    const Plane achromatic = filtered(opponent[0], filters.achromatic, filters.color_radius);
    const Plane red_green = filtered(opponent[1], filters.red_green, filters.color_radius);
    const Plane broad = filtered(opponent[2], filters.blue_yellow_broad, filters.color_radius);
    const Plane narrow = filtered(opponent[2], filters.blue_yellow_narrow, filters.color_radius);
    const Plane smooth = filtered(opponent[0], filters.smooth, filters.feature_radius);
    const Plane edge = filtered(opponent[0], filters.edge, filters.feature_radius);
    const Plane point = filtered(opponent[0], filters.point, filters.feature_radius);

    const auto width = static_cast<size_t>(image_.width);
    SeenBand seen;
    std::array<std::vector<float>, 8> row;
    row.fill(std::vector<float>(width));
    for (int y = 0; y < last - first; ++y) {
      const int color_top = y + radius - filters.color_radius;
      const int feature_top = y + radius - filters.feature_radius;
      FilterColumns(achromatic, filters.achromatic, color_top, &row[0]);
      FilterColumns(red_green, filters.red_green, color_top, &row[1]);
      FilterColumns(broad, filters.blue_yellow_broad, color_top, &row[2]);
      FilterColumns(narrow, filters.blue_yellow_narrow, color_top, &row[3]);
      FilterColumns(edge, filters.smooth, feature_top, &row[4]);
      FilterColumns(smooth, filters.edge, feature_top, &row[5]);
      FilterColumns(point, filters.smooth, feature_top, &row[6]);
      FilterColumns(smooth, filters.point, feature_top, &row[7]);
      for (size_t x = 0; x < width; ++x) {
        const float blue_yellow = filters.broad_weight * row[2][x] + filters.narrow_weight * row[3][x];
        Triple linear = LinearFromOpponent({row[0][x], row[1][x], blue_yellow});
        for (float& value : linear) value = std::clamp(value, 0.0F, 1.0F);
        seen.lab.push_back(HuntLabFromLinear(linear));
        // The detectors work on luminance from 0 to 1; they do not see the constant part of 116 y - 16.
        seen.edges.push_back(std::hypot(row[4][x], row[5][x]) / 116.0F);
        seen.points.push_back(std::hypot(row[6][x], row[7][x]) / 116.0F);
      }
    }
    return seen;
  }

 private:
  // Opponent colours of `rows` rows from `top` on, with `pad` columns on each side. Beyond the border the outermost pixels are repeated.
  std::array<Plane, 3> Opponent(int top, int rows, int pad) const {
    std::array<Plane, 3> planes;
    planes.fill(Plane(image_.width + 2 * pad, rows));
    for (int i = 0; i < rows; ++i) {
      const int y = std::clamp(top + i, 0, image_.height - 1);
      for (int x = 0; x < image_.width; ++x) {
        const Triple color = OpponentAt(x, y);
        for (size_t c = 0; c < 3; ++c) planes[c].Row(i)[x + pad] = color[c];
      }
      for (Plane& plane : planes) {
        float* row = plane.Row(i);
        std::fill(row, row + pad, row[pad]);
        std::fill(row + pad + image_.width, row + 2 * pad + image_.width, row[pad + image_.width - 1]);
      }
    }
    return planes;
  }

  Triple OpponentAt(int x, int y) const {
    const bool counts = mask_ == nullptr || *mask_->At(x, y) != 0;
    Triple linear{};
    for (size_t c = 0; c < 3; ++c) linear[c] = image::LinearFromSrgb(counts ? std::clamp(image_.At(x, y)[c], 0.0F, 1.0F) : kIgnored);
    return OpponentFromLinear(linear);
  }

  const image::ImageF& image_;
  const image::Image8* mask_;
};

// The largest distance of two colours on a screen, that of green and blue.
float LargestColorError() {
  static const float largest = std::pow(HyAb(HuntLabFromLinear({0.0F, 1.0F, 0.0F}), HuntLabFromLinear({0.0F, 0.0F, 1.0F})), kColorExponent);
  return largest;
}

float ColorError(const Triple& p, const Triple& q) {
  const float largest = LargestColorError();
  const float knee = kKnee * largest;
  const float error = std::pow(HyAb(p, q), kColorExponent);
  return error < knee ? kKneeTarget / knee * error : kKneeTarget + (error - knee) / (largest - knee) * (1.0F - kKneeTarget);
}

float PixelError(const SeenBand& a, const SeenBand& b, size_t i) {
  const float difference = std::max(std::abs(a.edges[i] - b.edges[i]), std::abs(a.points[i] - b.points[i]));
  const float feature = std::sqrt(difference / std::numbers::sqrt2_v<float>);  // exponent q_f = 1/2
  return std::pow(ColorError(a.lab[i], b.lab[i]), 1.0F - feature);
}

}  // namespace

double Flip(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask, base::ThreadPool& threads, image::ImageF* map) {
  CheckShapes(a, b, mask);
  SKYQUILT_CHECK(a.Empty() || a.channels == 3, "FLIP compares RGB images, not " + ShapeText(a));
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  if (map != nullptr) *map = image::ImageF(a.width, a.height, 1, kNan);
  const Eye eye_a(a, mask), eye_b(b, mask);
  std::vector<double> row_sum(static_cast<size_t>(a.height), 0.0);
  std::vector<int64_t> row_count(static_cast<size_t>(a.height), 0);
  threads.ParallelFor((a.height + kBandRows - 1) / kBandRows, [&](int64_t band, int) {
    const int first = static_cast<int>(band) * kBandRows;
    const int last = std::min(first + kBandRows, a.height);
    const SeenBand seen_a = eye_a.See(first, last), seen_b = eye_b.See(first, last);
    size_t i = 0;
    for (int y = first; y < last; ++y) {
      for (int x = 0; x < a.width; ++x, ++i) {
        if (mask != nullptr && *mask->At(x, y) == 0) continue;
        const float error = PixelError(seen_a, seen_b, i);
        row_sum[static_cast<size_t>(y)] += static_cast<double>(error);
        ++row_count[static_cast<size_t>(y)];
        if (map != nullptr) *map->At(x, y) = error;
      }
    }
  });
  double sum = 0.0;
  int64_t count = 0;
  for (size_t y = 0; y < row_sum.size(); ++y) {
    sum += row_sum[y];
    count += row_count[y];
  }
  return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(count);
}

}  // namespace skyquilt::metrics
