#include "core/metrics/lpips.h"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/metrics/check_shapes.h"
#include "core/network/onnx_network.h"

namespace skyquilt::metrics {
namespace {

using base::InputError;

constexpr const char* kFix = "Give a network with two inputs of 1 x 3 x H x W and one output of one number, or leave LPIPS out";

// Interleaved values in [0,1] to planar values in [-1,1]; 0 (mid-grey) where ignored or not finite.
network::Tensor ToTensor(const image::ImageF& image, const image::Image8* mask) {
  network::Tensor tensor({1, 3, image.height, image.width});
  const size_t n_pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  for (size_t c = 0; c < 3; ++c) {
    for (size_t i = 0; i < n_pixels; ++i) {
      const float value = image.data[3 * i + c];
      if ((mask == nullptr || mask->data[i] != 0) && std::isfinite(value)) tensor.values[c * n_pixels + i] = 2.0F * value - 1.0F;
    }
  }
  return tensor;
}

}  // namespace

struct Lpips::Impl {
  explicit Impl(const std::filesystem::path& file) : net(file, kFix) {}
  network::OnnxNetwork net;
};

Lpips::Lpips(const std::filesystem::path& onnx_file) : impl_(std::make_unique<Impl>(onnx_file)) {
  const std::vector<network::OnnxInput>& inputs = impl_->net.inputs();
  if (inputs.size() != 2) throw InputError(onnx_file, "is a network with " + std::to_string(inputs.size()) + " inputs", kFix);
  for (const network::OnnxInput& input : inputs) {
    const std::vector<int64_t>& shape = input.shape;
    if (shape.size() != 4 || shape[0] > 1 || (shape[1] != 0 && shape[1] != 3) || shape != inputs[0].shape) {
      throw InputError(onnx_file, "has an input '" + input.name + "' that is not 1 x 3 x H x W", kFix);
    }
  }
  // Tries the network now, so that an unusable file is refused before hours of training and not after.
  const std::vector<int64_t>& shape = inputs[0].shape;
  impl_->net.Load({1, 3, shape[2] > 0 ? shape[2] : 64, shape[3] > 0 ? shape[3] : 64});
  if (impl_->net.Outputs() != 1) throw InputError(onnx_file, "is a network with " + std::to_string(impl_->net.Outputs()) + " outputs", kFix);
}

Lpips::~Lpips() = default;
Lpips::Lpips(Lpips&&) noexcept = default;

double Lpips::Distance(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask) {
  CheckShapes(a, b, mask);
  SKYQUILT_CHECK(a.channels == 3 && !a.Empty(), "LPIPS compares RGB images, not " + ShapeText(a));
  network::OnnxNetwork& net = impl_->net;
  const std::vector<int64_t>& shape = net.inputs()[0].shape;
  if ((shape[2] != 0 && shape[2] != a.height) || (shape[3] != 0 && shape[3] != a.width)) {
    throw InputError(net.file(),
                     "takes only images of " + std::to_string(shape[3]) + "x" + std::to_string(shape[2]) + " (0: any), not " + ShapeText(a),
                     "Export the network with free height and width");
  }
  net.Load({1, 3, a.height, a.width});
  const network::Tensor result = net.Run(std::array{ToTensor(a, mask), ToTensor(b, mask)});
  if (result.values.size() != 1) throw InputError(net.file(), "gives " + std::to_string(result.values.size()) + " numbers instead of one", kFix);
  const auto distance = static_cast<double>(result.values.front());
  if (!std::isfinite(distance)) throw InputError(net.file(), "gives no finite number for images of " + ShapeText(a), kFix);
  return distance;
}

}  // namespace skyquilt::metrics
