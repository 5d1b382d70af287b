#include "evaluate/page/elevation_section.h"

#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/image/image.h"
#include "evaluate/page/page_parts.h"

namespace skyquilt::evaluate::page {

std::vector<ElevationPicture> CopyElevations(const std::filesystem::path& products_folder, const std::filesystem::path& report_folder) {
  std::vector<ElevationPicture> elevations;
  for (int i = 1;; ++i) {
    const std::string name = "elevation_" + std::to_string(i);
    const std::filesystem::path described = products_folder / (name + ".json");
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(described, ignored)) return elevations;
    try {
      const nlohmann::json json = base::ParseJson(base::ReadFile(described));
      const std::filesystem::path png = products_folder / (name + "_preview.png");
      ElevationPicture picture;
      picture.image = "images/" + name + ".png";
      picture.unit = json.at("unit").get<std::string>();
      picture.width = json.at("width").get<double>();
      picture.height = json.at("height").get<double>();
      picture.resolution = json.at("resolution").get<double>();
      picture.azimuth_deg = json.at("azimuth_deg").get<double>();
      image::ReadImageSize(png, &picture.width_px, &picture.height_px);
      std::filesystem::copy_file(png, report_folder / picture.image, std::filesystem::copy_options::overwrite_existing);
      elevations.push_back(picture);
    } catch (const std::exception& error) {
      base::LogWarning("the report is without {}: {}", name, error.what());
    }
  }
}

std::string ElevationSection(const std::vector<ElevationPicture>& elevations, bool georeferenced) {
  if (elevations.empty()) return "";
  std::string html =
      SectionBegin("elevations", "Elevations") +
      Lead(
          "The largest walls, seen straight on in one scale, as an orthophoto shows the ground. The full pictures, with how their pixels "
          "lie in space, are in <code>products/</code>.") +
      "<div class=\"views\">";
  for (size_t i = 0; i < elevations.size(); ++i) {
    const ElevationPicture& one = elevations[i];
    const std::string unit = one.unit == "m" ? "m" : "units of the reconstruction";
    html += fmt::format("<article class=\"card photo\"><header><h3>Wall {}</h3></header>", i + 1);
    html += Picture("elevation-pic", one.image, one.width_px, one.height_px,
                    fmt::format("{:.3g} by {:.3g} {}, {:.3g} a pixel; the wall looks to {:.0f} degrees{}", one.width, one.height, unit,
                                one.resolution, one.azimuth_deg, georeferenced ? " clockwise from north" : " of the local frame"));
    html += "</article>\n";
  }
  return html + "</div></section>\n";
}

}  // namespace skyquilt::evaluate::page
