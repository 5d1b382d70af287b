// The pose of a view as it is stored in files.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>
#include <type_traits>

#include "surface/views/depth_views.h"

namespace skyquilt::surface {

// Without gaps between the members, so that records can be compared byte by byte.
struct ViewRecord {
  int32_t photo = -1, width = 0, height = 0, unused = 0;
  double focal_px = 0.0, cx = 0.0, cy = 0.0;
  std::array<double, 4> rotation = {};  // w x y z
  std::array<double, 3> translation = {};
};
static_assert(sizeof(ViewRecord) == 96 && std::is_trivially_copyable_v<ViewRecord>);

inline ViewRecord RecordOf(const ViewPose& pose) {
  const Eigen::Quaterniond& q = pose.cam_from_enu.rotation;
  const Eigen::Vector3d& t = pose.cam_from_enu.translation;
  return {pose.photo, pose.width, pose.height, 0, pose.focal_px, pose.cx, pose.cy, {q.w(), q.x(), q.y(), q.z()}, {t.x(), t.y(), t.z()}};
}

// Nothing when the values make no camera.
inline std::optional<ViewPose> PoseOf(const ViewRecord& record) {
  constexpr int32_t kMaxSide = 1 << 22;
  if (record.photo < -1 || record.width < 1 || record.height < 1 || record.width > kMaxSide || record.height > kMaxSide) return std::nullopt;
  double sum = record.focal_px + record.cx + record.cy, norm = 0.0;
  for (const double value : record.rotation) norm += value * value;
  for (const double value : record.translation) sum += value;
  if (!std::isfinite(sum) || !(record.focal_px > 0.0) || !(std::abs(norm - 1.0) < 1e-3)) return std::nullopt;
  ViewPose pose;
  pose.photo = record.photo;
  pose.width = record.width;
  pose.height = record.height;
  pose.focal_px = record.focal_px;
  pose.cx = record.cx;
  pose.cy = record.cy;
  pose.cam_from_enu.rotation = Eigen::Quaterniond(record.rotation[0], record.rotation[1], record.rotation[2], record.rotation[3]);
  pose.cam_from_enu.translation = Eigen::Vector3d(record.translation[0], record.translation[1], record.translation[2]);
  return pose;
}

// views.bin: this header, the records of all views, and the pictures: depths (float), then cosines and weights (bytes), padded with zeros to 8 bytes,
// then base::HashHex of all these bytes.
struct ViewsHeader {
  std::array<char, 8> magic = {'S', 'Q', 'V', 'I', 'E', 'W', 'S', '3'};
  std::array<char, 16> key = {};       // of what they were rendered from
  std::array<char, 16> checksum = {};  // base::HashHex of the records
  uint64_t views = 0;
};
static_assert(sizeof(ViewsHeader) == 48 && std::is_trivially_copyable_v<ViewsHeader>);

inline size_t PixelsOf(const ViewPose& pose) {
  return static_cast<size_t>(pose.width) * static_cast<size_t>(pose.height);
}
constexpr size_t kViewPixelBytes = sizeof(float) + 2;
inline size_t PictureBytes(const ViewPose& pose) {
  constexpr size_t kAlign = 8;
  return (PixelsOf(pose) * kViewPixelBytes + kAlign - 1) / kAlign * kAlign;
}
constexpr size_t kPictureHashBytes = 16;

}  // namespace skyquilt::surface
