#include "surface/texture/paint_atlas.h"

#include <algorithm>
#include <cmath>

#include "core/base/cancel.h"

namespace skyquilt::surface {
namespace {

constexpr uint8_t kNoColor = 128;

using PaintColor = std::array<float, 3>;

uint8_t ByteOf(float value) {
  return static_cast<uint8_t>(std::lround(std::clamp(value, 0.0F, 1.0F) * 255.0F));
}

PaintColor MeanColor(const TexelColors& colors) {
  std::array<double, 3> sum{};
  size_t n = 0;
  for (size_t i = 0; i < colors.known.size(); ++i) {
    if (colors.known[i] == 0) continue;
    for (size_t channel = 0; channel < 3; ++channel) sum[channel] += static_cast<double>(colors.rgb_srgb[i][channel]);
    ++n;
  }
  PaintColor mean;
  for (size_t channel = 0; channel < 3; ++channel) {
    mean[channel] = n == 0 ? static_cast<float>(kNoColor) / 255.0F : static_cast<float>(sum[channel] / static_cast<double>(n));
  }
  return mean;
}

// A chart's rectangle with its gutter.
class ChartPicture {
 public:
  ChartPicture(int width, int height)
      : width_(width), height_(height), color_(static_cast<size_t>(width) * static_cast<size_t>(height)), state_(color_.size(), kUnknown) {}

  void Set(int x, int y, const PaintColor& color) {
    const size_t i = IndexOf(x, y);
    color_[i] = color;
    state_[i] = kKnown;
    front_.push_back(i);
  }

  // Fills ring after ring around the known texels.
  void Fill() {
    std::vector<size_t> ring;
    while (!front_.empty()) {
      ring.clear();
      for (const size_t i : front_) {
        ForEachNeighbor(i, [&](size_t other) {
          if (state_[other] != kUnknown) return;
          state_[other] = kQueued;
          ring.push_back(other);
        });
      }
      std::sort(ring.begin(), ring.end());
      for (const size_t i : ring) color_[i] = MeanOfKnown(i);
      for (const size_t i : ring) state_[i] = kKnown;
      front_.swap(ring);
    }
  }

  void CopyTo(image::Image8* atlas, const Eigen::Vector2i& corner) const {
    for (int y = 0; y < height_; ++y) {
      uint8_t* out = atlas->At(corner.x(), corner.y() + y);
      for (int x = 0; x < width_; ++x, out += 3) {
        const size_t i = IndexOf(x, y);
        for (size_t channel = 0; channel < 3; ++channel) out[channel] = state_[i] == kKnown ? ByteOf(color_[i][channel]) : kNoColor;
      }
    }
  }

 private:
  enum State : uint8_t { kUnknown, kQueued, kKnown };

  size_t IndexOf(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x); }

  template <typename F>
  void ForEachNeighbor(size_t i, const F& f) const {
    const int x = static_cast<int>(i % static_cast<size_t>(width_));
    const int y = static_cast<int>(i / static_cast<size_t>(width_));
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height_ - 1); ++v) {
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width_ - 1); ++u) {
        if (u != x || v != y) f(IndexOf(u, v));
      }
    }
  }

  PaintColor MeanOfKnown(size_t i) const {
    PaintColor sum{};
    float n = 0.0F;
    ForEachNeighbor(i, [&](size_t other) {
      if (state_[other] != kKnown) return;
      for (size_t channel = 0; channel < 3; ++channel) sum[channel] += color_[other][channel];
      n += 1.0F;
    });
    for (float& value : sum) value /= n;
    return sum;
  }

  int width_, height_;
  std::vector<PaintColor> color_;
  std::vector<uint8_t> state_;
  std::vector<size_t> front_;  // texels whose neighbours may be unknown
};

}  // namespace

image::Image8 PaintAtlas(const AtlasLayout& layout, const AtlasTexels& texels, const TexelColors& colors, base::ThreadPool& threads) {
  image::Image8 atlas(layout.width, layout.height, 3);
  const PaintColor mean = MeanColor(colors);
  for (size_t i = 0; i < atlas.data.size(); ++i) atlas.data[i] = ByteOf(mean[i % 3]);
  threads.ParallelFor(static_cast<int64_t>(layout.charts.size()), [&](int64_t task, int) {
    base::ThrowIfCancelled();
    const auto c = static_cast<size_t>(task);
    const Eigen::Vector2i size = layout.charts[c].size.array() + 2 * kGutterTexels;
    const Eigen::Vector2i corner = layout.corner[c].array() - kGutterTexels;
    ChartPicture picture(size.x(), size.y());
    for (size_t i = texels.first[c]; i < texels.first[c + 1]; ++i) {
      if (colors.known[i] != 0) picture.Set(texels.texel[i].x - corner.x(), texels.texel[i].y - corner.y(), colors.rgb_srgb[i]);
    }
    picture.Fill();
    picture.CopyTo(&atlas, corner);
  });
  return atlas;
}

}  // namespace skyquilt::surface
