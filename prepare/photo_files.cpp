#include "prepare/photo_files.h"

#include <algorithm>
#include <cmath>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/memory_map.h"
#include "core/base/progress.h"
#include "core/base/text.h"
#include "core/image/image.h"
#include "core/image/jpeg_structure.h"

namespace skyquilt::prepare {
namespace {

namespace fs = std::filesystem;

bool IsHidden(const fs::path& path) {
  return path.filename().string().starts_with(".");
}

// A cut-off JPEG still has a good header: only the end of the data tells whether it is complete.
void CheckComplete(const fs::path& file) {
  const base::MemoryMap map(file);
  const image::JpegStructure structure = image::ParseJpeg(map.bytes(), false);
  // Some programs leave out the end marker; then the decoder tells whether rows are missing.
  if (structure.is_jpeg && !structure.complete) image::LoadRgb8(file);
}

}  // namespace

bool LooksLikePhoto(const fs::path& file) {
  if (IsHidden(file)) return false;
  const std::string extension = base::LowerCase(file.extension().string());
  return extension == ".jpg" || extension == ".jpeg" || extension == ".png" || extension == ".tif" || extension == ".tiff";
}

std::vector<std::string> ListPhotos(const fs::path& root, const std::vector<fs::path>& skip) {
  std::vector<std::string> names;
  std::error_code error;
  auto entry = fs::recursive_directory_iterator(root, fs::directory_options::follow_directory_symlink, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    if (entry.depth() > 32)
      throw base::InputError(root, "has folders nested deeper than 32 levels",
                             "Remove the link to a parent folder that causes this, or give a folder further down");
    std::error_code ignored;
    if (entry->is_directory(ignored)) {
      const bool skipped =
          std::any_of(skip.begin(), skip.end(), [&](const fs::path& folder) { return fs::equivalent(entry->path(), folder, ignored); });
      if (skipped || IsHidden(entry->path())) entry.disable_recursion_pending();
    } else if (entry->is_regular_file(ignored) && LooksLikePhoto(entry->path())) {
      names.push_back(entry->path().lexically_relative(root).generic_string());
    }
  }
  if (error) throw base::InputError(root, "cannot be listed: " + error.message(), "Check permissions");
  if (names.empty()) throw base::InputError(root, "has no photos (.jpg, .jpeg, .png, .tif, .tiff)", "Give the folder that holds the photos");
  std::sort(names.begin(), names.end());
  return names;
}

PhotoSet ReadPhotos(const fs::path& root, const std::vector<std::string>& names, base::ThreadPool& threads) {
  std::vector<PhotoFile> files(names.size());
  std::vector<std::string> problems(names.size());
  base::Progress progress("read photo tags", static_cast<double>(names.size()), "photos");
  threads.ParallelFor(static_cast<int64_t>(names.size()), [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    const auto i = static_cast<size_t>(task);
    const fs::path file = root / names[i];
    files[i].name = names[i];
    try {
      if (fs::file_size(file) == 0) throw base::InputError(file, "is empty", "Copy the photo again or remove it from the folder");
      image::ReadImageSize(file, &files[i].width, &files[i].height);
      CheckComplete(file);
      files[i].tags = survey::ReadPhotoTags(file);
    } catch (const base::InputError& error) {
      problems[i] = error.what();
    } catch (const fs::filesystem_error& error) {
      problems[i] = error.what();
    }
    progress.Advance();
  });
  progress.Finish();

  PhotoSet set;
  for (size_t i = 0; i < names.size(); ++i) {
    if (problems[i].empty()) {
      set.usable.push_back(std::move(files[i]));
    } else {
      base::LogWarning("photo left out: {}", problems[i]);
      set.unreadable.push_back(names[i]);
    }
  }
  if (set.usable.size() < kMinPhotos) {
    std::string found = "only " + std::to_string(set.usable.size()) + " of " + std::to_string(names.size()) + " photos can be used, at least " +
                        std::to_string(kMinPhotos) + " are needed";
    const auto first = std::find_if(problems.begin(), problems.end(), [](const std::string& problem) { return !problem.empty(); });
    if (first != problems.end()) found += " (first problem: " + *first + ")";
    throw base::InputError(root, found, "Copy the photos again or give another folder");
  }
  return set;
}

std::vector<std::string> FindMasks(const fs::path& masks, const std::vector<PhotoFile>& photos) {
  std::vector<std::string> found(photos.size());
  if (masks.empty()) return found;
  size_t n_found = 0;
  for (size_t i = 0; i < photos.size(); ++i) {
    const fs::path mask = masks / (photos[i].name + ".png");
    if (!fs::exists(mask)) continue;
    int width = 0;
    int height = 0;
    image::ReadImageSize(mask, &width, &height);
    if (width != photos[i].width || height != photos[i].height) {
      throw base::InputError(mask,
                             "is " + std::to_string(width) + "x" + std::to_string(height) + " pixels, its photo " + std::to_string(photos[i].width) +
                                 "x" + std::to_string(photos[i].height),
                             "Make every mask the same size as its photo");
    }
    found[i] = mask.string();
    ++n_found;
  }
  if (n_found == 0) throw base::InputError(masks, "has no mask for any photo", "Name masks like " + photos.front().name + ".png");
  base::LogInfo("masks: {} of {} photos have one in {}", n_found, photos.size(), masks.string());
  return found;
}

}  // namespace skyquilt::prepare
