#include "masks/segmenter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::masks {
namespace {

using base::InputError;

constexpr const char* kFixNetwork =
    "Give a network with one input of 1 x 3 x H x W and one output of 1 x classes x H x W floats, exported for OpenCV 4.6 (ONNX opset 11), and the "
    "configuration that belongs to it";
constexpr const char* kMethod = "1";  // another one gives other masks from the same network

// A stretch of an axis that a tile begins at, and the part of it that counts.
struct Stretch {
  int begin = 0, first = 0, end = 0;
};

// Tiles of `size` pixels over `length`, evenly spread, each sharing at least `overlap` with the next; the middle of what they share divides them. One
// tile that is longer than the axis where that is short.
std::vector<Stretch> Divide(int length, int size, int overlap) {
  if (length <= size) return {{0, 0, length}};
  const int step = size - overlap, n = (length - overlap + step - 1) / step;
  std::vector<Stretch> stretches;
  stretches.reserve(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) stretches.push_back({static_cast<int>(static_cast<int64_t>(length - size) * i / (n - 1)), 0, length});
  for (size_t i = 1; i < stretches.size(); ++i) {
    const int border = (stretches[i].begin + stretches[i - 1].begin + size) / 2;
    stretches[i - 1].end = border;
    stretches[i].first = border;
  }
  return stretches;
}

std::string ShapeOf(const std::vector<int64_t>& shape) {
  std::string text;
  for (const int64_t size : shape) text += (text.empty() ? "" : " x ") + std::to_string(size);
  return text;
}

}  // namespace

struct Segmenter::Tile {
  Stretch x, y;
};

Segmenter::Segmenter(const std::filesystem::path& network, const std::filesystem::path& config)
    : config_(ReadSegmentConfig(config)),
      net_(network, kFixNetwork),
      key_(base::HashHex(net_.Digest() + " " + base::HashHex(base::ReadFile(config)) + " " + kMethod)) {
  if (net_.inputs().size() != 1) throw InputError(network, "is a network with " + std::to_string(net_.inputs().size()) + " inputs", kFixNetwork);
  const std::vector<int64_t>& shape = net_.inputs().front().shape;
  const std::array<int64_t, 4> wanted = {1, 3, config_.input_height, config_.input_width};
  const auto differs = [&](size_t axis) { return shape[axis] != 0 && shape[axis] != wanted[axis]; };
  if (shape.size() != 4 || differs(0) || differs(1) || differs(2) || differs(3)) {
    throw InputError(network,
                     "has an input of " + ShapeOf(shape) + " (0: any), but " + config.string() + " says 1 x 3 x " +
                         std::to_string(config_.input_height) + " x " + std::to_string(config_.input_width) + " (input_height, input_width)",
                     kFixNetwork);
  }
  net_.Load({wanted.begin(), wanted.end()});
  if (net_.Outputs() != 1) throw InputError(network, "is a network with " + std::to_string(net_.Outputs()) + " outputs", kFixNetwork);
  const network::Tensor trial = net_.Run(std::array{network::Tensor({wanted.begin(), wanted.end()})});
  const auto n_classes = static_cast<int64_t>(config_.classes.size());
  if (trial.shape.size() != 4 || trial.shape[0] != 1 || trial.shape[1] != n_classes || trial.values.empty()) {
    throw InputError(network,
                     "gives an output of " + ShapeOf(trial.shape) + ", but " + config.string() + " lists " + std::to_string(n_classes) +
                         " classes: it should be 1 x " + std::to_string(n_classes) + " x H x W",
                     kFixNetwork);
  }
}

image::Image8 Segmenter::Mask(const image::Image8& rgb) {
  SKYQUILT_CHECK(rgb.channels == 3 && !rgb.Empty(), "a photo has three channels");
  const int width = std::min(rgb.width, config_.photo_width);
  const image::Image8 photo = image::Resize(rgb, width, image::ScaledHeight(rgb.width, rgb.height, width));
  image::Image8 mask(photo.width, photo.height, 1, 255);
  for (const Stretch& y : Divide(photo.height, config_.input_height, config_.overlap)) {
    for (const Stretch& x : Divide(photo.width, config_.input_width, config_.overlap)) RunTile(photo, {x, y}, &mask);
  }
  return GrowIgnored(mask, config_.dilate_px);
}

void Segmenter::RunTile(const image::Image8& rgb, const Tile& tile, image::Image8* mask) {
  const int width = config_.input_width, height = config_.input_height;
  network::Tensor input({1, 3, height, width});
  const size_t n_pixels = static_cast<size_t>(width) * static_cast<size_t>(height);
  for (size_t c = 0; c < 3; ++c) {
    const size_t from = config_.bgr ? 2 - c : c;
    for (int y = 0; y < height; ++y) {
      float* const row = input.values.data() + c * n_pixels + static_cast<size_t>(y) * static_cast<size_t>(width);
      // Photos that are smaller than the input are continued by their last pixels.
      const int photo_y = std::min(tile.y.begin + y, rgb.height - 1);
      for (int x = 0; x < width; ++x) {
        const double value = rgb.At(std::min(tile.x.begin + x, rgb.width - 1), photo_y)[from];
        row[x] = static_cast<float>((value * config_.scale - config_.mean[c]) / config_.std[c]);
      }
    }
  }
  const network::Tensor output = net_.Run(std::array{std::move(input)});
  if (std::any_of(output.values.begin(), output.values.end(), [](float value) { return !std::isfinite(value); })) {
    throw InputError(net_.file(), "gives numbers that are not finite",
                     "Check scale, mean and std of the configuration, and the export of the network");
  }
  const auto out_height = static_cast<size_t>(output.shape[2]), out_width = static_cast<size_t>(output.shape[3]);
  const size_t n_classes = config_.classes.size(), n_out = out_height * out_width;
  for (int y = tile.y.first; y < tile.y.end; ++y) {
    const size_t out_y = static_cast<size_t>(y - tile.y.begin) * out_height / static_cast<size_t>(height);
    for (int x = tile.x.first; x < tile.x.end; ++x) {
      const size_t out_x = static_cast<size_t>(x - tile.x.begin) * out_width / static_cast<size_t>(width);
      const float* const scores = output.values.data() + out_y * out_width + out_x;
      bool ignored = false;
      if (n_classes == 1) {
        ignored = static_cast<double>(scores[0]) >= config_.threshold;
      } else {
        size_t best = 0;
        for (size_t c = 1; c < n_classes; ++c) best = scores[c * n_out] > scores[best * n_out] ? c : best;
        ignored = config_.ignored[best] != 0;
      }
      if (ignored) *mask->At(x, y) = 0;
    }
  }
}

image::Image8 GrowIgnored(const image::Image8& mask, int radius) {
  SKYQUILT_CHECK(mask.channels == 1 && radius >= 0, "a mask has one channel");
  image::Image8 grown = mask;
  std::vector<int> ignored_before(static_cast<size_t>(mask.width) + 1, 0);  // of a row: pixels left of x
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      ignored_before[static_cast<size_t>(x) + 1] = ignored_before[static_cast<size_t>(x)] + (*mask.At(x, y) == 0 ? 1 : 0);
    }
    if (ignored_before.back() == 0) continue;
    for (int dy = -radius; dy <= radius; ++dy) {
      if (y + dy < 0 || y + dy >= mask.height) continue;
      const int reach = static_cast<int>(std::sqrt(static_cast<double>(radius * radius - dy * dy)));
      for (int x = 0; x < mask.width; ++x) {
        const auto low = static_cast<size_t>(std::max(0, x - reach)), high = static_cast<size_t>(std::min(mask.width, x + reach + 1));
        if (ignored_before[high] > ignored_before[low]) *grown.At(x, y + dy) = 0;
      }
    }
  }
  return grown;
}

}  // namespace skyquilt::masks
