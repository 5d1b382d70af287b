#include "prepare/input/masks/mask_files.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>
#include <string>
#include <tuple>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/progress.h"
#include "prepare/input/picture_header.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

constexpr int kCompression = 1;

// Apart from what rounding of the smaller one's sides explains.
bool HaveOneShape(const Eigen::Vector2i& a, const Eigen::Vector2i& b) {
  const int64_t difference = int64_t{a.x()} * b.y() - int64_t{a.y()} * b.x();
  return std::abs(difference) <= std::max(a.maxCoeff(), b.maxCoeff());
}

// An image with a mask's meaning in any of three channels.
image::Image8 Threshold(const image::Image8& rgb) {
  image::Image8 mask(rgb.width, rgb.height, 1);
  for (size_t i = 0; i < mask.data.size(); ++i) {
    const uint8_t* pixel = rgb.data.data() + 3 * i;
    mask.data[i] = std::max({pixel[0], pixel[1], pixel[2]}) >= 128 ? 255 : 0;
  }
  return mask;
}

image::Image8 Nearest(const image::Image8& mask, int width, int height) {
  image::Image8 result(width, height, 1);
  for (int y = 0; y < height; ++y) {
    const auto from_y = static_cast<int>((2 * int64_t{y} + 1) * mask.height / (2 * int64_t{height}));
    for (int x = 0; x < width; ++x) {
      const auto from_x = static_cast<int>((2 * int64_t{x} + 1) * mask.width / (2 * int64_t{width}));
      *result.At(x, y) = *mask.At(from_x, from_y);
    }
  }
  return result;
}

bool HasContent(const fs::path& file, const std::string& content) {
  std::error_code error;
  return fs::file_size(file, error) == content.size() && !error && base::ReadFile(file) == content;
}

void RemoveOthers(const fs::path& folder, const std::set<fs::path>& keep) {
  std::vector<fs::path> others;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (!entry->is_directory() && !keep.contains(entry->path())) others.push_back(entry->path());
  }
  for (const fs::path& file : others) fs::remove(file, error);
}

}  // namespace

Eigen::Vector2i SizeOfMask(const fs::path& file, const PhotoFile& photo, bool shared) {
  Eigen::Vector2i size;
  image::ReadImageSize(file, &size.x(), &size.y());
  const Eigen::Vector2i stored(photo.width, photo.height);
  if (HaveOneShape(size, stored)) return size;
  if (shared) return Eigen::Vector2i::Zero();
  throw base::InputError(file,
                         "is " + std::to_string(size.x()) + "x" + std::to_string(size.y()) + " pixels, its photo " + photo.name + " " +
                             std::to_string(photo.width) + "x" + std::to_string(photo.height),
                         "Make every mask the size of its photo, or a scaled copy of that: neither turned nor cropped");
}

fs::path MaskFolderOf(const std::vector<MaskJob>& jobs) {
  fs::path folder;
  for (const MaskJob& job : jobs) {
    if (job.alpha) return {};
    if (job.file.empty()) continue;
    const std::string ending = "/" + job.photo->name + ".png", file = job.file.generic_string();
    if (!file.ends_with(ending) || job.size != Eigen::Vector2i(job.photo->width, job.photo->height)) return {};
    if (ReadPictureHeader(job.file).format != PictureFormat::kPng) return {};
    const fs::path in = file.substr(0, file.size() - ending.size());
    if (!folder.empty() && in != folder) return {};
    folder = in;
  }
  return folder;
}

fs::path WriteMasks(const fs::path& photo_root, const fs::path& folder, std::vector<MaskJob>& jobs, base::ThreadPool& threads) {
  // Photos with the same file and size have the same mask, which is made once.
  std::map<std::tuple<fs::path, int, int>, std::vector<MaskJob*>> by_mask;
  for (MaskJob& job : jobs) {
    if (job.alpha) by_mask[{photo_root / job.photo->name, 0, 0}].push_back(&job);
    if (!job.file.empty()) by_mask[{job.file, job.photo->width, job.photo->height}].push_back(&job);
  }
  std::vector<const std::vector<MaskJob*>*> groups;
  size_t n_photos = 0;
  for (const auto& [mask, group] : by_mask) {
    groups.push_back(&group);
    n_photos += group.size();
  }
  if (groups.empty()) {
    RemoveOthers(folder, {});
    return {};
  }
  base::RequireWritableFolder(folder);
  base::Progress progress("prepare masks", static_cast<double>(n_photos), "photos");
  threads.ParallelFor(static_cast<int64_t>(groups.size()), [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    const std::vector<MaskJob*>& group = *groups[static_cast<size_t>(task)];
    MaskJob& first = *group.front();
    const image::Image8 mask =
        first.alpha ? image::LoadAlphaMask(photo_root / first.photo->name) : LoadMaskAt(first.file, first.photo->width, first.photo->height);
    progress.Advance(static_cast<double>(group.size()));
    if (mask.Empty()) {
      first.alpha = false;
      return;
    }
    const std::string content = image::EncodePng(mask, kCompression);
    for (const MaskJob* job : group) {
      const fs::path file = folder / (job->photo->name + ".png");
      if (HasContent(file, content)) continue;
      fs::create_directories(file.parent_path());
      base::WriteFileAtomically(file, content);
    }
  });
  progress.Finish();
  std::set<fs::path> files;
  for (const MaskJob& job : jobs) {
    if (job.alpha || !job.file.empty()) files.insert(folder / (job.photo->name + ".png"));
  }
  RemoveOthers(folder, files);
  return files.empty() ? fs::path() : folder;
}

image::Image8 LoadMaskAt(const fs::path& file, int width, int height) {
  const bool jpeg = ReadPictureHeader(file).format == PictureFormat::kJpeg;
  image::Image8 mask = jpeg ? Threshold(image::LoadRgb8(file)) : image::LoadMask(file);
  return mask.width == width && mask.height == height ? mask : Nearest(mask, width, height);
}

}  // namespace skyquilt::prepare::input
