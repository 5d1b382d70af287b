#include "prepare/input/photo_files.h"

#include <algorithm>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/memory_map.h"
#include "core/base/progress.h"
#include "core/image/develop.h"
#include "core/image/image.h"
#include "core/image/jpeg_structure.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

// A cut-off JPEG still has a good header: only the end of the data tells whether it is complete.
void CheckComplete(const fs::path& file) {
  const base::MemoryMap map(file);
  const image::JpegStructure structure = image::ParseJpeg(map.bytes(), false);
  // Some programs leave out the end marker; then the decoder tells whether rows are missing.
  if (structure.is_jpeg && !structure.complete) image::LoadRgb8(file);
}

}  // namespace

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
      if (image::NeedsDeveloping(names[i])) {
        image::ReadDevelopedSize(file, &files[i].width, &files[i].height);
      } else {
        image::ReadImageSize(file, &files[i].width, &files[i].height);
        CheckComplete(file);
      }
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
    const auto first = std::find_if(problems.begin(), problems.end(), [](const std::string& problem) { return !problem.empty(); });
    if (first == problems.end()) {
      throw base::InputError(root, "has only " + std::to_string(names.size()) + " photos, at least " + std::to_string(kMinPhotos) + " are needed",
                             "Add photos that show the same place from elsewhere");
    }
    const std::string found = "only " + std::to_string(set.usable.size()) + " of " + std::to_string(names.size()) + " photos can be used, at least " +
                              std::to_string(kMinPhotos) + " are needed (first problem: " + *first + ")";
    throw base::InputError(root, found, "Copy the photos again or give another folder");
  }
  return set;
}

}  // namespace skyquilt::prepare::input
