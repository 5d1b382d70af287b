#include "core/metrics/lpips.h"

#include <cmath>
#include <opencv2/dnn.hpp>

#include "core/base/file.h"
#include "core/metrics/check_shapes.h"

namespace skyquilt::metrics {
namespace {

using base::InputError;

constexpr const char* kMend = "Give a network with two inputs of 1 x 3 x H x W and one output of one number, or leave LPIPS out";

// [0,1] interleaved to [-1,1] planar; 0, mid-grey, where ignored or not a number.
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
  std::vector<std::string> inputs;
  cv::dnn::Net net;
};

Lpips::Lpips(const std::filesystem::path& onnx_file) : impl_(std::make_unique<Impl>()) {
  impl_->file = onnx_file;
  const std::string bytes = base::ReadFile(onnx_file);
  impl_->inputs = OnnxInputNames(bytes);
  if (impl_->inputs.empty()) throw InputError(onnx_file, "is not an ONNX network", kMend);
  if (impl_->inputs.size() != 2) throw InputError(onnx_file, "is a network with " + std::to_string(impl_->inputs.size()) + " inputs", kMend);
  try {
    impl_->net = cv::dnn::readNetFromONNX(bytes.data(), bytes.size());
    impl_->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    impl_->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
  } catch (const cv::Exception& error) {
    throw InputError(onnx_file, "cannot be loaded (" + error.err + ")", kMend);
  }
  if (impl_->net.empty()) throw InputError(onnx_file, "cannot be loaded", kMend);
  const size_t n_outputs = impl_->net.getUnconnectedOutLayers().size();
  if (n_outputs != 1) throw InputError(onnx_file, "is a network with " + std::to_string(n_outputs) + " outputs", kMend);
}

Lpips::~Lpips() = default;
Lpips::Lpips(Lpips&&) noexcept = default;

double Lpips::Distance(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask) {
  CheckShapes(a, b, mask);
  SKYQUILT_CHECK(a.channels == 3 && !a.Empty(), "LPIPS compares RGB images, not " + ShapeText(a));
  cv::Mat result;
  try {
    impl_->net.setInput(ToBlob(a, mask), impl_->inputs[0]);
    impl_->net.setInput(ToBlob(b, mask), impl_->inputs[1]);
    result = impl_->net.forward();
  } catch (const cv::Exception& error) {
    throw InputError(impl_->file, "does not run on images of " + ShapeText(a) + " (" + error.err + ")", kMend);
  }
  if (result.total() != 1 || result.type() != CV_32F) throw InputError(impl_->file, "gives " + std::to_string(result.total()) + " numbers", kMend);
  return static_cast<double>(*result.ptr<float>());
}

}  // namespace skyquilt::metrics
