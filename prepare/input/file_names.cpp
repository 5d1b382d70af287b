#include "prepare/input/file_names.h"

#include <algorithm>
#include <initializer_list>
#include <set>
#include <string_view>

#include "core/base/text.h"

namespace skyquilt::prepare::input {
namespace {

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

// The rest of the stem before this ending; nothing when it has another, or nothing before it.
std::optional<std::string> Before(const std::string& stem, std::string_view ending) {
  if (stem.size() <= ending.size()) return std::nullopt;
  const size_t at = stem.size() - ending.size();
  if (base::LowerCase(stem.substr(at)) != ending) return std::nullopt;
  return stem.substr(0, at);
}

std::optional<ShotName> WithEnding(const std::string& stem, std::initializer_list<std::string_view> endings) {
  for (const std::string_view ending : endings) {
    if (const std::optional<std::string> shot = Before(stem, ending)) {
      return ShotName{*shot, std::string(ending.substr(ending.rfind('_') + 1))};
    }
  }
  return std::nullopt;
}

std::optional<ShotName> WithPrefix(const std::string& stem, std::string_view prefix, const std::string& camera) {
  if (stem.size() <= prefix.size() || base::LowerCase(stem.substr(0, prefix.size())) != prefix) return std::nullopt;
  return ShotName{stem.substr(prefix.size()), camera};
}

bool IsOneOf(const std::string& name, const std::set<std::string>& names) {
  return names.contains(base::LowerCase(name));
}

}  // namespace

FileGroup GroupOf(const std::string& name) {
  static const std::set<std::string> pictures = {".jpg", ".jpeg", ".png", ".tif", ".tiff"};
  static const std::set<std::string> heic = {".heic", ".heif", ".hif", ".avif"};
  static const std::set<std::string> raw = {".dng", ".cr2", ".cr3", ".crw", ".nef", ".nrw", ".arw", ".sr2",   ".raf", ".orf", ".rw2",
                                            ".pef", ".srw", ".x3f", ".3fr", ".iiq", ".gpr", ".raw", ".rjpeg", ".fff", ".erf", ".kdc"};
  static const std::set<std::string> videos = {".mp4",  ".mov", ".avi", ".mkv",  ".m4v", ".mts", ".m2ts",
                                               ".webm", ".lrv", ".lrf", ".insv", ".360", ".ts"};
  static const std::set<std::string> others = {".webp", ".bmp", ".gif", ".jp2", ".jpx", ".j2k", ".jxl",
                                               ".insp", ".psd", ".thm", ".jxr", ".ppm", ".exr"};
  const std::string extension = PartsOf(name).extension;
  if (IsOneOf(extension, pictures)) return FileGroup::kPicture;
  if (IsOneOf(extension, heic)) return FileGroup::kHeic;
  if (IsOneOf(extension, raw)) return FileGroup::kRaw;
  if (IsOneOf(extension, videos)) return FileGroup::kVideo;
  return IsOneOf(extension, others) ? FileGroup::kOtherPicture : FileGroup::kOther;
}

std::string GroupName(FileGroup group) {
  switch (group) {
    case FileGroup::kHeic:
      return "HEIC pictures";
    case FileGroup::kRaw:
      return "raw pictures";
    case FileGroup::kVideo:
      return "videos";
    case FileGroup::kOtherPicture:
      return "pictures of other formats";
    case FileGroup::kPicture:
    case FileGroup::kOther:
      break;
  }
  return "";
}

std::string HowToConvert(FileGroup group) {
  switch (group) {
    case FileGroup::kRaw:
      return "Of other raw formats than DNG, CR2, CR3, NEF, ARW, RAF, ORF, RW2, PEF and SRW none is read. Develop them to JPEG or TIFF with one "
             "setting for all, for instance with 'darktable-cli X.DNG X.jpg' or 'rawtherapee-cli -c FOLDER', "
             "which keep their tags";
    case FileGroup::kVideo:
      return "Frames are taken from videos that are given as such, 'skyquilt prepare X.MP4 -o DIR', or in a folder without photos";
    case FileGroup::kOtherPicture:
      return "Convert them to JPEG, PNG or TIFF, for instance with ImageMagick's 'convert'";
    case FileGroup::kPicture:
    case FileGroup::kHeic:
    case FileGroup::kOther:
      break;
  }
  return "";
}

NameParts PartsOf(const std::string& name) {
  const size_t slash = name.rfind('/');
  const size_t begin = slash == std::string::npos ? 0 : slash + 1;
  size_t dot = name.rfind('.');
  // A dot at the beginning hides a file.
  if (dot == std::string::npos || dot <= begin) dot = name.size();
  return {name.substr(0, begin), name.substr(begin, dot - begin), name.substr(dot)};
}

std::optional<ShotName> BandName(const std::string& stem) {
  return WithEnding(stem, {"_ms_g", "_ms_r", "_ms_re", "_ms_nir", "_ms_b", "_gre", "_red", "_reg", "_nir"});
}

std::optional<ShotName> NumberedBandName(const std::string& stem) {
  const size_t line = stem.rfind('_');
  if (line == std::string::npos || line == 0) return std::nullopt;
  const std::string number = stem.substr(line + 1);
  const std::string shot = base::LowerCase(stem.substr(0, line));
  if (shot.size() < 8 || !shot.starts_with("img_") || !std::all_of(shot.begin() + 4, shot.end(), IsDigit)) return std::nullopt;
  const bool small = number.size() == 1 || (number.size() == 2 && (number == "10" || number == "11" || number == "12"));
  if (!small || !std::all_of(number.begin(), number.end(), IsDigit) || number == "0") return std::nullopt;
  return ShotName{stem.substr(0, line), number};
}

std::optional<ShotName> ThermalName(const std::string& stem) {
  std::optional<ShotName> name = WithEnding(stem, {"_t", "_ir", "_thrm", "_thermal"});
  return name ? name : WithPrefix(stem, "irx_", "irx");
}

std::optional<ShotName> ColourName(const std::string& stem) {
  std::optional<ShotName> name = WithEnding(stem, {"_d", "_w", "_z", "_v", "_s"});
  if (name && IsDigit(name->shot.back())) return name;
  return WithPrefix(stem, "max_", "max");
}

std::string ShotOf(const std::string& stem) {
  for (const auto& part : {BandName(stem), ThermalName(stem), ColourName(stem)}) {
    if (part) return part->shot;
  }
  return stem;
}

bool IsThumbnailStem(const std::string& stem) {
  return WithPrefix(stem, "thumb_", "") || WithPrefix(stem, "synophoto_thumb", "") || Before(stem, "_thumb") || Before(stem, "_thumbnail");
}

bool IsSharedMaskStem(const std::string& stem) {
  return IsOneOf(stem, {"mask", "camera_mask"});
}

std::optional<std::string> MaskedStem(const std::string& stem) {
  return IsSharedMaskStem(stem) ? std::nullopt : Before(stem, "_mask");
}

bool IsMapStem(const std::string& stem) {
  return IsOneOf(stem, {"orthophoto", "odm_orthophoto", "orthomosaic", "ortho", "dsm", "dtm", "dem"});
}

bool IsHiddenName(const std::string& file_name) {
  return file_name.starts_with('.');
}

bool IsSystemFolder(const std::string& folder_name) {
  static const std::set<std::string> names = {"@eadir",   "@recycle",  "@tmp",       "@recently-snapshot",
                                              "#recycle", "#snapshot", "__macosx",   "$recycle.bin",
                                              "recycler", "recycled",  "lost+found", "system volume information"};
  return IsHiddenName(folder_name) || IsOneOf(folder_name, names);
}

bool IsThumbnailFolder(const std::string& folder_name) {
  return IsOneOf(folder_name, {"thumbs", "thumb", "thumbnails", "thumbnail"});
}

bool IsMaskFolder(const std::string& folder_name) {
  return IsOneOf(folder_name, {"masks", "mask"});
}

}  // namespace skyquilt::prepare::input
