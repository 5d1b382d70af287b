#include "prepare/input/input_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include "core/base/file.h"
#include "core/base/text.h"
#include "prepare/input/file_names.h"
#include "prepare/tables/csv_field.h"

namespace skyquilt::prepare::input {
namespace {

// One and several of a kind; empty for those that are not counted.
std::pair<std::string, std::string> WordsOf(FileKind kind) {
  switch (kind) {
    case FileKind::kBand:
      return {"single band", "single bands"};
    case FileKind::kThermal:
      return {"picture of heat", "pictures of heat"};
    case FileKind::kOtherForm:
      return {"other form of a photo", "other forms of photos"};
    case FileKind::kMask:
      return {"mask", "masks"};
    case FileKind::kThumbnail:
      return {"thumbnail", "thumbnails"};
    case FileKind::kMap:
      return {"map", "maps"};
    case FileKind::kProject:
      return {"folder of another project", "folders of other projects"};
    case FileKind::kResult:
      return {"folder of results", "folders of results"};
    case FileKind::kUnread:
      return {"file in a format that cannot be read", "files in formats that cannot be read"};
    case FileKind::kNoChoice:
      return {"picture that prepare.photos does not choose", "pictures that prepare.photos does not choose"};
    case FileKind::kDamaged:
      return {"damaged photo", "damaged photos"};
    case FileKind::kPhoto:
    case FileKind::kSystem:
    case FileKind::kModel:
    case FileKind::kOther:
      break;
  }
  return {};
}

const InputFile* FirstOf(const std::vector<InputFile>& files, FileKind kind) {
  const auto first = std::find_if(files.begin(), files.end(), [kind](const InputFile& file) { return file.kind == kind; });
  return first == files.end() ? nullptr : &*first;
}

}  // namespace

void WriteInputTable(const std::vector<InputFile>& files, const std::filesystem::path& file) {
  std::string text = "file,taken,kind,reason,shot,mask,width,height\n";
  for (const InputFile& one : files) {
    const auto pixels = [](int size) { return size > 0 ? std::to_string(size) : std::string(); };
    text += tables::CsvText(one.name) + (one.Taken() ? ",yes," : ",no,") + KindName(one.kind) + "," + tables::CsvText(one.reason) + "," +
            tables::CsvText(one.shot) + "," + tables::CsvText(one.mask) + "," + pixels(one.width) + "," + pixels(one.height) + "\n";
  }
  base::WriteFileAtomically(file, text);
}

std::string LeftOutText(const std::vector<InputFile>& files) {
  std::map<FileKind, size_t> counts;
  for (const InputFile& file : files) ++counts[file.kind];
  std::vector<std::string> parts;
  for (const auto& [kind, n] : counts) {
    const auto [one, several] = WordsOf(kind);
    if (!one.empty()) parts.push_back(std::to_string(n) + " " + (n == 1 ? one : several));
  }
  return base::Join(parts);
}

std::string SummaryText(const std::vector<InputFile>& files, const std::filesystem::path& table) {
  const auto n_taken = std::count_if(files.begin(), files.end(), [](const InputFile& file) { return file.Taken(); });
  const std::string left_out = LeftOutText(files);
  return fmt::format("input: {} photos are taken, {}; {} lists every file", n_taken,
                     left_out.empty() ? "nothing that could be one is left out" : "left out are " + left_out, table.string());
}

std::vector<std::string> InputWarnings(const std::filesystem::path& root, const std::vector<InputFile>& files) {
  std::vector<std::string> warnings;
  std::map<FileGroup, std::pair<size_t, std::string>> unread;
  for (const InputFile& file : files) {
    if (file.kind != FileKind::kUnread) continue;
    auto& [n, first] = unread[GroupOf(file.name)];
    if (n++ == 0) first = file.name;
  }
  warnings.reserve(unread.size());
  for (const auto& [group, count] : unread) {
    warnings.push_back(fmt::format("{}: {} {} are left out, because no program here reads them (for instance {}). {}", root.string(), count.first,
                                   GroupName(group), count.second, HowToConvert(group)));
  }
  const bool one_band = std::any_of(files.begin(), files.end(), [](const InputFile& file) {
    return file.Taken() && !file.reason.empty() && file.reason.starts_with("single band");
  });
  if (const InputFile* band = FirstOf(files, FileKind::kBand); band != nullptr && one_band) {
    warnings.push_back(
        fmt::format("{}: there are no photos in colour, so one spectral band is taken as photos and the others are left out (for instance "
                    "{}). Choose another with prepare.photos, for instance '*_NIR.TIF'",
                    root.string(), band->name));
  }
  std::vector<std::string> projects;
  for (const InputFile& file : files) {
    if (file.kind == FileKind::kProject) projects.push_back(file.name + " (" + file.reason + ")");
  }
  if (!projects.empty()) {
    const size_t n_named = std::min<size_t>(projects.size(), 3);
    warnings.push_back(fmt::format("{}: other projects are left out: {}{}. If photos are in one, give its folder, or choose them with prepare.photos",
                                   root.string(), base::Join(std::span(projects).first(n_named)), projects.size() > n_named ? ", ..." : ""));
  }
  return warnings;
}

}  // namespace skyquilt::prepare::input
