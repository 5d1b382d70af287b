#include "surface/files/las_classes.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/output_file.h"
#include "surface/files/las_part.h"

namespace skyquilt::surface {
namespace {

constexpr const char* kMakeAgain = "Run 'skyquilt surface' with --restart and --set surface.cloud=true";
constexpr double kSame_m = 0.002;
constexpr size_t kBlockPoints = 1 << 16;

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
  const std::vector<std::filesystem::path> files = CloudFiles(folder);
  if (files.empty()) throw base::InputError(folder / "cloud.las", "does not exist", kMakeAgain);
  for (const std::filesystem::path& file : files) {
    parts.push_back(std::make_unique<LasPart>(file, kMakeAgain));
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
