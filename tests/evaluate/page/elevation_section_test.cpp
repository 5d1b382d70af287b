#include "evaluate/page/elevation_section.h"

#include <gtest/gtest.h>

#include "core/base/file.h"
#include "core/image/image.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::page {
namespace {

TEST(ElevationSection, ShowsWallsWithTheirScale) {
  const TemporaryFolder folder;
  const std::filesystem::path products = folder / "products", report = folder / "report";
  std::filesystem::create_directories(products);
  std::filesystem::create_directories(report / "images");
  EXPECT_TRUE(CopyElevations(products, report).empty());
  EXPECT_EQ(ElevationSection({}, true), "");
  const auto describe = [&](const std::string& name, const std::string& text) { base::WriteFileAtomically(products / (name + ".json"), text); };
  image::SavePng(image::Image8(40, 30, 3), products / "elevation_1_preview.png");
  image::SavePng(image::Image8(50, 20, 3), products / "elevation_3_preview.png");
  describe("elevation_1", R"({"unit": "m", "width": 24.5, "height": 9.25, "resolution": 0.01, "azimuth_deg": 180.2})");
  describe("elevation_2", "{}");
  describe("elevation_3", R"({"unit": "unit of the reconstruction", "width": 4, "height": 1, "resolution": 0.002, "azimuth_deg": 90})");
  const std::vector<ElevationPicture> found = CopyElevations(products, report);
  ASSERT_EQ(found.size(), 2U) << "the damaged one is left out";
  EXPECT_EQ(found[1].width_px, 50);
  EXPECT_TRUE(std::filesystem::exists(report / "images/elevation_3.png"));
  const std::string html = ElevationSection(found, false);
  EXPECT_NE(html.find("24.5 by 9.25 m, 0.01 a pixel; the wall looks to 180 degrees of the local frame"), std::string::npos) << html;
  EXPECT_NE(html.find("4 by 1 units of the reconstruction"), std::string::npos) << html;
  EXPECT_NE(html.find("images/elevation_3.png"), std::string::npos) << html;
}

}  // namespace
}  // namespace skyquilt::evaluate::page
