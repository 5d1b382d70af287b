// Reads a cloud that LasWriter wrote.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "core/base/memory_map.h"

namespace skyquilt::surface {

class LasPart {
 public:
  // Where a point's record of format 7 (LAS 1.4 R15) has what; x, y, z are whole numbers of `scale` from `offset`, 4 bytes each, from 0 on.
  static constexpr size_t kRecordBytes = 36, kClassAt = 16, kUserDataAt = 17, kColorAt = 30;

  // fix: how to make the file again. Throws base::InputError for another file or a damaged one.
  LasPart(const std::filesystem::path& file, const char* fix);

  const std::filesystem::path& file() const { return file_; }
  size_t count() const { return count_; }
  const Eigen::Vector3d& scale() const { return scale_; }
  const Eigen::Vector3d& offset() const { return offset_; }
  // All before the first point, `n` points, and all behind the last.
  std::span<const uint8_t> Head() const { return map_.bytes().first(begin_); }
  std::span<const uint8_t> Points(size_t first, size_t n) const { return map_.bytes().subspan(begin_ + first * kRecordBytes, n * kRecordBytes); }
  std::span<const uint8_t> Tail() const { return map_.bytes().subspan(begin_ + count_ * kRecordBytes); }
  // Of a point's bytes, in map coordinates.
  Eigen::Vector3d PositionOf(std::span<const uint8_t> point) const;
  void ReleasePages() const { map_.ReleasePages(); }

 private:
  std::filesystem::path file_;
  base::MemoryMap map_;
  size_t begin_ = 0, count_ = 0;
  Eigen::Vector3d scale_, offset_;
};

// cloud.las of the folder, or cloud_1.las, cloud_2.las, ...; none when there is no cloud.
std::vector<std::filesystem::path> CloudFiles(const std::filesystem::path& folder);

}  // namespace skyquilt::surface
