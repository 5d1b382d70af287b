#include "surface/files/las_classes.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/memory_map.h"
#include "core/base/output_file.h"

namespace skyquilt::surface {
namespace {

constexpr const char* kMakeAgain = "Run 'skyquilt surface' with --restart and --set surface.cloud=true";
constexpr double kSame_m = 0.002;
constexpr size_t kBlockPoints = 1 << 16;

template <typename T>
T Get(std::span<const uint8_t> bytes, size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

// A cloud as LasWriter wrote it.
class LasPart {
 public:
  static constexpr size_t kRecordBytes = 36, kClassAt = 16;  // of a point of format 7 (LAS 1.4 R15)

  explicit LasPart(const std::filesystem::path& file) : file_(file), map_(file) {
    const std::span<const uint8_t> bytes = map_.bytes();
    if (bytes.size() < kHeadBytes || std::memcmp(bytes.data(), "LASF", 4) != 0 || bytes[kMinorVersionAt] != 4 || bytes[kFormatAt] != 7 ||
        Get<uint16_t>(bytes, kRecordBytesAt) != kRecordBytes) {
      throw base::InputError(file, "is not a cloud of this program (LAS 1.4, point format 7)", kMakeAgain);
    }
    begin_ = Get<uint32_t>(bytes, kPointsAt);
    const auto count = Get<uint64_t>(bytes, kCountAt);
    if (begin_ < kHeadBytes || begin_ > bytes.size() || count > (bytes.size() - begin_) / kRecordBytes) {
      throw base::InputError(file, "is damaged: its size does not agree with its header", kMakeAgain);
    }
    count_ = static_cast<size_t>(count);
    for (size_t axis = 0; axis < 3; ++axis) {
      scale_[static_cast<Eigen::Index>(axis)] = Get<double>(bytes, kScaleAt + 8 * axis);
      offset_[static_cast<Eigen::Index>(axis)] = Get<double>(bytes, kOffsetAt + 8 * axis);
    }
  }

  const std::filesystem::path& file() const { return file_; }
  size_t count() const { return count_; }
  std::span<const uint8_t> Head() const { return map_.bytes().first(begin_); }
  std::span<const uint8_t> Points(size_t first, size_t n) const { return map_.bytes().subspan(begin_ + first * kRecordBytes, n * kRecordBytes); }
  std::span<const uint8_t> Tail() const { return map_.bytes().subspan(begin_ + count_ * kRecordBytes); }
  // Of a point's bytes, in map coordinates.
  Eigen::Vector3d PositionOf(std::span<const uint8_t> point) const {
    const Eigen::Vector3d whole(Get<int32_t>(point, 0), Get<int32_t>(point, 4), Get<int32_t>(point, 8));
    return whole.cwiseProduct(scale_) + offset_;
  }
  void ReleasePages() const { map_.ReleasePages(); }

 private:
  // Of the header.
  static constexpr size_t kHeadBytes = 375, kMinorVersionAt = 25, kPointsAt = 96, kFormatAt = 104, kRecordBytesAt = 105, kScaleAt = 131;
  static constexpr size_t kOffsetAt = 155, kCountAt = 247;

  std::filesystem::path file_;
  base::MemoryMap map_;
  size_t begin_ = 0, count_ = 0;
  Eigen::Vector3d scale_, offset_;
};

std::vector<std::filesystem::path> CloudFiles(const std::filesystem::path& folder) {
  std::error_code ignored;
  const std::filesystem::path whole = folder / "cloud.las";
  if (std::filesystem::exists(whole, ignored)) return {whole};
  std::vector<std::filesystem::path> files;
  for (int part = 1;; ++part) {
    const std::filesystem::path file = folder / ("cloud_" + std::to_string(part) + ".las");
    if (!std::filesystem::exists(file, ignored)) break;
    files.push_back(file);
  }
  if (files.empty()) throw base::InputError(whole, "does not exist", kMakeAgain);
  return files;
}

[[noreturn]] void ThrowOtherCloud(const std::filesystem::path& file, const std::string& finding) {
  throw base::InputError(file, "is another cloud than that of the surface: " + finding, kMakeAgain);
}

// What of the positions the writer of the cloud wrote: it leaves out those that are not finite.
std::vector<size_t> WrittenPoints(std::span<const Eigen::Vector3d> positions) {
  std::vector<size_t> written;
  written.reserve(positions.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    if (positions[i].allFinite()) written.push_back(i);
  }
  return written;
}

}  // namespace

void RewriteLasClasses(const std::filesystem::path& folder, const MapFrame& frame, std::span<const Eigen::Vector3d> positions_enu,
                       std::span<const uint8_t> codes) {
  SKYQUILT_CHECK(positions_enu.size() == codes.size(), std::to_string(positions_enu.size()) + " points, " + std::to_string(codes.size()) + " codes");
  const std::vector<size_t> written = WrittenPoints(positions_enu);
  std::vector<std::unique_ptr<LasPart>> parts;
  size_t count = 0;
  for (const std::filesystem::path& file : CloudFiles(folder)) {
    parts.push_back(std::make_unique<LasPart>(file));
    count += parts.back()->count();
  }
  if (count != written.size()) {
    ThrowOtherCloud(parts.front()->file(), "it has " + std::to_string(count) + " points, the surface has " + std::to_string(written.size()));
  }

  std::vector<std::unique_ptr<base::OutputFile>> outputs;
  std::vector<uint8_t> block;
  size_t next = 0;  // in `written`
  for (const std::unique_ptr<LasPart>& part : parts) {
    base::OutputFile& output = *outputs.emplace_back(std::make_unique<base::OutputFile>(part->file()));
    output.Append(part->Head());
    for (size_t first = 0; first < part->count(); first += kBlockPoints) {
      base::ThrowIfCancelled();
      const size_t n = std::min(kBlockPoints, part->count() - first);
      const std::span<const uint8_t> old = part->Points(first, n);
      block.assign(old.begin(), old.end());
      for (size_t i = 0; i < n; ++i, ++next) {
        const Eigen::Vector3d expected = frame.MapFromEnu(positions_enu[written[next]]);
        const Eigen::Vector3d found = part->PositionOf(std::span<const uint8_t>(block).subspan(i * LasPart::kRecordBytes, LasPart::kRecordBytes));
        if (!((found - expected).cwiseAbs().maxCoeff() <= kSame_m)) {
          ThrowOtherCloud(part->file(), "point " + std::to_string(first + i) + " is at another place");
        }
        block[i * LasPart::kRecordBytes + LasPart::kClassAt] = codes[written[next]];
      }
      output.Append(block);
      part->ReleasePages();
    }
    output.Append(part->Tail());
    output.Complete();
  }
  for (const std::unique_ptr<base::OutputFile>& output : outputs) output->Publish();
}

}  // namespace skyquilt::surface
