#include "core/checkpoint/archive_array.h"

#include <algorithm>
#include <cstring>

#include "core/base/half.h"

namespace skyquilt::checkpoint {
namespace {

template <typename T>
std::vector<std::byte> BytesOf(const std::vector<T>& values) {
  std::vector<std::byte> bytes(values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

void KeepOnly(std::span<const uint8_t> keep, size_t group_bytes, std::vector<std::byte>* bytes) {
  size_t to = 0;
  for (size_t group = 0, from = 0; from < bytes->size(); ++group, from += group_bytes) {
    if (!IsStored(keep, static_cast<int64_t>(group))) continue;
    std::memmove(bytes->data() + to, bytes->data() + from, group_bytes);
    to += group_bytes;
  }
  bytes->resize(to);
}

}  // namespace

int64_t CountStored(std::span<const uint8_t> keep, int64_t groups) {
  int64_t count = 0;
  for (int64_t group = 0; group < groups; ++group) count += IsStored(keep, group) ? 1 : 0;
  return count;
}

std::vector<float> Spread(const std::vector<float>& kept, std::span<const uint8_t> keep, int64_t group, int64_t total) {
  std::vector<float> values(static_cast<size_t>(total), 0.0F);
  auto from = kept.begin();
  for (int64_t g = 0; g * group < total; ++g) {
    if (!IsStored(keep, g)) continue;
    std::copy_n(from, group, values.begin() + g * group);
    from += group;
  }
  return values;
}

ElementType ElementOf(const std::string& name) {
  for (const ElementType type : {ElementType::kFloat32, ElementType::kFloat64, ElementType::kInt64, ElementType::kBfloat16, ElementType::kFloat16}) {
    if (ElementName(type) == name) return type;
  }
  return ElementType::kUint8;
}

bool IsShortFloat(ElementType type) {
  return type == ElementType::kBfloat16 || type == ElementType::kFloat16;
}

ElementType StoredAs(ElementType type, Precision precision) {
  if (type != ElementType::kFloat32 || precision == Precision::kFloat32) return type;
  return precision == Precision::kBfloat16 ? ElementType::kBfloat16 : ElementType::kFloat16;
}

std::vector<std::byte> AsStored(const ArchiveReader& reader, const std::string& name, ElementType type) {
  switch (type) {
    case ElementType::kFloat64:
      return BytesOf(reader.Doubles(name));
    case ElementType::kUint8:
      return BytesOf(reader.Bytes(name));
    case ElementType::kInt64:
      return BytesOf(reader.Ints(name));
    case ElementType::kFloat32:
      return BytesOf(reader.Floats(name));
    case ElementType::kBfloat16:
    case ElementType::kFloat16:
      break;
  }
  const std::vector<float> values = reader.Floats(name);
  std::vector<uint16_t> stored;
  stored.reserve(values.size());
  for (const float value : values) {
    stored.push_back(type == ElementType::kBfloat16 ? base::Bfloat16FromFloat(value) : base::Float16FromFloat(value));
  }
  return BytesOf(stored);
}

std::vector<float> FloatsOf(const std::vector<uint16_t>& stored, ElementType type) {
  std::vector<float> values;
  values.reserve(stored.size());
  for (const uint16_t bits : stored) values.push_back(type == ElementType::kBfloat16 ? base::FloatFromBfloat16(bits) : base::FloatFromFloat16(bits));
  return values;
}

const ArchiveReader& Copies::Reader(const std::filesystem::path& file) {
  if (!reader_ || file != file_) {
    reader_.reset();
    reader_ = std::make_unique<ArchiveReader>(file);
    file_ = file;
  }
  return *reader_;
}

const void* Copies::Data(const Array& array) {
  if (array.copied_from.empty()) return array.data;
  bytes_ = AsStored(Reader(array.copied_from), array.copied_array, array.type);
  if (array.group > 0) KeepOnly(array.keep, ElementBytes(array.type) * static_cast<size_t>(array.group), &bytes_);
  return bytes_.data();
}

}  // namespace skyquilt::checkpoint
