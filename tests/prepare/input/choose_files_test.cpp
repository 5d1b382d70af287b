// Properties of the list for files with any names.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <set>

#include "core/base/random.h"
#include "core/image/develop.h"
#include "prepare/input/file_names.h"
#include "prepare/input/glob.h"
#include "prepare/input/list_files.h"

namespace skyquilt::prepare::input {
namespace {

struct MadeFile {
  FoundFile found;
  PictureHeader header;
};

// Files with parts of names that mean something, in folders that do.
std::vector<MadeFile> MakeFiles(base::Random& random) {
  static const std::vector<std::string> stems = {"DJI_0001", "DJI_0002", "IMG_0001", "a", "mask", "._a", "orthophoto", "IRX_0001", "MAX_0001"};
  static const std::vector<std::string> endings = {"", "", "_T", "_W", "_MS_G", "_MS_NIR", "_1", "_2", "_3", "_D", "_mask", "_thumb", ".jpg", "_RED"};
  static const std::vector<std::string> extensions = {".jpg", ".JPG", ".tif", ".png", ".heic", ".dng", ".txt", ".mp4", ""};
  const auto one_of = [&random](const auto& list) { return list[random.Below(static_cast<uint32_t>(list.size()))]; };
  std::vector<MadeFile> files;
  std::set<std::string> names;
  const uint32_t n = random.Below(40);
  for (uint32_t i = 0; i < n; ++i) {
    MadeFile file;
    const uint32_t folder = random.Below(7);
    std::string in;
    if (folder == 1) in = "flight/";
    if (folder == 2) {
      in = "flight/masks/";
      file.found.in = FoundIn::kMaskFolder;
    }
    if (folder == 3) {
      in = "odm/";
      file.found.in = FoundIn::kResultFolder;
    }
    if (folder == 4) {
      in = "odm/images/";
      file.found.in = FoundIn::kProjectImages;
    }
    if (folder == 3 || folder == 4) {
      file.found.outer = "odm/";
      file.found.project = true;
    }
    if (folder == 5) file.found.in = FoundIn::kThumbnailFolder;
    if (file.found.in != FoundIn::kPlainFolder) file.found.why = "some reason";
    const std::string stem = one_of(stems), ending = one_of(endings), extension = one_of(extensions);
    file.found.name = in + stem + ending + extension;
    if (!names.insert(file.found.name).second) continue;
    file.header.channels = static_cast<int>(random.Below(5));
    file.header.width = random.Below(2) == 0 ? 640 : 4000;
    file.header.height = file.header.width == 640 ? 512 : 3000;
    files.push_back(file);
  }
  return files;
}

std::vector<InputFile> ChooseOf(const std::vector<MadeFile>& files, const std::vector<std::string>& patterns = {}) {
  std::vector<FoundFile> found;
  std::vector<PictureHeader> headers;
  for (const MadeFile& file : files) {
    found.push_back(file.found);
    headers.push_back(file.header);
  }
  return ChooseFiles(found, headers, patterns);
}

bool IsCovered(const InputFile& row, const FoundFile& file) {
  return row.name == file.name || (row.name.ends_with('/') && file.name.starts_with(row.name));
}

RC_GTEST_PROP(ChooseFiles, ListsEveryFileOnceAndNoOther, ()) {
  base::Random random(static_cast<uint64_t>(*rc::gen::inRange(0, 1'000'000)));
  const std::vector<MadeFile> files = MakeFiles(random);
  const std::vector<InputFile> rows = ChooseOf(files);
  std::set<std::string> names;
  for (const InputFile& row : rows) RC_ASSERT(names.insert(row.name).second);
  for (const MadeFile& file : files) {
    // By itself, or with its folder.
    const bool has_row = names.contains(file.found.name);
    const bool in_folder = file.found.project && names.contains(file.found.outer);
    RC_ASSERT((has_row || in_folder));
  }
  for (const InputFile& row : rows) {
    const bool covers = std::any_of(files.begin(), files.end(), [&row](const MadeFile& file) { return IsCovered(row, file.found); });
    RC_ASSERT(covers);
  }
}

RC_GTEST_PROP(ChooseFiles, SaysWhyAFileIsLeftOut, ()) {
  base::Random random(static_cast<uint64_t>(*rc::gen::inRange(0, 1'000'000)));
  for (const InputFile& row : ChooseOf(MakeFiles(random))) {
    const bool told = row.Taken() || !row.reason.empty();
    RC_ASSERT(told);
    const bool picture = GroupOf(row.name) == FileGroup::kPicture || image::NeedsDeveloping(row.name);
    if (row.Taken()) RC_ASSERT(picture);
  }
}

RC_GTEST_PROP(ChooseFiles, DoesNotDependOnTheOrderOfTheDisk, ()) {
  base::Random random(static_cast<uint64_t>(*rc::gen::inRange(0, 1'000'000)));
  std::vector<MadeFile> files = MakeFiles(random);
  const std::vector<InputFile> rows = ChooseOf(files);
  for (size_t i = files.size(); i > 1; --i) {
    const size_t other = random.Below(static_cast<uint32_t>(i));
    std::swap(files[i - 1], files[other]);
  }
  const std::vector<InputFile> again = ChooseOf(files);
  RC_ASSERT(rows.size() == again.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    RC_ASSERT(rows[i].name == again[i].name);
    RC_ASSERT(KindName(rows[i].kind) == KindName(again[i].kind));
    RC_ASSERT(rows[i].reason == again[i].reason);
    if (i > 0) RC_ASSERT(rows[i - 1].name < rows[i].name);
  }
}

RC_GTEST_PROP(ChooseFiles, PatternsTakeAllThatMatchesAndNothingElse, ()) {
  base::Random random(static_cast<uint64_t>(*rc::gen::inRange(0, 1'000'000)));
  const std::vector<MadeFile> files = MakeFiles(random);
  const std::vector<std::string> patterns = {random.Below(2) == 0 ? "*.jpg" : "odm/**", "DJI_*_T.*"};
  for (const InputFile& row : ChooseOf(files, patterns)) {
    const bool picture = GroupOf(row.name) == FileGroup::kPicture || image::NeedsDeveloping(row.name);
    const bool can_be = picture && row.kind != FileKind::kMask && row.kind != FileKind::kSystem;
    const bool expected = can_be && MatchesAny(patterns, row.name);
    RC_ASSERT(row.Taken() == expected);
  }
}

// A folder of photos from one camera loses none of them, whatever its numbers are.
RC_GTEST_PROP(ChooseFiles, PlainPhotosAreAllTaken, ()) {
  base::Random random(static_cast<uint64_t>(*rc::gen::inRange(0, 1'000'000)));
  std::vector<MadeFile> files;
  static const std::vector<std::string> prefixes = {"DJI_", "IMG_2023_", "strip1_", "DSC0"};
  const std::string prefix = prefixes[random.Below(4)];
  const int channels = random.Below(2) == 0 ? 1 : 3;
  const std::string extension = random.Below(2) == 0 ? ".JPG" : ".tif";
  const uint32_t n = 1 + random.Below(20);
  for (uint32_t i = 0; i < n; ++i) {
    MadeFile file;
    file.found.name = prefix + std::to_string(1 + i) + extension;
    file.header = {.format = PictureFormat::kJpeg, .width = 640, .height = 480, .channels = channels};
    files.push_back(file);
  }
  RC_ASSERT(TakenNames(ChooseOf(files)).size() == n);
}

}  // namespace
}  // namespace skyquilt::prepare::input
