// The section of the report with elevations, pictures straight on walls (docs/files.md, products/).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace skyquilt::evaluate::page {

struct ElevationPicture {
  std::string image;  // relative to the page
  int width_px = 0, height_px = 0;
  std::string unit;                                    // of the lengths
  double width = 0.0, height = 0.0, resolution = 0.0;  // of the wall's part that is drawn, and of a pixel of the full picture
  double azimuth_deg = 0.0;                            // to where the wall looks, clockwise from +y
};

// Copies the previews of the elevations of walls beside the page, in their order; those with missing or damaged files are left out.
std::vector<ElevationPicture> CopyElevations(const std::filesystem::path& products_folder, const std::filesystem::path& report_folder);
// Empty without elevations. georeferenced: whether directions are those of the compass.
std::string ElevationSection(const std::vector<ElevationPicture>& elevations, bool georeferenced);

}  // namespace skyquilt::evaluate::page
