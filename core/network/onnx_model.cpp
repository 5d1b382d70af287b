#include "core/network/onnx_model.h"

#include <algorithm>
#include <optional>
#include <set>

namespace skyquilt::network {
namespace {

// Field numbers of onnx.proto.
constexpr uint64_t kModelGraph = 7;
constexpr uint64_t kGraphInitializer = 5;
constexpr uint64_t kGraphInput = 11;
constexpr uint64_t kTensorName = 8;
constexpr uint64_t kValueName = 1;
constexpr uint64_t kValueType = 2;
constexpr uint64_t kTypeTensor = 1;
constexpr uint64_t kTensorElementType = 1;
constexpr uint64_t kTensorShape = 2;
constexpr uint64_t kShapeDim = 1;
constexpr uint64_t kDimValue = 1;

struct Field {
  uint64_t number = 0;
  uint64_t value = 0;        // for varints
  std::string_view content;  // for length-delimited fields
  std::string_view raw;      // all bytes, with the key
};

// Walks the fields of one protobuf message; stops at the end or at the first malformed one.
class FieldReader {
 public:
  explicit FieldReader(std::string_view bytes) : rest_(bytes) {}

  std::optional<Field> Next() {
    const std::string_view start = rest_;
    std::optional<Field> field = Parse();
    if (!field) rest_ = start;
    return field;
  }
  // The bytes after the last complete field.
  std::string_view rest() const { return rest_; }

 private:
  std::optional<Field> Parse() {
    const std::string_view start = rest_;
    uint64_t key = 0;
    if (rest_.empty() || !Varint(&key)) return std::nullopt;
    Field field{key >> 3U, 0, {}, {}};
    uint64_t n_bytes = 0;
    switch (key & 7U) {
      case 0:
        if (!Varint(&field.value)) return std::nullopt;
        break;
      case 1:
        n_bytes = 8;
        break;
      case 2:
        if (!Varint(&n_bytes)) return std::nullopt;
        break;
      case 5:
        n_bytes = 4;
        break;
      default:
        return std::nullopt;
    }
    if (n_bytes > rest_.size()) return std::nullopt;
    if ((key & 7U) == 2) field.content = rest_.substr(0, n_bytes);
    rest_.remove_prefix(n_bytes);
    field.raw = start.substr(0, start.size() - rest_.size());
    return field;
  }

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

Field FieldOf(std::string_view message, uint64_t number) {
  FieldReader reader(message);
  while (const std::optional<Field> field = reader.Next()) {
    if (field->number == number) return *field;
  }
  return {};
}

std::string Varint(uint64_t value) {
  std::string bytes;
  for (; value >= 0x80U; value >>= 7U) bytes.push_back(static_cast<char>((value & 0x7FU) | 0x80U));
  bytes.push_back(static_cast<char>(value));
  return bytes;
}

std::string NumberField(uint64_t number, uint64_t value) {
  return Varint(number << 3U) + Varint(value);
}

std::string TextField(uint64_t number, std::string_view content) {
  std::string bytes = Varint(number << 3U | 2U) + Varint(content.size());
  bytes.append(content);
  return bytes;
}

// Older exporters list the weights among the inputs.
std::set<std::string_view> WeightNames(std::string_view graph) {
  std::set<std::string_view> names;
  FieldReader reader(graph);
  while (const std::optional<Field> field = reader.Next()) {
    if (field->number == kGraphInitializer) names.insert(FieldOf(field->content, kTensorName).content);
  }
  return names;
}

}  // namespace

std::vector<OnnxInput> OnnxInputs(std::string_view model) {
  const std::string_view graph = FieldOf(model, kModelGraph).content;
  const std::set<std::string_view> weights = WeightNames(graph);
  std::vector<OnnxInput> inputs;
  FieldReader reader(graph);
  while (const std::optional<Field> field = reader.Next()) {
    if (field->number != kGraphInput) continue;
    const std::string_view name = FieldOf(field->content, kValueName).content;
    if (weights.contains(name)) continue;
    OnnxInput input{std::string(name), {}};
    const std::string_view tensor = FieldOf(FieldOf(field->content, kValueType).content, kTypeTensor).content;
    FieldReader dims(FieldOf(tensor, kTensorShape).content);
    while (const std::optional<Field> dim = dims.Next()) {
      if (dim->number == kShapeDim) input.shape.push_back(std::max<int64_t>(0, static_cast<int64_t>(FieldOf(dim->content, kDimValue).value)));
    }
    inputs.push_back(std::move(input));
  }
  return inputs;
}

std::string WithInputShape(std::string_view model, const std::vector<int64_t>& shape) {
  const std::string_view graph = FieldOf(model, kModelGraph).content;
  const std::set<std::string_view> weights = WeightNames(graph);
  std::string dims;
  for (const int64_t size : shape) dims += TextField(kShapeDim, NumberField(kDimValue, static_cast<uint64_t>(size)));
  std::string new_graph;
  FieldReader graph_reader(graph);
  while (const std::optional<Field> field = graph_reader.Next()) {
    const std::string_view name = field->number == kGraphInput ? FieldOf(field->content, kValueName).content : std::string_view();
    if (field->number != kGraphInput || weights.contains(name)) {
      new_graph.append(field->raw);
      continue;
    }
    const std::string_view tensor = FieldOf(FieldOf(field->content, kValueType).content, kTypeTensor).content;
    const std::string new_tensor = NumberField(kTensorElementType, FieldOf(tensor, kTensorElementType).value) + TextField(kTensorShape, dims);
    new_graph += TextField(kGraphInput, TextField(kValueName, name) + TextField(kValueType, TextField(kTypeTensor, new_tensor)));
  }
  new_graph.append(graph_reader.rest());  // malformed: OpenCV refuses it
  std::string new_model;
  FieldReader model_reader(model);
  while (const std::optional<Field> field = model_reader.Next()) {
    if (field->number == kModelGraph) {
      new_model += TextField(kModelGraph, new_graph);
    } else {
      new_model.append(field->raw);
    }
  }
  new_model.append(model_reader.rest());
  return new_model;
}

}  // namespace skyquilt::network
