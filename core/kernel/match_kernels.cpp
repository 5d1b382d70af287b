#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/errors.h"
#include "core/kernel/match.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/kernel/match_kernels.cpp"
#include <hwy/foreach_target.h>  // re-includes this file once per instruction set
// clang-format off
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace skyquilt::kernel::HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

constexpr float kLeastVariance = 4.0F;  // of grey values in a window; below, noise is compared with noise

// The weight is a Gauss bell in the distance and falls with the square of the colour's difference.
void FillImpl(const MatchPicture& picture, int first, MatchWindows* windows) {
  const hn::CappedTag<float, kMatchPixels> d;
  const size_t lanes = hn::Lanes(d);
  constexpr float kSpatial_px = 3.0F, kColour = 20.0F;
  const int width = picture.width(), height = picture.height();
  // Grey values of the rows, with their border repeated, and where there is none.
  constexpr int kReach = kMatchPixels + 2 * kMatchRadius;
  float grey[kMatchSide][kReach], inside[kMatchSide][kReach], spatial[kMatchSamples];
  for (int row = 0; row < kMatchSide; ++row) {
    const int y = windows->y + row * kMatchStep - kMatchRadius;
    for (int i = 0; i < kReach; ++i) {
      const int x = first + i - kMatchRadius;
      inside[row][i] = x >= 0 && y >= 0 && x < width && y < height ? 1.0F : 0.0F;
      grey[row][i] = picture.At(std::clamp(x, 0, width - 1), std::clamp(y, 0, height - 1));
    }
  }
  for (int v = 0; v < kMatchSide; ++v) {
    for (int u = 0; u < kMatchSide; ++u) {
      const auto distance2 = static_cast<float>((u * kMatchStep - kMatchRadius) * (u * kMatchStep - kMatchRadius) +
                                                (v * kMatchStep - kMatchRadius) * (v * kMatchStep - kMatchRadius));
      spatial[v * kMatchSide + u] = std::exp(-0.5F * distance2 / (kSpatial_px * kSpatial_px));
    }
  }
  const auto per_colour2 = hn::Set(d, 1.0F / (kColour * kColour)), one = hn::Set(d, 1.0F);
  for (size_t i = 0; i < kMatchPixels; i += lanes) {
    const auto centre = hn::LoadU(d, &grey[kMatchSide / 2][i + kMatchRadius]);
    auto weights = hn::Zero(d), sum = weights, sum2 = weights;
    for (size_t sample = 0; sample < kMatchSamples; ++sample) {
      const size_t row = sample / kMatchSide, at = i + sample % kMatchSide * kMatchStep;
      const auto value = hn::LoadU(d, &grey[row][at]);
      const auto difference = hn::Sub(value, centre);
      const auto weight = hn::Div(hn::Mul(hn::LoadU(d, &inside[row][at]), hn::Set(d, spatial[sample])),
                                  hn::MulAdd(hn::Mul(difference, difference), per_colour2, one));
      hn::StoreU(value, d, windows->value.data() + sample * kMatchPixels + i);
      hn::StoreU(weight, d, windows->weight.data() + sample * kMatchPixels + i);
      weights = hn::Add(weights, weight);
      sum = hn::MulAdd(weight, value, sum);
      sum2 = hn::MulAdd(hn::Mul(weight, value), value, sum2);
    }
    const auto scale = hn::Div(one, weights), mean = hn::Mul(sum, scale);
    hn::StoreU(mean, d, windows->mean.data() + i);
    hn::StoreU(hn::Max(hn::Zero(d), hn::NegMulAdd(mean, mean, hn::Mul(sum2, scale))), d, windows->variance.data() + i);
    for (size_t sample = 0; sample < kMatchSamples; ++sample) {
      float* weight = windows->weight.data() + sample * kMatchPixels + i;
      hn::StoreU(hn::Mul(hn::LoadU(d, weight), scale), d, weight);
    }
  }
}

void MatchImpl(const MatchWindows& windows, const MatchPicture& other, const MatchTransform& transform, const MatchPlanes& planes,
               float* correlation) {
  const hn::CappedTag<float, kMatchPixels> d;
  const hn::RebindToSigned<decltype(d)> di;
  const size_t lanes = hn::Lanes(d);
  const auto& h = transform.h;
  const auto& t = transform.t;
  const auto right = hn::Set(d, static_cast<float>(other.width() - 1));
  const auto bottom = hn::Set(d, static_cast<float>(other.height() - 1));
  const auto width = hn::Set(di, other.width());
  const auto* quads = reinterpret_cast<const int32_t*>(other.quads());
  const auto zero = hn::Zero(d);
  const auto byte = hn::Set(di, 0xff);
  const float y = static_cast<float>(windows.y);
  for (size_t i = 0; i < static_cast<size_t>(windows.count); i += lanes) {
    const auto x = hn::LoadU(d, windows.x.data() + i);
    const auto a = hn::LoadU(d, planes.inverse_depth + i);
    const auto ax = hn::LoadU(d, planes.slope_x + i), ay = hn::LoadU(d, planes.slope_y + i);
    // Homogeneous position of the middle, and its change per pixel to the right and down.
    const auto middle = [&](size_t row) {
      return hn::MulAdd(hn::Set(d, h[3 * row]), x, hn::MulAdd(hn::Set(d, t[row]), a, hn::Set(d, h[3 * row + 1] * y + h[3 * row + 2])));
    };
    const auto change = [&](size_t row, size_t column, auto slope) { return hn::MulAdd(hn::Set(d, t[row]), slope, hn::Set(d, h[3 * row + column])); };
    const auto m0 = middle(0), m1 = middle(1), m2 = middle(2);
    const auto r0 = change(0, 0, ax), r1 = change(1, 0, ax), r2 = change(2, 0, ax);
    const auto d0 = change(0, 1, ay), d1 = change(1, 1, ay), d2 = change(2, 1, ay);
    auto sum = zero, sum2 = zero, product = zero;
    auto usable = hn::Gt(m2, zero);
    size_t sample = 0;
    for (int v = -kMatchRadius; v <= kMatchRadius; v += kMatchStep) {
      const auto down = hn::Set(d, static_cast<float>(v));
      const auto b0 = hn::MulAdd(down, d0, m0), b1 = hn::MulAdd(down, d1, m1), b2 = hn::MulAdd(down, d2, m2);
      for (int u = -kMatchRadius; u <= kMatchRadius; u += kMatchStep, ++sample) {
        const auto across = hn::Set(d, static_cast<float>(u));
        const auto scale = hn::Div(hn::Set(d, 1.0F), hn::MulAdd(across, r2, b2));
        const auto px = hn::Mul(hn::MulAdd(across, r0, b0), scale), py = hn::Mul(hn::MulAdd(across, r1, b1), scale);
        usable = hn::And(usable, hn::And(hn::And(hn::Ge(px, zero), hn::Le(px, right)), hn::And(hn::Ge(py, zero), hn::Le(py, bottom))));
        // Also of NaN, which Min and Max may pass on or not.
        const auto inside_x = hn::IfThenElseZero(usable, px), inside_y = hn::IfThenElseZero(usable, py);
        const auto column = hn::ConvertTo(di, inside_x), row = hn::ConvertTo(di, inside_y);
        const auto fx = hn::Sub(inside_x, hn::ConvertTo(d, column)), fy = hn::Sub(inside_y, hn::ConvertTo(d, row));
        const auto quad = hn::GatherIndex(di, quads, hn::Add(hn::Mul(row, width), column));
        const auto p00 = hn::ConvertTo(d, hn::And(quad, byte));
        const auto p10 = hn::ConvertTo(d, hn::And(hn::ShiftRight<8>(quad), byte));
        const auto p01 = hn::ConvertTo(d, hn::And(hn::ShiftRight<16>(quad), byte));
        const auto p11 = hn::ConvertTo(d, hn::And(hn::ShiftRight<24>(quad), byte));
        const auto upper = hn::MulAdd(fx, hn::Sub(p10, p00), p00), lower = hn::MulAdd(fx, hn::Sub(p11, p01), p01);
        const auto value = hn::MulAdd(fy, hn::Sub(lower, upper), upper);
        const auto weight = hn::LoadU(d, windows.weight.data() + sample * kMatchPixels + i);
        const auto weighted = hn::Mul(weight, value);
        sum = hn::Add(sum, weighted);
        sum2 = hn::MulAdd(weighted, value, sum2);
        product = hn::MulAdd(weighted, hn::LoadU(d, windows.value.data() + sample * kMatchPixels + i), product);
      }
    }
    const auto variance = hn::NegMulAdd(sum, sum, sum2), own_variance = hn::LoadU(d, windows.variance.data() + i);
    const auto least = hn::Set(d, kLeastVariance);
    usable = hn::And(usable, hn::And(hn::Ge(variance, least), hn::Ge(own_variance, least)));
    const auto covariance = hn::NegMulAdd(sum, hn::LoadU(d, windows.mean.data() + i), product);
    const auto found = hn::Div(covariance, hn::Sqrt(hn::Max(hn::Mul(variance, own_variance), hn::Set(d, 1e-6F))));
    hn::StoreU(hn::IfThenElse(usable, found, hn::Set(d, kNoMatch)), d, correlation + i);
  }
}

}  // namespace
}  // namespace skyquilt::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace skyquilt::kernel {

HWY_EXPORT(FillImpl);
HWY_EXPORT(MatchImpl);

MatchPicture::MatchPicture(std::span<const uint8_t> grey, int width, int height)
    : width_(width), height_(height), quads_(static_cast<size_t>(width) * static_cast<size_t>(height)) {
  SKYQUILT_CHECK(width >= 2 && height >= 2 && grey.size() == quads_.size(), "a grey picture of at least 2 x 2 pixels");
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int x1 = std::min(x + 1, width - 1), y1 = std::min(y + 1, height - 1);
      quads_[Index(x, y)] = static_cast<uint32_t>(grey[Index(x, y)]) | static_cast<uint32_t>(grey[Index(x1, y)]) << 8U |
                            static_cast<uint32_t>(grey[Index(x, y1)]) << 16U | static_cast<uint32_t>(grey[Index(x1, y1)]) << 24U;
    }
  }
}

void FillMatchWindows(const MatchPicture& picture, int x, int y, int count, MatchWindows* windows) {
  windows->y = y;
  windows->count = count;
  std::iota(windows->x.begin(), windows->x.end(), static_cast<float>(x));
  HWY_DYNAMIC_DISPATCH(FillImpl)(picture, x, windows);
}

void MatchWindows::Keep(std::span<const int> places) {
  const auto keep = [&](float* values) {
    for (size_t i = 0; i < places.size(); ++i) values[i] = values[places[i]];
  };
  for (float* values : {x.data(), mean.data(), variance.data()}) keep(values);
  for (size_t sample = 0; sample < kMatchSamples; ++sample) {
    keep(value.data() + sample * kMatchPixels);
    keep(weight.data() + sample * kMatchPixels);
  }
  count = static_cast<int>(places.size());
}

void MatchUnderPlanes(const MatchWindows& windows, const MatchPicture& other, const MatchTransform& transform, const MatchPlanes& planes,
                      float* correlation) {
  HWY_DYNAMIC_DISPATCH(MatchImpl)(windows, other, transform, planes, correlation);
}

}  // namespace skyquilt::kernel
#endif
