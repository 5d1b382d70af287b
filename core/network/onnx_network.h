// Networks that the user provides as ONNX files, run by OpenCV on the CPU: those of LPIPS and of segmentation. Inputs and outputs are floats.
// The only place that knows OpenCV's dnn module.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/network/onnx_model.h"

namespace skyquilt::network {

// Row-major: the last axis is the fastest.
struct Tensor {
  std::vector<int64_t> shape;
  std::vector<float> values;

  Tensor() = default;
  explicit Tensor(std::vector<int64_t> sizes, float value = 0.0F);
  int64_t Count() const;  // of values, by the shape
};

// Not thread-safe; each thread needs its own. Deterministic.
class OnnxNetwork {
 public:
  // Reads the file; `fix`: what messages advise, as in "Give a network with ...". Throws base::InputError when the file cannot be read or is not
  // ONNX.
  OnnxNetwork(std::filesystem::path file, std::string fix);
  ~OnnxNetwork();
  OnnxNetwork(OnnxNetwork&&) noexcept;

  const std::filesystem::path& file() const;
  const std::vector<OnnxInput>& inputs() const;
  // FNV-1a hash of the file's bytes, 16 hexadecimal digits.
  std::string Digest() const;

  // Loads the network for inputs of this shape, 1 x C x H x W, unless that was done last; takes long. Throws base::InputError when OpenCV has no such
  // layers or they do not fit.
  void Load(const std::vector<int64_t>& shape);
  // Only after Load.
  size_t Outputs() const;
  // Feeds one tensor per input, all of the shape of Load, and returns the first output. Throws base::InputError when the network fails or its output
  // is not made of floats. Values may be infinite or NaN.
  Tensor Run(std::span<const Tensor> inputs);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// While it lives, every OpenCV function of the process uses the calling thread alone: for loops that run one network per thread. One at a time.
class OneThreadPerNetwork {
 public:
  OneThreadPerNetwork();
  ~OneThreadPerNetwork();
  OneThreadPerNetwork(const OneThreadPerNetwork&) = delete;
  OneThreadPerNetwork& operator=(const OneThreadPerNetwork&) = delete;

 private:
  int before_;
};

}  // namespace skyquilt::network
