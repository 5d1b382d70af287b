#include "core/metrics/lpips.h"

#include <cmath>
#include <opencv2/dnn.hpp>
#include <string>
#include <vector>

#include "core/base/file.h"
#include "core/metrics/check_shapes.h"
#include "core/metrics/onnx_model.h"

namespace skyquilt::metrics {
namespace {

using base::InputError;

constexpr const char* kFix = "Give a network with two inputs of 1 x 3 x H x W and one output of one number, or leave LPIPS out";

// Interleaved values in [0,1] to planar values in [-1,1]; 0 (mid-grey) where ignored or not finite.
cv::Mat ToBlob(const image::ImageF& image, const image::Image8* mask) {
  const int shape[] = {1, 3, image.height, image.width};
  cv::Mat blob(4, shape, CV_32F, cv::Scalar(0.0));
  const size_t n_pixels = static_cast<size_t>(image.width) * static_cast<size_t>(image.height);
  auto* out = blob.ptr<float>();
  for (size_t c = 0; c < 3; ++c) {
    for (size_t i = 0; i < n_pixels; ++i) {
      const float value = image.data[3 * i + c];
      if ((mask == nullptr || mask->data[i] != 0) && std::isfinite(value)) out[c * n_pixels + i] = 2.0F * value - 1.0F;
    }
  }
  return blob;
}

}  // namespace

struct Lpips::Impl {
  std::filesystem::path file;
  std::string model;
  std::vector<OnnxInput> inputs;
  cv::dnn::Net net;
  int net_width = 0;
  int net_height = 0;

  // Loads the network for one image size, unless it is loaded already.
  void Load(int width, int height) {
    if (width == net_width && height == net_height) return;
    net_width = net_height = 0;
    try {
      const std::string sized = WithInputShape(model, {1, 3, height, width});
      net = cv::dnn::readNetFromONNX(sized.data(), sized.size());
      net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
      net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    } catch (const cv::Exception& error) {
      throw InputError(file, "cannot be loaded for images of " + std::to_string(width) + "x" + std::to_string(height) + " (" + error.err + ")", kFix);
    }
    if (net.empty()) throw InputError(file, "cannot be loaded", kFix);
    net_width = width;
    net_height = height;
  }
};

Lpips::Lpips(const std::filesystem::path& onnx_file) : impl_(std::make_unique<Impl>()) {
  impl_->file = onnx_file;
  impl_->model = base::ReadFile(onnx_file);
  impl_->inputs = OnnxInputs(impl_->model);
  if (impl_->inputs.empty()) throw InputError(onnx_file, "is not an ONNX network", kFix);
  if (impl_->inputs.size() != 2) throw InputError(onnx_file, "is a network with " + std::to_string(impl_->inputs.size()) + " inputs", kFix);
  for (const OnnxInput& input : impl_->inputs) {
    const std::vector<int64_t>& shape = input.shape;
    if (shape.size() != 4 || shape[0] > 1 || (shape[1] != 0 && shape[1] != 3) || shape != impl_->inputs[0].shape) {
      throw InputError(onnx_file, "has an input '" + input.name + "' that is not 1 x 3 x H x W", kFix);
    }
  }
  // Tries the network now, so that an unusable file is refused before hours of training and not after.
  const std::vector<int64_t>& shape = impl_->inputs[0].shape;
  impl_->Load(shape[3] > 0 ? static_cast<int>(shape[3]) : 64, shape[2] > 0 ? static_cast<int>(shape[2]) : 64);
  const size_t n_outputs = impl_->net.getUnconnectedOutLayers().size();
  if (n_outputs != 1) throw InputError(onnx_file, "is a network with " + std::to_string(n_outputs) + " outputs", kFix);
}

Lpips::~Lpips() = default;
Lpips::Lpips(Lpips&&) noexcept = default;

double Lpips::Distance(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask) {
  CheckShapes(a, b, mask);
  SKYQUILT_CHECK(a.channels == 3 && !a.Empty(), "LPIPS compares RGB images, not " + ShapeText(a));
  const std::vector<int64_t>& shape = impl_->inputs[0].shape;
  if ((shape[2] != 0 && shape[2] != a.height) || (shape[3] != 0 && shape[3] != a.width)) {
    throw InputError(impl_->file,
                     "takes only images of " + std::to_string(shape[3]) + "x" + std::to_string(shape[2]) + " (0: any), not " + ShapeText(a),
                     "Export the network with free height and width");
  }
  impl_->Load(a.width, a.height);
  cv::Mat result;
  try {
    impl_->net.setInput(ToBlob(a, mask), impl_->inputs[0].name);
    impl_->net.setInput(ToBlob(b, mask), impl_->inputs[1].name);
    result = impl_->net.forward();
  } catch (const cv::Exception& error) {
    throw InputError(impl_->file, "does not run on images of " + ShapeText(a) + " (" + error.err + ")", kFix);
  }
  if (result.total() != 1 || result.type() != CV_32F)
    throw InputError(impl_->file, "gives " + std::to_string(result.total()) + " numbers instead of one", kFix);
  const auto distance = static_cast<double>(*result.ptr<float>());
  if (!std::isfinite(distance)) throw InputError(impl_->file, "gives no finite number for images of " + ShapeText(a), kFix);
  return distance;
}

}  // namespace skyquilt::metrics
