// The section of the report with masks that stage "masks" made: how much they ignore, and photos on which they are shown.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

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
};

// At most so many pictures, evenly chosen from the most to the least ignored photo.
constexpr size_t kMaskPictures = 6;

// Reads the survey's table and copies pictures beside the page; those that are missing are left out. Empty when no masks were made, or the table is
// damaged.
MasksReport CopyMasks(const std::filesystem::path& survey_folder, const std::filesystem::path& report_folder);
// Empty without masks.
std::string MasksSection(const MasksReport& report);

}  // namespace skyquilt::evaluate::page
