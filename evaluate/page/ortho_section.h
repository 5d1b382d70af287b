// The section of the report on the orthophoto: where its colours come from, and how it compares with the true map of a simulated survey.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluate/ortho/ortho_scores.h"

namespace skyquilt::evaluate::page {

// A part of the map and of the truth, one pixel per cell; paths relative to the page.
struct OrthoPicture {
  std::string map, truth;
  int width_px = 0, height_px = 0;
  std::string what;
  double psnr_db = kNotMeasured;
};

// Throws base::InputError when a file cannot be written.
std::vector<OrthoPicture> WriteOrthoPictures(const std::vector<ortho::OrthoCrop>& crops, const std::filesystem::path& report_folder);
std::string OrthoSection(const ortho::OrthoScores& scores, const std::vector<OrthoPicture>& pictures);

}  // namespace skyquilt::evaluate::page
