// Writes small ONNX networks, field by field.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace skyquilt::onnx {

// The few protobuf fields that an ONNX model needs.
inline std::string Varint(uint64_t value) {
  std::string bytes;
  for (; value >= 128; value >>= 7U) bytes.push_back(static_cast<char>(value | 0x80U));
  bytes.push_back(static_cast<char>(value));
  return bytes;
}
inline std::string Number(uint64_t field, uint64_t value) {
  return Varint(field << 3U) + Varint(value);
}
inline std::string Text(uint64_t field, const std::string& content) {
  return Varint(field << 3U | 2U) + Varint(content.size()) + content;
}

inline std::string Value(const std::string& name, const std::vector<int>& shape) {
  std::string dims;
  for (const int size : shape) dims += Text(1, size > 0 ? Number(1, static_cast<uint64_t>(size)) : Text(2, "free" + std::to_string(-size)));
  return Text(1, name) + Text(2, Text(1, Number(1, 1) + Text(2, dims)));
}
inline std::string Node(const std::string& type, const std::vector<std::string>& inputs, const std::string& output,
                        const std::string& attributes = "") {
  std::string node;
  for (const std::string& input : inputs) node += Text(1, input);
  return node + Text(2, output) + Text(3, "node_" + output) + Text(4, type) + attributes;
}

inline std::string Flag(const std::string& name, uint64_t value) {
  return Text(5, Text(1, name) + Number(3, value) + Number(20, 2));
}
inline std::string Axes(const std::vector<uint64_t>& axes) {
  std::string numbers;
  for (const uint64_t axis : axes) numbers += Number(8, axis);
  return Text(5, Text(1, "axes") + numbers + Number(20, 7));
}

inline std::string Whole(const std::string& name, const std::vector<uint64_t>& values) {
  std::string numbers;
  for (const uint64_t value : values) numbers += Number(8, value);
  return Text(5, Text(1, name) + numbers + Number(20, 7));
}

// Weights.
inline std::string Weights(const std::string& name, const std::vector<uint64_t>& shape, const std::vector<float>& values) {
  std::string dims, raw(values.size() * sizeof(float), '\0');
  for (const uint64_t size : shape) dims += Number(1, size);
  std::memcpy(raw.data(), values.data(), raw.size());
  return dims + Number(2, 1) + Text(8, name) + Text(9, raw);
}

inline std::string Model(const std::string& graph) {
  return Number(1, 7) + Text(8, Number(2, 11)) + Text(7, graph);
}

// A 1x1 convolution: 1 x 3 x height x width to 1 x classes x height x width (sizes below 1: free). per_class: weights of red, green and blue, then
// what is added.
inline std::string ColorModel(const std::vector<std::vector<float>>& per_class, int height, int width) {
  std::vector<float> weights, bias;
  for (const std::vector<float>& one : per_class) {
    weights.insert(weights.end(), one.begin(), one.begin() + 3);
    bias.push_back(one[3]);
  }
  const auto n = static_cast<uint64_t>(per_class.size());
  return Model(Text(1, Node("Conv", {"photo", "weights", "bias"}, "scores", Whole("kernel_shape", {1, 1}))) + Text(2, "graph") +
               Text(5, Weights("weights", {n, 3, 1, 1}, weights)) + Text(5, Weights("bias", {n}, bias)) +
               Text(11, Value("photo", {1, 3, height, width})) + Text(12, Value("scores", {1, static_cast<int>(n), height, width})));
}

}  // namespace skyquilt::onnx
