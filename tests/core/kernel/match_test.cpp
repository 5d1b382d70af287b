#include "core/kernel/match.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "core/base/random.h"
#include "tests/support/each_instruction_set.h"

namespace skyquilt::kernel {
namespace {

class Match : public testing::EachInstructionSet {};
SKYQUILT_EACH_INSTRUCTION_SET(Match);

constexpr int kWidth = 90, kHeight = 40;

// Smooth in space, so that interpolation is nearly exact.
double Grey(double x, double y) {
  return 128.0 + 50.0 * std::sin(0.23 * x + 0.11 * y) + 40.0 * std::cos(0.17 * y - 0.08 * x);
}

MatchPicture PictureOf(double (*grey)(double, double), double shift_x = 0.0, double shift_y = 0.0) {
  std::vector<uint8_t> pixels(static_cast<size_t>(kWidth) * kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      pixels[static_cast<size_t>(y) * kWidth + static_cast<size_t>(x)] = static_cast<uint8_t>(std::lround(grey(x + shift_x, y + shift_y)));
    }
  }
  return {pixels, kWidth, kHeight};
}

// The other camera stands beside this one: a place at inverse depth a appears 100 a pixels further to the left there.
constexpr MatchTransform kBeside = {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {-100, 0, 0}};

struct PlaneArrays {
  std::array<float, kMatchPixels> a{}, slope_x{}, slope_y{};
  MatchPlanes Get() const { return {a.data(), slope_x.data(), slope_y.data()}; }
};

// As the kernel defines it, in double precision.
double Correlation(const MatchWindows& windows, const MatchPicture& other, const MatchTransform& m, const PlaneArrays& planes, size_t i) {
  double sum = 0.0, sum2 = 0.0, product = 0.0;
  for (size_t s = 0; s < kMatchSamples; ++s) {
    const int u = kMatchStep * static_cast<int>(s % kMatchSide) - kMatchRadius, v = kMatchStep * static_cast<int>(s / kMatchSide) - kMatchRadius;
    const double x = static_cast<double>(windows.x[i]) + u, y = windows.y + v;
    const double a = static_cast<double>(planes.a[i]) + u * static_cast<double>(planes.slope_x[i]) + v * static_cast<double>(planes.slope_y[i]);
    double p[3];
    for (size_t r = 0; r < 3; ++r) {
      p[r] = static_cast<double>(m.h[3 * r]) * x + static_cast<double>(m.h[3 * r + 1]) * y + static_cast<double>(m.h[3 * r + 2]) +
             static_cast<double>(m.t[r]) * a;
    }
    const double px = p[0] / p[2], py = p[1] / p[2];
    if (!(p[2] > 0.0 && px >= 0.0 && py >= 0.0 && px <= kWidth - 1 && py <= kHeight - 1)) return static_cast<double>(kNoMatch);
    const int x0 = std::min(static_cast<int>(px), kWidth - 2), y0 = std::min(static_cast<int>(py), kHeight - 2);
    const double fx = px - x0, fy = py - y0;
    const auto at = [&](int dx, int dy) { return static_cast<double>(other.At(x0 + dx, y0 + dy)); };
    const double value = (at(0, 0) * (1 - fx) + at(1, 0) * fx) * (1 - fy) + (at(0, 1) * (1 - fx) + at(1, 1) * fx) * fy;
    const auto weight = static_cast<double>(windows.weight[s * kMatchPixels + i]);
    sum += weight * value;
    sum2 += weight * value * value;
    product += weight * value * static_cast<double>(windows.value[s * kMatchPixels + i]);
  }
  const double variance = sum2 - sum * sum, own = static_cast<double>(windows.variance[i]);
  if (variance < 4.0 || own < 4.0) return static_cast<double>(kNoMatch);
  return (product - sum * static_cast<double>(windows.mean[i])) / std::sqrt(variance * own);
}

TEST_P(Match, AgreesWithTheDefinition) {
  const MatchPicture picture = PictureOf(&Grey), other = PictureOf(&Grey, 7.0, 1.0);
  const MatchTransform turned = {{1.02F, 0.03F, -3.0F, -0.02F, 0.98F, 1.0F, 1e-4F, -2e-4F, 1.0F}, {-100.0F, 20.0F, 0.4F}};
  base::Random random(5);
  auto windows = std::make_unique<MatchWindows>();
  for (int y = 0; y < kHeight; y += 3) {
    FillMatchWindows(picture, 9, y, kMatchPixels, windows.get());
    PlaneArrays planes;
    for (size_t i = 0; i < kMatchPixels; ++i) {
      planes.a[i] = 0.02F + 0.1F * random.Uniform();
      planes.slope_x[i] = 0.002F * (random.Uniform() - 0.5F);
      planes.slope_y[i] = 0.002F * (random.Uniform() - 0.5F);
    }
    for (const MatchTransform& transform : {kBeside, turned}) {
      std::array<float, kMatchPixels> found{};
      MatchUnderPlanes(*windows, other, transform, planes.Get(), found.data());
      for (size_t i = 0; i < kMatchPixels; ++i) {
        const double expected = Correlation(*windows, other, transform, planes, i);
        // A sample on the border may fall to either side.
        if ((expected == static_cast<double>(kNoMatch)) != (found[i] == kNoMatch)) continue;
        EXPECT_NEAR(static_cast<double>(found[i]), expected, 2e-3) << "pixel " << i << " of row " << y;
      }
    }
  }
}

TEST_P(Match, IsBestUnderTheTruePlane) {
  // The other picture shows everything 6 pixels further to the left: inverse depth 0.06.
  const MatchPicture picture = PictureOf(&Grey), other = PictureOf(&Grey, 6.0);
  auto windows = std::make_unique<MatchWindows>();
  FillMatchWindows(picture, 12, 20, kMatchPixels, windows.get());
  const auto at = [&](float a) {
    PlaneArrays planes;
    planes.a.fill(a);
    std::array<float, kMatchPixels> found{};
    MatchUnderPlanes(*windows, other, kBeside, planes.Get(), found.data());
    return found;
  };
  const auto right = at(0.06F), nearer = at(0.07F), farther = at(0.05F);
  for (size_t i = 0; i < kMatchPixels; ++i) {
    EXPECT_GT(right[i], 0.999F);
    EXPECT_GT(right[i], nearer[i]);
    EXPECT_GT(right[i], farther[i]);
  }
}

TEST_P(Match, BrightnessDoesNotMatter) {
  const MatchPicture picture = PictureOf(&Grey), other = PictureOf([](double x, double y) { return 20.0 + 0.5 * Grey(x, y); });
  auto windows = std::make_unique<MatchWindows>();
  FillMatchWindows(picture, 12, 20, kMatchPixels, windows.get());
  std::array<float, kMatchPixels> found{};
  MatchUnderPlanes(*windows, other, kBeside, PlaneArrays{}.Get(), found.data());
  for (const float correlation : found) EXPECT_GT(correlation, 0.99F);
}

TEST_P(Match, SaysWhereNothingCanBeCompared) {
  const MatchPicture picture = PictureOf(&Grey), flat = PictureOf([](double, double) { return 90.0; });
  auto windows = std::make_unique<MatchWindows>();
  const auto all = [&](const MatchPicture& own, const MatchPicture& other, const MatchTransform& transform, float a) {
    FillMatchWindows(own, 12, 20, kMatchPixels, windows.get());
    PlaneArrays planes;
    planes.a.fill(a);
    std::array<float, kMatchPixels> found{};
    MatchUnderPlanes(*windows, other, transform, planes.Get(), found.data());
    return found;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const MatchTransform behind = {{1, 0, 0, 0, 1, 0, 0, 0, -1}, {0, 0, 0}};
  for (const auto& found : {all(picture, flat, kBeside, 0.0F), all(flat, picture, kBeside, 0.0F), all(picture, picture, kBeside, 5.0F),
                            all(picture, picture, kBeside, nan), all(picture, picture, kBeside, infinity), all(picture, picture, behind, 0.0F)}) {
    for (const float correlation : found) EXPECT_EQ(correlation, kNoMatch);
  }
}

TEST_P(Match, WindowsAreWeightedMeansAndCanBeTakenApart) {
  const MatchPicture picture = PictureOf(&Grey);
  for (const int y : {0, 20, kHeight - 1}) {
    auto windows = std::make_unique<MatchWindows>();
    FillMatchWindows(picture, 60, y, 30, windows.get());
    for (size_t i = 0; i < 30; ++i) {
      double weights = 0.0, mean = 0.0;
      for (size_t s = 0; s < kMatchSamples; ++s) {
        weights += static_cast<double>(windows->weight[s * kMatchPixels + i]);
        mean += static_cast<double>(windows->weight[s * kMatchPixels + i]) * static_cast<double>(windows->value[s * kMatchPixels + i]);
      }
      EXPECT_NEAR(weights, 1.0, 1e-5);
      EXPECT_NEAR(mean, static_cast<double>(windows->mean[i]), 1e-2);
    }
    // Nothing of a window beyond the picture counts.
    EXPECT_EQ(windows->weight[(kMatchSide / 2 * kMatchSide + kMatchSide - 1) * kMatchPixels + 29], 0.0F);

    const MatchPicture other = PictureOf(&Grey, 2.0);
    PlaneArrays planes;
    planes.a.fill(0.02F);
    std::array<float, kMatchPixels> whole{}, part{};
    MatchUnderPlanes(*windows, other, kBeside, planes.Get(), whole.data());
    const std::vector<int> places = {2, 3, 11, 17, 23};
    windows->Keep(places);
    ASSERT_EQ(windows->count, 5);
    MatchUnderPlanes(*windows, other, kBeside, planes.Get(), part.data());
    for (size_t k = 0; k < places.size(); ++k) EXPECT_EQ(part[k], whole[static_cast<size_t>(places[k])]);
  }
}

}  // namespace
}  // namespace skyquilt::kernel
