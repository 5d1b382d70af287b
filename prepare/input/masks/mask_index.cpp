#include "prepare/input/masks/mask_index.h"

#include <algorithm>
#include <array>

#include "core/base/text.h"
#include "prepare/input/file_names.h"

namespace skyquilt::prepare::input {
namespace {

constexpr std::array<const char*, 5> kMaskExtensions = {".png", ".jpg", ".jpeg", ".tif", ".tiff"};

// What the mask of sub/x.jpg may be called, the most certain first.
std::vector<std::string> MaskNames(const NameParts& photo, bool in_its_folder) {
  const std::string folder = in_its_folder ? photo.folder : "", stem = folder + photo.stem;
  std::vector<std::string> names;
  names.reserve(3 * kMaskExtensions.size());
  for (const char* extension : kMaskExtensions) names.push_back(stem + photo.extension + extension);
  for (const char* extension : kMaskExtensions) names.push_back(stem + "_mask" + extension);
  for (const char* extension : kMaskExtensions) names.push_back(stem + extension);
  return names;
}

// The name, and as if its images/ were not there: then masks/x.png is the mask of images/x.jpg.
std::vector<std::string> WaysToName(const std::string& photo) {
  std::vector<std::string> ways = {photo};
  const std::string between = "/" + photo;
  if (const size_t at = between.find("/images/"); at != std::string::npos) ways.push_back(photo.substr(0, at) + photo.substr(at + 7));
  return ways;
}

}  // namespace

MaskIndex::MaskIndex(const std::vector<std::string>& photos) {
  for (const std::string& photo : photos) ++photos_of_stem_[base::LowerCase(PartsOf(photo).stem)];
}

void MaskIndex::Add(const std::filesystem::path& file, const std::string& name, bool in_mask_folder) {
  const size_t mask = masks_.size();
  masks_.push_back({file, in_mask_folder});
  const std::string key = base::LowerCase(name);
  by_name_.emplace(key, mask);
  by_file_name_[key.substr(key.rfind('/') + 1)].push_back(mask);  // npos + 1 is 0
}

std::optional<size_t> MaskIndex::FindKey(const std::string& key) {
  const auto found = by_name_.find(key);
  if (found == by_name_.end()) return std::nullopt;
  masks_[found->second].fits = true;
  return found->second;
}

std::optional<size_t> MaskIndex::Find(const std::string& photo) {
  for (const std::string& way : WaysToName(base::LowerCase(photo))) {
    for (const std::string& name : MaskNames(PartsOf(way), true)) {
      if (const std::optional<size_t> mask = FindKey(name)) return mask;
    }
  }
  const NameParts parts = PartsOf(base::LowerCase(photo));
  const auto same = photos_of_stem_.find(parts.stem);
  if (same != photos_of_stem_.end() && same->second > 1) return std::nullopt;
  for (const std::string& name : MaskNames(parts, false)) {
    const auto found = by_file_name_.find(name);
    if (found == by_file_name_.end() || found->second.size() != 1 || !masks_[found->second.front()].in_mask_folder) continue;
    masks_[found->second.front()].fits = true;
    return found->second.front();
  }
  return std::nullopt;
}

std::optional<size_t> MaskIndex::FindShared(const std::string& photo) {
  for (const std::string& way : WaysToName(base::LowerCase(photo))) {
    for (std::string folder = PartsOf(way).folder;;) {
      for (const char* stem : {"mask", "camera_mask"}) {
        for (const char* extension : kMaskExtensions) {
          if (const std::optional<size_t> mask = FindKey(folder + stem + extension)) return mask;
        }
      }
      if (folder.empty()) break;
      folder.pop_back();
      for (const char* extension : kMaskExtensions) {
        if (const std::optional<size_t> mask = FindKey(folder + extension)) return mask;
      }
      folder = folder.substr(0, folder.rfind('/') + 1);
    }
  }
  if (!only_for_all_) only_for_all_ = masks_.size() == 1 && masks_.front().in_mask_folder && !HasNameOfPhoto(masks_.front());
  if (!*only_for_all_) return std::nullopt;
  masks_.front().fits = true;
  return 0;
}

bool MaskIndex::HasNameOfPhoto(const Mask& mask) const {
  if (mask.fits) return true;
  const std::string stem = base::LowerCase(mask.file.stem().string());
  return photos_of_stem_.contains(stem) || photos_of_stem_.contains(PartsOf(stem).stem) || photos_of_stem_.contains(MaskedStem(stem).value_or(stem));
}

std::vector<std::filesystem::path> MaskIndex::Unfit() const {
  std::vector<std::filesystem::path> files;
  for (const Mask& mask : masks_) {
    if (!mask.fits) files.push_back(mask.file);
  }
  return files;
}

bool MaskIndex::AnyFits() const {
  return std::any_of(masks_.begin(), masks_.end(), [](const Mask& mask) { return mask.fits; });
}

bool MaskIndex::AnyInMaskFolder() const {
  return std::any_of(masks_.begin(), masks_.end(), [](const Mask& mask) { return mask.in_mask_folder; });
}

}  // namespace skyquilt::prepare::input
