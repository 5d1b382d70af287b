#include "evaluate/page/ortho_section.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::page {
namespace {

TEST(OrthoSection, ShowsFiguresThatAreKnownAndPicturesBesideTheTruth) {
  ortho::OrthoScores scores;
  scores.cells = 1234567;
  scores.cell_m = 0.05;
  const std::string plain = OrthoSection(scores, {});
  EXPECT_NE(plain.find("id=\"orthophoto\""), std::string::npos);
  EXPECT_EQ(plain.find("PSNR"), std::string::npos) << plain;
  EXPECT_EQ(plain.find("From photos"), std::string::npos) << plain;

  scores.share_photos = 0.93;
  scores.share_field = 0.07;
  scores.photos_in_use = 41;
  scores.cells_compared = 1000000;
  scores.psnr_db = 24.567;
  scores.mtf50_per_cell = 0.213;
  scores.moving_car_cells = 800;
  scores.moving_car_share = 0.031;
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "images");
  const std::vector<ortho::OrthoCrop> crops = {{image::Image8(40, 30, 3), image::Image8(40, 30, 3), "Where they differ most", 18.5}};
  const std::vector<OrthoPicture> pictures = WriteOrthoPictures(crops, folder.path());
  ASSERT_EQ(pictures.size(), 1U);
  EXPECT_TRUE(std::filesystem::exists(folder / pictures[0].map));
  EXPECT_TRUE(std::filesystem::exists(folder / pictures[0].truth));
  const std::string html = OrthoSection(scores, pictures);
  for (const char* text :
       {"24.57", "0.213", "93.0", "3.1", "Where they differ most", "images/ortho_1_map.png", "images/ortho_1_truth.png", "18.50"}) {
    EXPECT_NE(html.find(text), std::string::npos) << text << "\n" << html;
  }
  EXPECT_EQ(html.find("SSIM"), std::string::npos) << "not measured";
}

}  // namespace
}  // namespace skyquilt::evaluate::page
