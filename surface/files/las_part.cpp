#include "surface/files/las_part.h"

#include <cstring>
#include <string>

#include "core/base/errors.h"

namespace skyquilt::surface {
namespace {

// Of the header.
constexpr size_t kLasHeadBytes = 375, kMinorVersionAt = 25, kPointsAt = 96, kFormatAt = 104, kRecordBytesAt = 105, kScaleAt = 131;
constexpr size_t kOffsetAt = 155, kCountAt = 247;

template <typename T>
T LasValue(std::span<const uint8_t> bytes, size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

}  // namespace

LasPart::LasPart(const std::filesystem::path& file, const char* fix) : file_(file), map_(file) {
  const std::span<const uint8_t> bytes = map_.bytes();
  if (bytes.size() < kLasHeadBytes || std::memcmp(bytes.data(), "LASF", 4) != 0 || bytes[kMinorVersionAt] != 4 || bytes[kFormatAt] != 7 ||
      LasValue<uint16_t>(bytes, kRecordBytesAt) != kRecordBytes) {
    throw base::InputError(file, "is not a cloud of this program (LAS 1.4, point format 7)", fix);
  }
  begin_ = LasValue<uint32_t>(bytes, kPointsAt);
  const auto count = LasValue<uint64_t>(bytes, kCountAt);
  if (begin_ < kLasHeadBytes || begin_ > bytes.size() || count > (bytes.size() - begin_) / kRecordBytes) {
    throw base::InputError(file, "is damaged: its size does not agree with its header", fix);
  }
  count_ = static_cast<size_t>(count);
  for (size_t axis = 0; axis < 3; ++axis) {
    scale_[static_cast<Eigen::Index>(axis)] = LasValue<double>(bytes, kScaleAt + 8 * axis);
    offset_[static_cast<Eigen::Index>(axis)] = LasValue<double>(bytes, kOffsetAt + 8 * axis);
  }
}

Eigen::Vector3d LasPart::PositionOf(std::span<const uint8_t> point) const {
  const Eigen::Vector3d whole(LasValue<int32_t>(point, 0), LasValue<int32_t>(point, 4), LasValue<int32_t>(point, 8));
  return whole.cwiseProduct(scale_) + offset_;
}

std::vector<std::filesystem::path> CloudFiles(const std::filesystem::path& folder) {
  std::error_code ignored;
  const std::filesystem::path whole = folder / "cloud.las";
  if (std::filesystem::exists(whole, ignored)) return {whole};
  std::vector<std::filesystem::path> files;
  for (int part = 1;; ++part) {
    const std::filesystem::path file = folder / ("cloud_" + std::to_string(part) + ".las");
    if (!std::filesystem::exists(file, ignored)) return files;
    files.push_back(file);
  }
}

}  // namespace skyquilt::surface
