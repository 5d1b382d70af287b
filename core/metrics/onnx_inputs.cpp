#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/metrics/lpips.h"

namespace skyquilt::metrics {
namespace {

// Walks the fields of one protobuf message; stops at the first malformed one.
class FieldReader {
 public:
  explicit FieldReader(std::string_view bytes) : rest_(bytes) {}

  struct Field {
    uint64_t number = 0;
    std::string_view content;  // of length-delimited fields
  };

  std::optional<Field> Next() {
    uint64_t key = 0;
    if (rest_.empty() || !Varint(&key)) return std::nullopt;
    Field field{key >> 3U, {}};
    uint64_t skip = 0;
    switch (key & 7U) {
      case 0:
        if (!Varint(&skip)) return std::nullopt;
        return field;
      case 1:
        skip = 8;
        break;
      case 2:
        if (!Varint(&skip)) return std::nullopt;
        break;
      case 5:
        skip = 4;
        break;
      default:
        return std::nullopt;
    }
    if (skip > rest_.size()) return std::nullopt;
    if ((key & 7U) == 2) field.content = rest_.substr(0, skip);
    rest_.remove_prefix(skip);
    return field;
  }

 private:
  bool Varint(uint64_t* value) {
    *value = 0;
    for (unsigned shift = 0; shift < 64 && !rest_.empty(); shift += 7) {
      const auto byte = static_cast<uint8_t>(rest_.front());
      rest_.remove_prefix(1);
      *value |= static_cast<uint64_t>(byte & 0x7FU) << shift;
      if ((byte & 0x80U) == 0) return true;
    }
    return false;
  }

  std::string_view rest_;
};

std::string_view FieldOf(std::string_view message, uint64_t number) {
  FieldReader reader(message);
  while (const auto field = reader.Next()) {
    if (field->number == number) return field->content;
  }
  return {};
}

}  // namespace

// Field numbers from onnx.proto: ModelProto.graph 7, GraphProto.initializer 5 and input 11, TensorProto.name 8, ValueInfoProto.name 1.
std::vector<std::string> OnnxInputNames(const std::string& model_bytes) {
  const std::string_view graph = FieldOf(model_bytes, 7);
  std::vector<std::string> inputs;
  std::vector<std::string> weights;
  FieldReader reader(graph);
  while (const auto field = reader.Next()) {
    if (field->number == 11) inputs.emplace_back(FieldOf(field->content, 1));
    if (field->number == 5) weights.emplace_back(FieldOf(field->content, 8));
  }
  std::erase_if(inputs, [&](const std::string& name) { return std::find(weights.begin(), weights.end(), name) != weights.end(); });
  return inputs;
}

}  // namespace skyquilt::metrics
