// The section of the report with pixels that are ignored: by masks that stage "masks" made, and what moved between photos; how much it is, and photos
// on which it is shown.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/survey/compared_photos.h"
#include "core/survey/made_masks.h"

namespace skyquilt::evaluate::page {

struct MaskPicture {
  std::string photo;
  std::string image;  // relative to the page
  int width_px = 0, height_px = 0;
  double ignored = 0.0;  // share of the photo, 0..1
};

struct MasksReport {
  survey::MadeMasks masks;
  std::vector<MaskPicture> pictures;  // the most ignored photo first
  survey::ComparedPhotos compared;    // no photos: they were not compared
  std::vector<MaskPicture> compared_pictures;
};

// At most so many pictures of a kind, evenly chosen from the most to the least ignored photo.
constexpr size_t kMaskPictures = 6;

// Reads the tables of a project's survey and of its folder movers/ and copies pictures beside the page; those that are missing are left out. Without
// masks or comparison where none was made, or its table is damaged.
MasksReport CopyMasks(const std::filesystem::path& project_folder, const std::filesystem::path& report_folder);
// Empty without masks and comparison.
std::string MasksSection(const MasksReport& report);

}  // namespace skyquilt::evaluate::page
