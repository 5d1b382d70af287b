// The little of an ONNX file that OpenCV does not tell or cannot cope with: its inputs' names, and sizes left open.
// Works on the file's bytes (protobuf); no network is run here.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace skyquilt::metrics {

struct OnnxInput {
  std::string name;
  std::vector<int64_t> shape;  // 0: left open
};

// The inputs of the model's graph in order, weights excluded; empty if the bytes are no ONNX model.
std::vector<OnnxInput> OnnxInputs(std::string_view model);

// The model with the shapes of its inputs (weights excluded) set to `shape`. OpenCV 4.6 bakes the sizes it meets while loading into
// pooling layers, so that a network with open sizes gives NaN.
std::string WithInputShape(std::string_view model, const std::vector<int64_t>& shape);

}  // namespace skyquilt::metrics
