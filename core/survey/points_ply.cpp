#include "core/survey/points_ply.h"

#include <bit>
#include <cstring>
#include <string>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/memory_map.h"

namespace skyquilt::survey {
namespace {

static_assert(std::endian::native == std::endian::little);
constexpr size_t kRecordBytes = 3 * 8 + 3 + 4 + 4;
constexpr std::string_view kBefore = "ply\nformat binary_little_endian 1.0\ncomment metres, local east north up (see survey.json)\nelement vertex ";
constexpr std::string_view kAfter =
    "\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
    "property float error\nproperty int track\nend_header\n";

}  // namespace

void WritePointsPly(const std::vector<SparsePoint>& points, const std::filesystem::path& file) {
  std::string content(kBefore);
  content += std::to_string(points.size());
  content += kAfter;
  size_t at = content.size();
  content.resize(at + points.size() * kRecordBytes);
  const auto put = [&content, &at](const void* value, size_t n_bytes) {
    std::memcpy(content.data() + at, value, n_bytes);
    at += n_bytes;
  };
  for (const SparsePoint& point : points) {
    put(point.x_in_enu.data(), 24);
    put(point.rgb.data(), 3);
    put(&point.error_px, 4);
    const auto track = static_cast<int32_t>(point.track_length);
    put(&track, 4);
  }
  base::WriteFileAtomically(file, content);
}

std::vector<SparsePoint> ReadPointsPly(const std::filesystem::path& file) {
  const base::MemoryMap map(file);
  const std::string_view content(reinterpret_cast<const char*>(map.bytes().data()), map.bytes().size());
  const std::string fix = "Run 'skyquilt prepare' again";
  const size_t header_end = content.substr(0, 1024).find(kAfter);
  if (!content.starts_with(kBefore) || header_end == std::string_view::npos || header_end - kBefore.size() > 12) {
    throw base::InputError(file, "is not a file of sparse points written by prepare", fix);
  }
  size_t n_points = 0;
  for (const char digit : content.substr(kBefore.size(), header_end - kBefore.size())) {
    if (digit < '0' || digit > '9') throw base::InputError(file, "has a damaged header", fix);
    n_points = n_points * 10 + static_cast<size_t>(digit - '0');
  }
  const std::string_view body = content.substr(header_end + kAfter.size());
  if (body.size() != n_points * kRecordBytes) {
    throw base::InputError(
        file, "has " + std::to_string(body.size()) + " bytes of points, but its header says " + std::to_string(n_points * kRecordBytes), fix);
  }
  std::vector<SparsePoint> points(n_points);
  const char* at = body.data();
  const auto get = [&at](void* value, size_t n_bytes) {
    std::memcpy(value, at, n_bytes);
    at += n_bytes;
  };
  for (SparsePoint& point : points) {
    get(point.x_in_enu.data(), 24);
    get(point.rgb.data(), 3);
    get(&point.error_px, 4);
    int32_t track = 0;
    get(&track, 4);
    point.track_length = track;
    if (!point.x_in_enu.allFinite()) throw base::InputError(file, "has a point with NaN or infinity in its coordinates", fix);
  }
  return points;
}

}  // namespace skyquilt::survey
