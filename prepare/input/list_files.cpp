#include "prepare/input/list_files.h"

#include <algorithm>
#include <map>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/text.h"
#include "prepare/input/file_names.h"
#include "prepare/input/glob.h"
#include "prepare/input/input_table.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

// Reading them takes a few pages of each file.
std::vector<PictureHeader> ReadHeaders(const fs::path& root, const std::vector<FoundFile>& found, base::ThreadPool& threads) {
  std::vector<PictureHeader> headers(found.size());
  threads.ParallelFor(static_cast<int64_t>(found.size()), [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    const FoundFile& file = found[static_cast<size_t>(task)];
    if (file.in == FoundIn::kSystemFolder || GroupOf(file.name) != FileGroup::kPicture || !LooksLikePhoto(file.name)) return;
    headers[static_cast<size_t>(task)] = ReadPictureHeader(root / file.name);
  });
  return headers;
}

std::string FirstPictures(const std::vector<InputFile>& files) {
  std::vector<std::string> names;
  for (const InputFile& file : files) {
    if (names.size() == 3) break;
    if (GroupOf(file.name) == FileGroup::kPicture && file.kind != FileKind::kSystem) names.push_back(file.name);
  }
  return base::Join(names);
}

// Advice for files that nobody here reads, when they are all there is.
std::string AdviceForUnread(const std::vector<InputFile>& files) {
  std::map<FileGroup, size_t> counts;
  for (const InputFile& file : files) {
    if (file.kind == FileKind::kUnread) ++counts[GroupOf(file.name)];
  }
  if (counts.empty()) return "";
  return HowToConvert(std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; })->first);
}

[[noreturn]] void FailWithoutPhotos(const fs::path& root, const std::vector<InputFile>& files, const std::string& patterns) {
  const std::string others = LeftOutText(files);
  if (!patterns.empty()) {
    const std::string pictures = FirstPictures(files);
    throw base::InputError(
        root,
        "has no picture that prepare.photos = '" + patterns + "' chooses" +
            (pictures.empty() ? std::string("; it has none at all") : "; there are for instance " + pictures) +
            (others.empty() ? "" : " (" + others + ")"),
        "Write patterns for paths below that folder, such as *.JPG or flight1/*; upper and lower case differ before the extension");
  }
  const std::string advice = AdviceForUnread(files);
  throw base::InputError(root, "has no photos (.jpg, .png, .tif, .heic, .dng or other raw files)" + (others.empty() ? "" : "; left out: " + others),
                         !advice.empty()  ? advice
                         : others.empty() ? "Give the folder that holds the photos"
                                          : "Give the folder that holds the photos, or choose pictures with prepare.photos, for instance '*.TIF'");
}

}  // namespace

std::string KindName(FileKind kind) {
  switch (kind) {
    case FileKind::kPhoto:
      return "photo";
    case FileKind::kBand:
      return "band";
    case FileKind::kThermal:
      return "thermal";
    case FileKind::kOtherForm:
      return "other form";
    case FileKind::kMask:
      return "mask";
    case FileKind::kThumbnail:
      return "thumbnail";
    case FileKind::kMap:
      return "map";
    case FileKind::kProject:
      return "other project";
    case FileKind::kResult:
      return "result";
    case FileKind::kUnread:
      return "unread format";
    case FileKind::kSystem:
      return "hidden or system";
    case FileKind::kNoChoice:
      return "not chosen";
    case FileKind::kDamaged:
      return "damaged";
    case FileKind::kModel:
      return "camera model";
    case FileKind::kOther:
      break;
  }
  return "other file";
}

std::vector<InputFile> ListInput(const fs::path& root, const ListOptions& options, base::ThreadPool& threads) {
  const std::vector<std::string> patterns = options.patterns.empty() ? std::vector<std::string>() : ParsePatterns(options.patterns);
  const std::vector<FoundFile> found = WalkFolder(root, options.skip, options.masks);
  std::vector<InputFile> files = ChooseFiles(found, ReadHeaders(root, found, threads), patterns);
  if (std::none_of(files.begin(), files.end(), [](const InputFile& file) { return file.Taken(); })) FailWithoutPhotos(root, files, options.patterns);
  return files;
}

std::vector<std::string> TakenNames(const std::vector<InputFile>& files) {
  std::vector<std::string> names;
  for (const InputFile& file : files) {
    if (file.Taken()) names.push_back(file.name);
  }
  return names;
}

bool LooksLikePhoto(const fs::path& file) {
  return !IsHiddenName(file.filename().string()) && GroupOf(file.filename().string()) == FileGroup::kPicture;
}

}  // namespace skyquilt::prepare::input
