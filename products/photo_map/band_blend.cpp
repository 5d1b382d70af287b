#include "products/photo_map/band_blend.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/errors.h"

namespace skyquilt::products {
namespace {

// Copies one channel; what is not finite becomes the nearest finite value of the row.
void CopyFiniteRow(const float* rgb, int channel, int width, float* out) {
  int known = -1;  // last finite pixel
  for (int x = 0; x < width; ++x) {
    const float value = rgb[3 * x + channel];
    out[x] = value;
    if (!std::isfinite(value)) continue;
    for (int gap = known + 1; gap < x; ++gap) out[gap] = known >= 0 && gap - known <= x - gap ? out[known] : value;
    known = x;
  }
  for (int gap = known + 1; gap < width; ++gap) out[gap] = known >= 0 ? out[known] : 0.0F;
}

}  // namespace

BandBlender::BandBlender(int width, int height, int levels) : width_(width), height_(height), levels_(std::max(levels, 0)) {
  SKYQUILT_CHECK(width > 0 && height > 0, "a blended picture needs pixels");
  while (levels_ > 0 && (levels_ > 30 || std::min(width, height) >> levels_ < 2)) --levels_;
  for (int level = 0, w = width, h = height; level <= levels_; ++level, w = (w + 1) / 2, h = (h + 1) / 2) {
    sums_.push_back({{Plane(w, h), Plane(w, h), Plane(w, h)}, Plane(w, h)});
  }
}

// Half the size, rounded up, by the binomial filter 1 4 6 4 1; pixel i lies on pixel 2 i of the fine plane. Borders are repeated outwards.
BandBlender::Plane BandBlender::Reduce(const Plane& fine) {
  Plane coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  std::vector<float> padded(static_cast<size_t>(fine.width) + 5);
  float* const middle = padded.data() + 2;
  for (int y = 0; y < coarse.height; ++y) {
    const auto row = [&](int offset) { return fine.Row(std::clamp(2 * y + offset, 0, fine.height - 1)); };
    const float* const a = row(-2);
    const float* const b = row(-1);
    const float* const c = row(0);
    const float* const d = row(1);
    const float* const e = row(2);
    for (int x = 0; x < fine.width; ++x) middle[x] = (a[x] + e[x]) * (1.0F / 16.0F) + (b[x] + d[x]) * (4.0F / 16.0F) + c[x] * (6.0F / 16.0F);
    middle[-2] = middle[-1] = middle[0];
    for (int x = fine.width; x < fine.width + 3; ++x) middle[x] = middle[fine.width - 1];
    float* const out = coarse.Row(y);
    const float* const in = padded.data();
    for (int x = 0; x < coarse.width; ++x) {
      out[x] = (in[2 * x] + in[2 * x + 4]) * (1.0F / 16.0F) + (in[2 * x + 1] + in[2 * x + 3]) * (4.0F / 16.0F) + in[2 * x + 2] * (6.0F / 16.0F);
    }
  }
  return coarse;
}

// Calls function(y, row) for each row of the coarse plane enlarged to `height` rows: (1 6 1) / 8 on its pixels, (4 4) / 8 between them.
template <typename Function>
void BandBlender::ExpandRows(const Plane& coarse, int height, const Function& function) {
  std::vector<float> padded(static_cast<size_t>(coarse.width) + 2);
  std::vector<float> fine(static_cast<size_t>(coarse.width) * 2);  // as wide as the fine plane, or one more
  for (int y = 0; y < height; ++y) {
    const float* const above = coarse.Row(std::max(y / 2 - 1, 0));
    const float* const here = coarse.Row(y / 2);
    const float* const below = coarse.Row(std::min(y / 2 + 1, coarse.height - 1));
    float* const middle = padded.data() + 1;
    if (y % 2 == 0) {
      for (int x = 0; x < coarse.width; ++x) middle[x] = (above[x] + below[x]) * 0.125F + here[x] * 0.75F;
    } else {
      for (int x = 0; x < coarse.width; ++x) middle[x] = (here[x] + below[x]) * 0.5F;
    }
    middle[-1] = middle[0];
    middle[coarse.width] = middle[coarse.width - 1];
    const float* const in = padded.data();
    float* const out = fine.data();
    for (int x = 0; x < coarse.width; ++x) {
      out[2 * x] = (in[x] + in[x + 2]) * 0.125F + in[x + 1] * 0.75F;
      out[2 * x + 1] = (in[x + 1] + in[x + 2]) * 0.5F;
    }
    function(y, static_cast<const float*>(out));
  }
}

void BandBlender::Add(const image::ImageF& rgb, std::span<const float> mask, int x, int y) {
  if (rgb.Empty()) return;
  SKYQUILT_CHECK(rgb.channels == 3 && mask.size() * 3 == rgb.data.size(), "a layer has three channels and one mask value per pixel");
  SKYQUILT_CHECK(!sums_.empty() && x >= 0 && y >= 0 && rgb.width <= width_ - x && rgb.height <= height_ - y, "a layer lies inside the picture");
  SKYQUILT_CHECK(((x | y) & ((1 << levels_) - 1)) == 0, "a layer starts at multiples of 2^levels");
  std::array<Plane, 3> color;
  for (int c = 0; c < 3; ++c) {
    Plane& plane = color[static_cast<size_t>(c)] = Plane(rgb.width, rgb.height);
    for (int row = 0; row < rgb.height; ++row) CopyFiniteRow(rgb.At(0, row), c, rgb.width, plane.Row(row));
  }
  Plane weight(rgb.width, rgb.height);
  std::copy(mask.begin(), mask.end(), weight.data.begin());

  for (int level = 0; level <= levels_; ++level, x /= 2, y /= 2) {
    Level& sums = sums_[static_cast<size_t>(level)];
    const int width = weight.width;
    const int height = weight.height;
    for (size_t c = 0; c < 3; ++c) {
      const Plane& picture = color[c];
      Plane& sum = sums.color[c];
      if (level == levels_) {
        for (int row = 0; row < height; ++row) {
          const float* const w = weight.Row(row);
          const float* const in = picture.Row(row);
          float* const out = sum.Row(y + row) + x;
          for (int i = 0; i < width; ++i) out[i] += w[i] * in[i];
        }
        continue;
      }
      Plane coarse = Reduce(picture);
      ExpandRows(coarse, height, [&](int row, const float* expanded) {
        const float* const w = weight.Row(row);
        const float* const in = picture.Row(row);
        float* const out = sum.Row(y + row) + x;
        for (int i = 0; i < width; ++i) out[i] += w[i] * (in[i] - expanded[i]);
      });
      color[c] = std::move(coarse);
    }
    for (int row = 0; row < height; ++row) {
      const float* const w = weight.Row(row);
      float* const out = sums.weight.Row(y + row) + x;
      for (int i = 0; i < width; ++i) out[i] += w[i];
    }
    if (level < levels_) weight = Reduce(weight);
  }
}

image::ImageF BandBlender::Finish() {
  SKYQUILT_CHECK(!sums_.empty(), "a blended picture is taken once");
  image::ImageF picture(width_, height_, 3);
  for (size_t c = 0; c < 3; ++c) {
    Plane coarse;
    for (int level = levels_; level >= 0; --level) {
      Level& sums = sums_[static_cast<size_t>(level)];
      Plane fine = std::move(sums.color[c]);
      for (size_t i = 0; i < fine.data.size(); ++i) fine.data[i] = sums.weight.data[i] > 0.0F ? fine.data[i] / sums.weight.data[i] : 0.0F;
      if (level < levels_) {
        ExpandRows(coarse, fine.height, [&](int row, const float* expanded) {
          float* const out = fine.Row(row);
          for (int i = 0; i < fine.width; ++i) out[i] += expanded[i];
        });
      }
      coarse = std::move(fine);
    }
    for (size_t i = 0; i < coarse.data.size(); ++i) picture.data[3 * i + c] = coarse.data[i];
  }
  sums_.clear();
  return picture;
}

}  // namespace skyquilt::products
