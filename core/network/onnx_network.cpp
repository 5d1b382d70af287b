#include "core/network/onnx_network.h"

#include <algorithm>
#include <functional>
#include <numeric>
#include <opencv2/dnn.hpp>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::network {
namespace {

using base::InputError;

// "16x12" of 1 x C x 12 x 16.
std::string SizeText(const std::vector<int64_t>& shape) {
  return std::to_string(shape[3]) + "x" + std::to_string(shape[2]);
}

}  // namespace

Tensor::Tensor(std::vector<int64_t> sizes, float value) : shape(std::move(sizes)) {
  values.assign(static_cast<size_t>(Count()), value);
}

int64_t Tensor::Count() const {
  return std::accumulate(shape.begin(), shape.end(), int64_t{1}, std::multiplies<>());
}

struct OnnxNetwork::Impl {
  std::filesystem::path file;
  std::string fix;
  std::string model;
  std::vector<OnnxInput> inputs;
  cv::dnn::Net net;
  std::vector<int64_t> shape;  // that it is loaded for; empty: none
};

OnnxNetwork::OnnxNetwork(std::filesystem::path file, std::string fix) : impl_(std::make_unique<Impl>()) {
  impl_->file = std::move(file);
  impl_->fix = std::move(fix);
  impl_->model = base::ReadFile(impl_->file);
  impl_->inputs = OnnxInputs(impl_->model);
  if (impl_->inputs.empty()) throw InputError(impl_->file, "is not an ONNX network", impl_->fix);
}

OnnxNetwork::~OnnxNetwork() = default;
OnnxNetwork::OnnxNetwork(OnnxNetwork&&) noexcept = default;

const std::filesystem::path& OnnxNetwork::file() const {
  return impl_->file;
}

const std::vector<OnnxInput>& OnnxNetwork::inputs() const {
  return impl_->inputs;
}

std::string OnnxNetwork::Digest() const {
  return base::HashHex(impl_->model);
}

void OnnxNetwork::Load(const std::vector<int64_t>& shape) {
  SKYQUILT_CHECK(shape.size() == 4, "networks for images have inputs of 1 x C x H x W");
  if (shape == impl_->shape) return;
  impl_->shape.clear();
  try {
    const std::string sized = WithInputShape(impl_->model, shape);
    impl_->net = cv::dnn::readNetFromONNX(sized.data(), sized.size());
    impl_->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    impl_->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
  } catch (const cv::Exception& error) {
    throw InputError(impl_->file, "cannot be loaded for images of " + SizeText(shape) + " (" + error.err + ")", impl_->fix);
  }
  if (impl_->net.empty()) throw InputError(impl_->file, "cannot be loaded", impl_->fix);
  impl_->shape = shape;
}

size_t OnnxNetwork::Outputs() const {
  SKYQUILT_CHECK(!impl_->shape.empty(), "a network that is not loaded");
  return impl_->net.getUnconnectedOutLayers().size();
}

Tensor OnnxNetwork::Run(std::span<const Tensor> inputs) {
  SKYQUILT_CHECK(inputs.size() == impl_->inputs.size(), std::to_string(inputs.size()) + " inputs");
  cv::Mat result;
  try {
    for (size_t i = 0; i < inputs.size(); ++i) {
      SKYQUILT_CHECK(inputs[i].shape == impl_->shape, "an input of another shape than the network was loaded for");
      const std::vector<int> sizes(impl_->shape.begin(), impl_->shape.end());
      // OpenCV copies it.
      const cv::Mat blob(sizes, CV_32F, const_cast<float*>(inputs[i].values.data()));
      impl_->net.setInput(blob, impl_->inputs[i].name);
    }
    result = impl_->net.forward();
  } catch (const cv::Exception& error) {
    throw InputError(impl_->file, "does not run on images of " + SizeText(impl_->shape) + " (" + error.err + ")", impl_->fix);
  }
  if (result.type() != CV_32F || !result.isContinuous()) throw InputError(impl_->file, "gives an output that is not made of floats", impl_->fix);
  Tensor output;
  for (int axis = 0; axis < result.dims; ++axis) output.shape.push_back(result.size[axis]);
  const auto* const first = result.ptr<float>();
  output.values.assign(first, first + result.total());
  return output;
}

OneThreadPerNetwork::OneThreadPerNetwork() : before_(cv::getNumThreads()) {
  cv::setNumThreads(1);
}

OneThreadPerNetwork::~OneThreadPerNetwork() {
  cv::setNumThreads(before_);
}

}  // namespace skyquilt::network
