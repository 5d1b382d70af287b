#include "core/survey/picture_colors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/image/srgb.h"

namespace skyquilt::survey {
namespace {

constexpr int kSteps = 2048;
constexpr float kMostLight = 4.0F;

// A function of 0..1 as straight pieces.
template <typename Function>
std::vector<float> TableOf(const Function& function) {
  std::vector<float> table(kSteps + 2);
  for (int i = 0; i < kSteps + 2; ++i) table[static_cast<size_t>(i)] = function(static_cast<float>(i) / kSteps);
  return table;
}

float Look(const std::vector<float>& table, float x) {
  const float position = std::clamp(x, 0.0F, 1.0F) * kSteps;
  const auto index = static_cast<size_t>(position);
  return table[index] + (position - static_cast<float>(index)) * (table[index + 1] - table[index]);
}

constexpr int kTaps = 6;  // pixels along an axis
constexpr int kPhases = 256;

// Lanczos weights of the pixels at -2 .. 3 for positions between those at 0 and 1, in steps of 1 / kPhases.
const std::vector<std::array<float, kTaps>>& LanczosWeights() {
  static const std::vector<std::array<float, kTaps>> table = [] {
    std::vector<std::array<float, kTaps>> weights(kPhases + 1);
    for (int phase = 0; phase <= kPhases; ++phase) {
      std::array<double, kTaps> exact{};
      double sum = 0.0;
      for (int tap = 0; tap < kTaps; ++tap) {
        const double x = std::numbers::pi * (tap - 2 - static_cast<double>(phase) / kPhases);
        sum += exact[static_cast<size_t>(tap)] = std::abs(x) < 1e-9 ? 1.0 : 3.0 * std::sin(x) * std::sin(x / 3.0) / (x * x);
      }
      for (size_t tap = 0; tap < kTaps; ++tap) weights[static_cast<size_t>(phase)][tap] = static_cast<float>(exact[tap] / sum);
    }
    return weights;
  }();
  return table;
}

}  // namespace

float QuickLight(float display) {
  static const std::vector<float> table = TableOf([](float x) { return image::LinearFromSrgb(x); });
  return Look(table, display);
}

float QuickDisplay(float light) {
  // Over the root of light the curve is nearly straight.
  static const std::vector<float> table = TableOf([](float x) { return image::SrgbFromLinear(kMostLight * x * x); });
  return Look(table, std::sqrt(std::max(light, 0.0F) / kMostLight));
}

std::optional<Eigen::Vector2d> PixelIn(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, const Eigen::Vector3d& place_enu) {
  const std::optional<Eigen::Vector2d> pixel = camera.ImgFromCam(cam_from_enu * place_enu);
  if (!pixel || !(pixel->x() >= 0.0 && pixel->y() >= 0.0 && pixel->x() <= camera.width && pixel->y() <= camera.height)) return std::nullopt;
  return pixel;
}

bool IsMasked(const PhotoPicture& picture, const Eigen::Vector2d& pixel) {
  if (picture.mask.Empty()) return false;
  const int x = std::min(static_cast<int>(pixel.x()), picture.mask.width - 1), y = std::min(static_cast<int>(pixel.y()), picture.mask.height - 1);
  return *picture.mask.At(x, y) == 0;
}

float Radius2(const camera::Camera& camera, const Eigen::Vector2d& pixel) {
  const double farthest = camera.MaxImageRadius();
  return static_cast<float>((pixel - camera.PrincipalPoint()).squaredNorm() / (farthest * farthest));
}

std::array<float, 3> LinearAt(const PhotoPicture& picture, const Eigen::Vector2d& pixel) {
  const image::Image8& rgb = picture.rgb;
  const double x = std::clamp(pixel.x() - 0.5, 0.0, rgb.width - 1.0), y = std::clamp(pixel.y() - 0.5, 0.0, rgb.height - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, rgb.width - 1), y1 = std::min(y0 + 1, rgb.height - 1);
  const auto u = static_cast<float>(x - x0), v = static_cast<float>(y - y0);
  const uint8_t *a = rgb.At(x0, y0), *b = rgb.At(x1, y0), *c = rgb.At(x0, y1), *d = rgb.At(x1, y1);
  std::array<float, 3> result{};
  for (size_t k = 0; k < 3; ++k) {
    const float upper = (1.0F - u) * a[k] + u * b[k], lower = (1.0F - u) * c[k] + u * d[k];
    result[k] = ((1.0F - v) * upper + v * lower) / 255.0F;
  }
  return result;
}

std::array<float, 3> LanczosAt(const PhotoPicture& picture, const Eigen::Vector2d& pixel) {
  const image::Image8& rgb = picture.rgb;
  const double x = pixel.x() - 0.5, y = pixel.y() - 0.5;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  if (x0 < 2 || y0 < 2 || x0 + 3 >= rgb.width || y0 + 3 >= rgb.height) return LinearAt(picture, pixel);
  const std::array<float, kTaps>& across = LanczosWeights()[static_cast<size_t>(std::lround((x - x0) * kPhases))];
  const std::array<float, kTaps>& down = LanczosWeights()[static_cast<size_t>(std::lround((y - y0) * kPhases))];
  std::array<float, 3> sum{};
  for (int j = 0; j < kTaps; ++j) {
    const uint8_t* row = rgb.At(x0 - 2, y0 - 2 + j);
    std::array<float, 3> line{};
    for (size_t i = 0; i < kTaps; ++i) {
      for (size_t k = 0; k < 3; ++k) line[k] += across[i] * static_cast<float>(row[3 * i + k]);
    }
    for (size_t k = 0; k < 3; ++k) sum[k] += down[static_cast<size_t>(j)] * line[k];
  }
  for (float& value : sum) value = std::clamp(value / 255.0F, 0.0F, 1.0F);
  return sum;
}

std::array<float, 3> InLight(const std::array<float, 3>& display, const std::array<float, 3>& factors) {
  std::array<float, 3> result{};
  for (size_t k = 0; k < 3; ++k) result[k] = std::min(QuickDisplay(factors[k] * QuickLight(display[k])), 1.0F);
  return result;
}

}  // namespace skyquilt::survey
