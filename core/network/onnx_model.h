// Reads and changes the inputs of an ONNX model, because OpenCV neither tells their names nor supports inputs of free size.
// Works on the bytes of the file (protobuf); no network is run here.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace skyquilt::network {

struct OnnxInput {
  std::string name;
  std::vector<int64_t> shape;  // 0: free size
};

// The inputs of the model's graph in order, without weights; empty when the bytes are not an ONNX model.
std::vector<OnnxInput> OnnxInputs(std::string_view model);

// The model with the shapes of its inputs (without weights) set to `shape`. OpenCV 4.6 fixes the sizes of pooling layers while loading, so a network
// with free sizes gives NaN.
std::string WithInputShape(std::string_view model, const std::vector<int64_t>& shape);

}  // namespace skyquilt::network
